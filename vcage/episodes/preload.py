"""Modules for the processes that collect and compress, imported while the first stages work.

The process that imports them is the one that those are forked from (:func:`vcage.base.workers.preload_module`).
"""

# ruff: noqa: F401, I001

import gc
from contextlib import suppress

with suppress(Exception):  # whoever needs it says what is wrong with it
    import vcage.sim  # without which SAPIEN may not load
    import sapien

    import vcage.episodes.runner

with suppress(Exception):
    import vcage.datasets.packing.clips
    import vcage.video.colorvideovdp

gc.freeze()  # stays out of the collections of those that are forked, whose memory is so shared
