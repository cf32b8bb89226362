"""The ``vcage`` command, and the entry of every script under ``skills/``.

Importing it orders the folders in which this process finds packages, before any is imported that another may hold.
"""

from __future__ import annotations

import os
import sys


def _own_packages_first() -> None:
    """Find Python's own modules and the packages of this environment before those in other search folders.

    Those are the folders in ``PYTHONPATH``, for child processes too, and the current one, in which
    ``python -m`` looks first.

    Robots' systems (ROS) and clusters name folders for other interpreters, whose packages may not load in this one.
    Packages only there are still found; the folder of this vcage stays first.
    """
    try:
        current = os.getcwd()  # noqa: PTH109, as pathlib may be one of theirs
    except FileNotFoundError:  # no command works there
        return
    home = os.path.abspath(__file__).rsplit(os.sep, 3)[0]  # noqa: PTH100
    named = os.environ.get("PYTHONPATH")
    listed = [os.path.abspath(path) for path in named.split(os.pathsep)] if named else []  # noqa: PTH100
    beside = [current] if sys.argv[:1] == ["-m"] and sys.path[:1] == [current] else []
    foreign = {*beside, *listed} - {home}
    sys.path.sort(key=lambda path: path in foreign)  # stable
    if foreign and listed:
        import sysconfig

        own = [sysconfig.get_path("purelib"), sysconfig.get_path("platlib")]
        first = [home] if home in listed else []
        os.environ["PYTHONPATH"] = os.pathsep.join(dict.fromkeys([*first, *own, *listed]))


_own_packages_first()
