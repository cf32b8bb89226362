"""HDF5 files of any layout, read and written with errors that name the file.

HDF5 itself does not survive a write that the system refuses: data that cannot be flushed when a dataset or the file is
closed ends the process (a segmentation fault, seen with HDF5 2.0), or is lost without an error. So it writes through
an object of Python that accepts everything, and remembers the first refusal until HDF5 is done.
"""

from __future__ import annotations

import io
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import h5py

from vcage.base.errors import DamagedFile, FileInUse, VcageError
from vcage.base.files import atomic_path
from vcage.base.placeholders import require_fetched
from vcage.datasets.hdf5_contents import require_own_contents
from vcage.datasets.picture_links import require_own_videos

_CHECKED: set[tuple[Path, int, int, int]] = set()
"""Path, inode, bytes and time of the last change in ns of files that hold their own data alone, and links to their own
videos."""


def open_hdf5_file(path: Path, **options: Any) -> h5py.File:
    """Open an HDF5 file for reading, once it is sure that nothing in it leads to another file.

    Every file that may be somebody else's is opened here. Links to videos may lead to other files, each to its own.

    Args:
        path: the file.
        options: see :class:`h5py.File`.

    Raises:
        DamagedFile: it is no HDF5, was not fetched, or leads to another file; names what does. Also where a link to a
            video is damaged, or names the video of other pictures.
        OversizedFile: it holds too many groups.
        FileInUse: another process writes it.
    """
    path = Path(path)
    with damage(path):
        require_fetched(path)
        file = h5py.File(path, "r", **options)
        try:
            found = path.stat()
            state = (path, found.st_ino, found.st_size, found.st_mtime_ns)
            if state not in _CHECKED:
                require_own_videos(require_own_contents(file))
                _CHECKED.add(state)
        except BaseException:
            file.close()
            raise
    return file


@contextmanager
def read_hdf5(path: Path, **options: Any) -> Iterator[h5py.File]:
    """Open a file as :func:`open_hdf5_file`; errors inside the block become :class:`DamagedFile` too."""
    with damage(path), open_hdf5_file(path, **options) as file:
        yield file


@contextmanager
def damage(path: Path, *, writing: bool = False) -> Iterator[None]:
    """Turn h5py's errors on a broken file into :class:`DamagedFile`.

    Args:
        path: the file that is read.
        writing: true if another is written meanwhile; errors of the system, which have a number, may be its fault.
    """
    try:
        yield
    except (OSError, KeyError, RuntimeError) as error:
        if (busy := _busy(path, error)) is not None:
            raise busy from error
        if writing and isinstance(error, OSError) and error.errno:
            raise
        raise DamagedFile(
            f"{path} is damaged: {error}", hint="it may be cut off: copy or record it again, or leave it out"
        ) from error


WRITTEN = "already open for write"
"""Part of HDF5's message about a file that is marked as being written."""

SIGNATURE, FLAGS_AT = b"\x89HDF\r\n\x1a\n", 11
"""First bytes of a superblock, and the offset of its consistency flags."""

SWMR_WRITTEN = 0x4
"""Bit of the marks in a file's superblock: others may read while it is written, and so it has no lock."""


def _busy(path: Path, error: Exception) -> VcageError | None:
    """Return the error of a file that is being written, or that its writer never closed; None for any other."""
    if isinstance(error, BlockingIOError):
        return FileInUse(
            f"{path} is open for writing in another process", hint="wait until its writer has closed it, then repeat"
        )
    if WRITTEN not in str(error):
        return None
    mend = f"if its writer is gone: h5clear -s {path}"
    if _marks(path) & SWMR_WRITTEN:
        return FileInUse(f"{path} is being written by another process (SWMR)", hint=f"wait for its writer; {mend}")
    return DamagedFile(f"{path} is damaged: it was not closed by the program that wrote it", hint=mend)


def _marks(path: Path) -> int:
    """Return the consistency flags of a superblock of version 3, which alone has any, behind any user's block."""
    with open(path, "rb") as handle:
        start = handle.read(2**16)
    place = start.find(SIGNATURE) + FLAGS_AT
    return start[place] if place < len(start) else 0


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
    """Open a new HDF5 file; it takes its name when it is whole, and does not appear if anything fails.

    Args:
        path: the file; one that is there is replaced.
        track_order: true if groups remember the order in which they were filled.

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


# --- pieces of unknown lengths ---------------------------------------------------------------------------


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
    """Write ``pieces`` into a file without a name in ``folder``, which is gone afterwards."""
    with tempfile.TemporaryFile(dir=folder) as file:
        yield Spool(file, pieces)
