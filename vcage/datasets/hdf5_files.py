"""HDF5 files of whatever layout: damage in what is read, and a full disk in what is written, are errors like any other.

HDF5 itself does not survive a write that the system refuses: what cannot be flushed when a dataset or the file is
closed ends the process (a segmentation fault, seen with HDF5 2.0), or is lost without an error. So it writes through
an object of Python that accepts everything, and remembers the first refusal until HDF5 is done.
"""

from __future__ import annotations

import io
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

import h5py

from vcage.base.errors import DamagedFile
from vcage.base.files import atomic_path


@contextmanager
def damage(path: Path, *, writing: bool = False) -> Iterator[None]:
    """Turn what a broken file makes h5py raise into :class:`DamagedFile`.

    Args:
        path: the file that is read.
        writing: whether another is written meanwhile; what the system refuses, which has a number, may be its fault.
    """
    try:
        yield
    except (OSError, KeyError, RuntimeError) as error:
        if writing and isinstance(error, OSError) and error.errno:
            raise
        raise DamagedFile(
            f"{path} is damaged: {error}", hint="it may be cut off: copy or record it again, or leave it out"
        ) from error


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


# --- bytes of lengths that are not known yet -----------------------------------------------------------


class Spool:
    """Pieces in a file, in order.

    Args:
        file: open for reading and writing, empty.
        pieces: taken one at a time.

    Attributes:
        sizes: length of each piece, bytes.
    """

    def __init__(self, file: IO[bytes], pieces: Iterable[bytes]):
        self._file = file
        self.sizes = [file.write(piece) for piece in pieces]

    @property
    def longest(self) -> int:
        """Length of the longest piece, bytes."""
        return max(self.sizes)

    def __len__(self) -> int:
        return len(self.sizes)

    def __iter__(self) -> Iterator[bytes]:
        self._file.seek(0)
        for size in self.sizes:
            yield self._file.read(size)


@contextmanager
def spooled(pieces: Iterable[bytes], folder: Path) -> Iterator[Spool]:
    """All of ``pieces`` in a file without a name in ``folder``, which is gone afterwards."""
    with tempfile.TemporaryFile(dir=folder) as file:
        yield Spool(file, pieces)
