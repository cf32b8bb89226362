"""HDF5 files written so that a full disk is an error like any other.

HDF5 itself does not survive a write that the system refuses: what cannot be flushed when a dataset or the file is
closed ends the process (a segmentation fault, seen with HDF5 2.0), or is lost without an error. So it writes through
an object of Python that accepts everything, and remembers the first refusal until HDF5 is done.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py

from vcage.base.files import atomic_path


class _Target(io.FileIO):
    """A file to write and to read again, whose writes never fail; after the first refusal nothing is written."""

    refused: OSError | None = None

    def write(self, data: bytes) -> int:  # type: ignore[override]
        if self.refused is None:
            try:
                left = memoryview(data).cast("B")
                while len(left):
                    left = left[super().write(left) :]
            except OSError as error:
                self.refused = error
        return len(data)

    def truncate(self, size: int | None = None) -> int:
        if self.refused is None:
            try:
                return super().truncate(size)
            except OSError as error:
                self.refused = error
        return size or 0


@contextmanager
def new_hdf5(path: Path, *, track_order: bool = False) -> Iterator[h5py.File]:
    """An HDF5 file to be filled; it takes its name when it is whole, and is not there if anything fails.

    Args:
        path: the file; one that is there is replaced.
        track_order: whether groups remember in what order they were filled.

    Raises:
        OutputFolderError, DiskFull: it cannot be written.
    """
    with atomic_path(path) as part, _Target(part, "w+") as target:
        try:
            with h5py.File(target, "w", track_order=track_order) as file:
                yield file
        finally:
            if target.refused is not None:
                raise target.refused
