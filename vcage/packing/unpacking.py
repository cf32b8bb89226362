"""The way back: HDF5 files whose pictures lie in videos, with their pictures put back."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from vcage.dataset.packed import unpack
from vcage.dataset.recordings.opening import HDF5
from vcage.errors import InputFileError, OutputFolderError
from vcage.files import atomic_folder
from vcage.progress import Progress, silent


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
        storage: see :func:`vcage.dataset.packed.unpack`.
        force: replace a folder that is there.
        progress: told of each file.

    Returns:
        The files that were written.

    Raises:
        InputFileError: there is no HDF5 file.
        OutputFolderError: ``out`` is there already, or lies in ``root`` or around it; or cannot be written.
        UsageError, DamagedFile, DiskFull: see :func:`vcage.dataset.packed.unpack`.
    """
    root, out = Path(root).expanduser().resolve(), Path(out).expanduser().resolve()
    if out == root or out in root.parents or root in out.parents:
        raise OutputFolderError(f"{out} and {root} lie in one another", hint="give an --out beside it")
    if out.exists() and not force and not (out.is_dir() and not any(out.iterdir())):
        raise OutputFolderError(f"{out} is there already", hint="give another --out, or --force to replace it")
    if not root.exists():
        raise InputFileError(f"{root} does not exist", hint="give an HDF5 file that vcage compress wrote, or a folder")
    folder = root.parent if root.is_file() else root
    files = [root] if root.is_file() else sorted(path for path in root.rglob("*") if path.suffix in HDF5)
    if not files:
        raise InputFileError(f"{root} holds no HDF5 file", hint="give a folder that vcage compress wrote")
    names = [file.relative_to(folder) for file in files]
    with atomic_folder(out) as part:
        for number, (file, name) in enumerate(zip(files, names, strict=True)):
            progress(str(name), number, len(files))
            (part / name).parent.mkdir(parents=True, exist_ok=True)
            unpack(file, part / name, storage)
    return [out / name for name in names]
