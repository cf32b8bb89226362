"""Decompression: HDF5 files whose pictures lie in videos, with their pictures put back."""

from __future__ import annotations

import shutil
from collections.abc import Collection, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Literal

from vcage.base.errors import DamagedFile, InputFileError, OutputFolderError
from vcage.base.files import atomic_folder
from vcage.base.folders import files_below, real_path
from vcage.base.placeholders import require_fetched
from vcage.base.progress import Progress, silent
from vcage.datasets.packed import unpack
from vcage.datasets.packing.sources import require_apart
from vcage.datasets.recordings.opening import hdf5_files, open_hdf5


def unpack_all(
    root: Path,
    out: Path,
    *,
    storage: Literal["same", "raw"] = "same",
    force: bool = False,
    progress: Progress = silent,
) -> list[Path]:
    """Write every packed file of ``root`` into the folder ``out``, which appears whole or not at all.

    Args:
        root: a file, or a folder; only read.
        out: the folder to write.
        storage: see :func:`vcage.datasets.packed.unpack`.
        force: replace an existing folder that holds only files of these names.
        progress: called for each file.

    Returns:
        The files that were written.

    Raises:
        InputFileError: there is no HDF5 file.
        OutputFolderError: ``out`` is in the way, or lies in ``root`` or around it; or cannot be written.
        UsageError, DamagedFile, DiskFull: see :func:`vcage.datasets.packed.unpack`.
    """
    root, out = real_path(root), real_path(out)
    require_apart(root, out)
    if not root.exists():
        raise InputFileError(f"{root} does not exist", hint="give an HDF5 output of compress, or a folder")
    if not root.is_dir():
        require_fetched(root)
    folder = root.parent if root.is_file() else root
    files = [root] if root.is_file() else hdf5_files(root)
    if not files:
        raise InputFileError(f"{root} holds no HDF5 file", hint="give an output folder of compress")
    names = [file.relative_to(folder) for file in files]
    described = _companions(files, folder)
    _require_replaceable(out, [*names, *described], force=force)
    with atomic_folder(out) as part:
        for number, (file, name) in enumerate(zip(files, names, strict=True)):
            progress(str(name), number, len(files))
            (part / name).parent.mkdir(parents=True, exist_ok=True)
            unpack(file, part / name, storage)
        for name in described:
            (part / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(folder / name, part / name)
    return [out / name for name in names]


def _companions(files: Sequence[Path], folder: Path) -> set[Path]:
    """Return files beside recordings in a folder that describe them, relative to it."""
    found: set[Path] = set()
    for file in files:
        with suppress(DamagedFile):  # any packed HDF5 is unpacked, of any layout
            found.update(open_hdf5(file).companions)
    return {file.relative_to(folder) for file in found if file.is_relative_to(folder)}


def _require_replaceable(out: Path, names: Collection[Path], *, force: bool) -> None:
    """Raise OutputFolderError where there are files not to be replaced, or of others."""
    if not out.exists():
        return
    if not out.is_dir():
        raise OutputFolderError(f"{out} is a file", hint="give another --out")
    there = [path.relative_to(out) for path in files_below(out)]
    foreign = [path for path in there if path not in names]
    if foreign:
        raise OutputFolderError(f"{out} holds {foreign[0]}, which is not written here", hint="give another --out")
    if there and not force:
        raise OutputFolderError(f"{out} exists already", hint="give another --out, or --force to replace it")
