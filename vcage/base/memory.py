"""Free memory of this process, the most that it took, and a cache that is emptied after each scene."""

from __future__ import annotations

import contextlib
import ctypes
import functools
import re
import resource
from collections import OrderedDict
from collections.abc import Callable, Hashable
from pathlib import Path
from typing import Generic, ParamSpec, TypeVar
from weakref import WeakSet

P = ParamSpec("P")
R = TypeVar("R")

MEMINFO = Path("/proc/meminfo")
OWN_GROUPS = Path("/proc/self/cgroup")
GROUPS = Path("/sys/fs/cgroup")
OWN_STATUS = Path("/proc/self/status")
OWN_PEAK = Path("/proc/self/clear_refs")

RECLAIMABLE = re.compile(r"^(?:total_)?inactive_file (\d+)$", re.MULTILINE)
"""In a group's ``memory.stat``: bytes of its page cache that the kernel gives up when asked; of groups within it too,
where that is counted apart."""


def free_memory() -> int:
    """Bytes that the system can give without swapping, or fewer where the process's control groups limit them."""
    found = re.search(r"^MemAvailable:\s+(\d+) kB$", MEMINFO.read_text(), re.MULTILINE)
    free = [int(found[1]) * 1024] if found else []
    for folder in _groups():
        free += _free_bytes(folder, "memory.max", "memory.current")
        free += _free_bytes(folder, "memory.limit_in_bytes", "memory.usage_in_bytes")
    return max(0, min(free, default=0))


def measure_memory_anew() -> None:
    """Let :func:`largest_memory` count from now on, where the system can do that."""
    with contextlib.suppress(OSError):
        OWN_PEAK.write_text("5")


def largest_memory() -> int:
    """Bytes that this process took at most, since it began or since :func:`measure_memory_anew`."""
    with contextlib.suppress(OSError):
        if found := re.search(r"^VmHWM:\s+(\d+) kB$", OWN_STATUS.read_text(), re.MULTILINE):
            return int(found[1]) * 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def _groups() -> list[Path]:
    """Folders of the control groups that may limit this process's memory, including enclosing groups.

    A container may see its own group as the root of all, whatever its name.
    """
    folders = []
    for line in OWN_GROUPS.read_text().splitlines() if OWN_GROUPS.exists() else []:
        _, controllers, name = line.split(":", 2)
        if controllers and "memory" not in controllers.split(","):
            continue
        root = GROUPS / "memory" if controllers else GROUPS
        own = root / name.lstrip("/")
        folders += [folder for folder in (own, *own.parents) if folder.is_relative_to(root)]
    return folders


def _free_bytes(folder: Path, limit: str, usage: str) -> list[int]:
    """Bytes left under a group's limit, if it has one."""
    try:
        most = (folder / limit).read_text().strip()
        used = int((folder / usage).read_text())
        reclaimable = RECLAIMABLE.findall((folder / "memory.stat").read_text())
    except OSError:
        return []
    return [] if most == "max" else [int(most) - used + max(map(int, reclaimable), default=0)]


_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3
"""From glibc's <malloc.h>."""


def reuse_freed_memory(kept_bytes: int = 128 << 20, array_bytes: int = 32 << 20) -> None:
    """Let the C library keep freed memory for the next arrays of this process.

    Without, glibc gives it back after nearly every picture, and the system clears each page before it is used again:
    measured, a seventh of the CPU time of the first clip that a process encodes and judges.

    Args:
        kept_bytes: that are kept free at most, where the heap ends.
        array_bytes: larger arrays are given back as soon as they are freed; glibc takes no more than 32 MiB.
    """
    library = ctypes.CDLL(None)
    if hasattr(library, "mallopt"):
        library.mallopt(_M_TRIM_THRESHOLD, kept_bytes)
        library.mallopt(_M_MMAP_THRESHOLD, array_bytes)


K = TypeVar("K", bound=Hashable)
V = TypeVar("V")


class Recent(Generic[K, V]):
    """The values used last, up to a number of bytes.

    Args:
        most_bytes: of all values together.
    """

    def __init__(self, most_bytes: int):
        self._most_bytes, self._bytes = most_bytes, 0
        self._values: OrderedDict[K, tuple[V, int]] = OrderedDict()

    def get(self, key: K, make: Callable[[], V], size: Callable[[V], int]) -> V:
        """Return the value of a key, made where it is not there.

        Args:
            key: of the value.
            make: makes it.
            size: its bytes.
        """
        if key not in self._values:
            value = make()
            self._values[key] = value, size(value)
            self._bytes += self._values[key][1]
            while self._bytes > self._most_bytes and len(self._values) > 1:
                self._bytes -= self._values.popitem(last=False)[1][1]
        self._values.move_to_end(key)
        return self._values[key][0]


_remembering: WeakSet[functools._lru_cache_wrapper] = WeakSet()


def remembered(most: int) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Decorate like :func:`functools.lru_cache`, for results about one scene, which :func:`forget` drops.

    Args:
        most: results in the cache.
    """

    def remembering(function: Callable[P, R]) -> Callable[P, R]:
        cached = functools.lru_cache(most)(function)
        _remembering.add(cached)
        return cached  # pyrefly: ignore

    return remembering


def forget() -> None:
    """Drop all remembered results when a scene is finished: the next one differs."""
    for cached in list(_remembering):
        cached.cache_clear()
