"""Which recordings a path holds."""

from __future__ import annotations

from pathlib import Path

from vcage.base.errors import DamagedFile, InputFileError
from vcage.datasets.lerobot.info import INFO
from vcage.datasets.recordings.colours import agree_on_colours
from vcage.datasets.recordings.folder import PictureFolder, pictures_in
from vcage.datasets.recordings.hdf5_layouts import open_hdf5
from vcage.datasets.recordings.lerobot_layouts import open_lerobot
from vcage.datasets.recordings.recording import Recording
from vcage.datasets.recordings.robomimic import open_robomimic

HDF5 = (".hdf5", ".h5")


def open_recordings(path: Path, damaged: dict[Path, DamagedFile] | None = None) -> list[Recording]:
    """The recordings in a file or a folder, sorted by name: an HDF5 file or the demonstrations in it, the episodes of a
    LeRobot data set, all HDF5 files below a folder, or the pictures of a folder or of its folders.

    Args:
        path: the file or the folder.
        damaged: where given, damaged files of a folder are noted here instead of raised.

    Raises:
        InputFileError: there is nothing at the path, or nothing that is known.
        DamagedFile: a file is damaged, or in no layout that is known; names it.
    """
    path = Path(path)
    if path.is_file():
        return _open_file(path)
    if not path.is_dir():
        raise InputFileError(
            f"{path} does not exist",
            hint="give an HDF5 file, or a folder of them or of pictures, or a LeRobot data set",
        )
    if (path / INFO).is_file():
        return list(open_lerobot(path))
    files = hdf5_files(path)
    if files:
        return _open_all(files, damaged)
    if pictures_in(path) or any(pictures_in(folder) for folder in path.iterdir() if folder.is_dir()):
        return [PictureFolder(path)]
    raise InputFileError(
        f"{path} holds no recording",
        hint=f"known are {', '.join(HDF5)} files, LeRobot data sets, and folders of PNG or JPEG pictures",
    )


def hdf5_files(folder: Path) -> list[Path]:
    """All HDF5 files below a folder, sorted."""
    return sorted(file for file in folder.rglob("*") if file.suffix in HDF5 and file.is_file())


def _open_all(files: list[Path], damaged: dict[Path, DamagedFile] | None) -> list[Recording]:
    opened: list[Recording] = []
    for file in files:
        try:
            opened += _open_file(file)
        except DamagedFile as error:
            if damaged is None:
                raise
            damaged[file] = error
    agree_on_colours(opened)
    return opened


def _open_file(path: Path) -> list[Recording]:
    """The recordings in an HDF5 file; at least one."""
    return [*open_robomimic(path)] or [open_hdf5(path)]
