"""HDF5 files of any layout, read and written with errors that name the file.

A file that is read must hold its own data alone. HDF5 can take data from elsewhere in several ways: external storage of
a dataset, virtual datasets, external links, and links of kinds that programs define. A file that uses one is refused,
so that none brings the content of other files into what is exported. Soft links are followed: they stay in the file.

HDF5 itself does not survive a failed write: data that cannot be flushed when a dataset or the file is
closed ends the process (a segmentation fault, seen with HDF5 2.0), or is lost without an error. So it writes through
an object of Python that accepts everything, and remembers the first refusal until HDF5 is done.
"""

from __future__ import annotations

import io
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
from h5py import h5l, h5o, h5t  # pyrefly: ignore[missing-module-attribute]  the stubs lack h5o

from vcage.base.errors import DamagedFile, FileInUse, OversizedFile, VcageError
from vcage.base.files import atomic_path
from vcage.base.placeholders import require_fetched
from vcage.datasets.hdf5_contents import LIMITS, Hdf5Limits, address, encoded_name
from vcage.datasets.picture_links import require_own_videos

OWN = "."
"""How a virtual dataset names the file that it lies in."""

COPY = "copy the data into the file itself (h5repack, or h5py), or leave it out"

_CHECKED: set[tuple[Path, int, int, int]] = set()
"""Path, inode, bytes and time of the last change in ns of files that hold their own data alone, and links to their own
videos."""


