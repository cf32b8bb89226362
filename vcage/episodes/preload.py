"""Modules for the processes that collect and compress, imported while the first stages work.

The process that imports them is the parent of all forks (:func:`vcage.base.workers.preload_module`).
"""

# ruff: noqa: F401, I001

import gc
from contextlib import suppress

with suppress(Exception):  # its users report the error
    import vcage.sim  # without which SAPIEN may not load
    import sapien
    import mplib

    import vcage.episodes.runner

with suppress(Exception):
    import vcage.datasets.packing.clips

gc.freeze()  # leaves loaded modules out of garbage collections, so that forked processes share their memory
