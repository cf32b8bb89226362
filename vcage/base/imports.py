"""Skip slow imports of other packages that nothing here needs."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType


@contextmanager
def left_out(package: str, part: str) -> Iterator[None]:
    """Imports inside find an empty module where they import ``package.part``, which they keep; other imports from the
    package raise ImportError. A loaded package is left alone.

    Args:
        package: that is slow to import.
        part: its module that the imports name, as in ``import package.part as name``.

    Example:
        >>> with left_out("matplotlib", "pyplot"):
        ...     import toppra
    """
    name = f"{package}.{part}"
    if package in sys.modules:
        yield
        return
    empty = ModuleType(package)
    setattr(empty, part, ModuleType(name))
    sys.modules |= {package: empty, name: getattr(empty, part)}
    try:
        yield
    finally:
        del sys.modules[package], sys.modules[name]