def open_hdf5_file(path: Path, **options: Any) -> h5py.File:
    """Open an HDF5 file for reading, once it is sure that nothing in it leads to another file.

    Every possibly foreign file is opened here. Links to videos may lead to other files, each to its own.

    Args:
        path: the file.
        options: see :class:`h5py.File`.

    Raises:
        DamagedFile: it is not HDF5, was not fetched, or leads to another file; names it. Also where a link to a
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


def require_own_contents(file: h5py.File, limits: Hdf5Limits = LIMITS) -> list[h5py.Dataset]:
    """Require that an open file holds all of its data itself.

    Returns:
        Its scalar datasets, each once; links to videos are among them.

    Raises:
        DamagedFile: a link or a dataset leads to another file, or a soft link to nothing; names it.
        OversizedFile: there are too many groups.
    """
    return [one for one in _own_datasets(file, limits) if one.shape == ()]


def require_not_virtual(file: h5py.File, keys: Collection[str]) -> None:
    """Require that no virtual dataset takes data from the datasets ``keys``, which are to be replaced.

    Raises:
        DamagedFile: one does; names both.
    """
    replaced = {address(file[key]) for key in keys}
    for dataset in filter(lambda one: one.is_virtual, _own_datasets(file, LIMITS)):
        for source in dataset.virtual_sources():
            if address(file[source.dset_name]) in replaced:
                why = f"is a virtual dataset of the pictures {source.dset_name}, which are to be replaced by a video"
                raise _refused(dataset, why)


def _own_datasets(file: h5py.File, limits: Hdf5Limits) -> list[h5py.Dataset]:
    """Return all datasets of a file, each once, after checking that none takes data from elsewhere."""
    seen, links = {address(file)}, 0
    waiting: list[tuple[h5py.Group, int]] = [(file, 1)]
    soft: list[str] = []
    found: list[h5py.Dataset] = []
    while waiting:
        group, depth = waiting.pop()
        links += len(group)
        if links > limits.max_links or depth > limits.max_depth:
            most = f"{limits.max_links:,} names, and {limits.max_depth} groups in one another"
            raise OversizedFile(
                f"{file.filename}:{group.name}: the file holds too many groups; at most {most}, are read",
                hint="split the file, or leave it out",
            )
        new = {place: one for one in _own_objects(group, soft) if (place := address(one)) not in seen}
        seen.update(new)
        waiting += [(one, depth + 1) for one in new.values() if isinstance(one, h5py.Group)]
        found += [one for one in new.values() if isinstance(one, h5py.Dataset)]
    for path in soft:  # after external links are ruled out
        _require_target(file, path)
    for dataset in filter(lambda one: one.is_virtual, found):
        _require_own_sources(dataset)
    return found


def _own_objects(group: h5py.Group, soft: list[str]) -> Iterator[h5py.HLObject]:
    """Yield the objects of a group that are no links, and add the paths of its soft links to ``soft``."""
    for name in group:
        kind = group.id.links.get_info(encoded_name(group, name)).type
        path = f"{group.name.rstrip('/')}/{name}"
        if kind == h5l.TYPE_SOFT:
            soft.append(path)
        elif kind == h5l.TYPE_EXTERNAL:
            link = group.get(name, getlink=True)
            raise _refused(group, f"is an external link to {link.path} of the file {link.filename}", path)
        elif kind != h5l.TYPE_HARD:
            raise _refused(group, f"is a link of the user-defined kind {kind}", path)
        else:
            one = group[name]
            if isinstance(one, h5py.Dataset):
                _require_stored_here(one)
            yield one


def _require_stored_here(dataset: h5py.Dataset) -> None:
    properties = dataset.id.get_create_plist()
    if properties.get_external_count():
        name = properties.get_external(0)[0].decode(errors="backslashreplace")
        raise _refused(dataset, f"has external storage: its data lie in the file {name}")
    kind = dataset.id.get_type()
    if kind.get_class() == h5t.REFERENCE and not (kind.equal(h5t.STD_REF_OBJ) or kind.equal(h5t.STD_REF_DSETREG)):
        raise _refused(dataset, "holds references that may lead to other files")


def _require_target(file: h5py.File, path: str) -> None:
    """Require that a soft link leads to something."""
    try:
        h5o.open(file.id, path.encode())
    except (KeyError, RuntimeError) as error:
        why = "which leads back to itself" if "too many links" in str(error) else "where the file has nothing"
        target = file.get(path, getlink=True).path
        raise DamagedFile(
            f"{file.filename}:{path} is a soft link to {target}, {why}", hint="delete the link, or leave the file out"
        ) from error


def _require_own_sources(dataset: h5py.Dataset) -> None:
    for source in dataset.virtual_sources():
        name = source.dset_name
        if source.file_name != OWN:
            raise _refused(dataset, f"is a virtual dataset: it takes {name} from the file {source.file_name}")
        found = dataset.file.get(name)
        if not isinstance(found, h5py.Dataset) or found.is_virtual:
            raise _refused(dataset, f"is a virtual dataset of {name}, which is no stored dataset of the file")


def _refused(owner: h5py.HLObject, why: str, path: str = "") -> DamagedFile:
    """Return the error of an object that takes data from elsewhere, or of the link ``path`` in it."""
    return DamagedFile(f"{owner.file.filename}:{path or owner.name} {why}", hint=COPY)


# --- files that are being written ---

WRITTEN = "already open for write"
"""Part of HDF5's message about a file that is marked as being written."""

SIGNATURE, FLAGS_AT = b"\x89HDF\r\n\x1a\n", 11
"""First bytes of a superblock, and the offset of its consistency flags."""

SWMR_WRITTEN = 0x4
"""Bit of the marks in a file's superblock: others may read while it is written, and so it has no lock."""


def _busy(path: Path, error: Exception) -> VcageError | None:
    """Return the error of a file being written, or never closed by its writer; None for any other."""
    if isinstance(error, BlockingIOError):
        return FileInUse(
            f"{path} is open for writing in another process", hint="wait until its writer has closed it, then repeat"
        )
    if WRITTEN not in str(error):
        return None
    unlock = f"if its writer is gone: h5clear -s {path}"
    if _marks(path) & SWMR_WRITTEN:
        return FileInUse(f"{path} is being written by another process (SWMR)", hint=f"wait for its writer; {unlock}")
    return DamagedFile(f"{path} is damaged: it was not closed by the program that wrote it", hint=unlock)


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
        path: the file; an existing one is replaced.
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
