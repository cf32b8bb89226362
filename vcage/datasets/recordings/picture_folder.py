"""A folder of pictures: one camera of the pictures in it, or one for each of its folders."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import DamagedFile
from vcage.base.folders import entries, require_utf8
from vcage.base.pictures import picture_header
from vcage.base.placeholders import require_fetched
from vcage.datasets.recordings.recording import Columns, RecordedCamera, Recording
from vcage.datasets.stored_pictures import channels_of, decode_picture, stacked, storage_of

SUFFIXES = (".png", ".jpg", ".jpeg")
LEAVE_OUT = "remove it, or leave the recording out"
ONLY = "camera"
"""Name of the camera whose pictures lie in the folder itself."""


class PictureFolder(Recording):
    """Pictures in the order of the numbers in their names: ``frame_2.png`` comes before ``frame_10.png``."""

    LAYOUT = "pictures"

    @cached_property
    def cameras(self) -> list[RecordedCamera]:
        return [self._camera(name, files) for name, files in self._files.items()]

    @property
    def files(self) -> list[Path]:
        return [file for files in self._files.values() for file in files]

    def pictures(self, camera: str, indices: Sequence[int] | None = None) -> NDArray[np.uint8]:
        files = self._files[self.camera(camera).name]
        wanted = range(len(files)) if indices is None else indices
        return stacked(
            [decode_picture(files[index].read_bytes(), str(files[index])) for index in wanted],
            str(self.path / self.camera(camera).key),
        )

    def _read_commands(self) -> Columns | None:
        return None

    @cached_property
    def _files(self) -> dict[str, list[Path]]:
        """Camera → its pictures, in order."""
        own = pictures_in(self.path)
        if own:
            return {ONLY: own}
        folders = [path for path in entries(self.path) if path.is_dir()]
        return {folder.name: files for folder in folders if (files := pictures_in(folder))}

    def _camera(self, name: str, files: list[Path]) -> RecordedCamera:
        picture_header(files[0])
        first = files[0].read_bytes()
        height, width = decode_picture(first, str(files[0])).shape[:2]
        size = sum(path.stat().st_size for path in files)
        key = "." if name == ONLY and files[0].parent == self.path else name
        for file in files:
            _require_size(file, (width, height))
        channels = channels_of(first, str(files[0]))
        return RecordedCamera(name, key, len(files), width, height, storage_of(first, str(files[0])), size, channels)


def _require_size(file: Path, size: tuple[int, int]) -> None:
    """Raise DamagedFile unless the head of a picture file says this width and height; it is not decoded."""
    found = picture_header(file)
    if (found.width, found.height) != size:
        raise DamagedFile(
            f"{file} is {found.width}x{found.height}, the first of its folder {size[0]}x{size[1]}", hint=LEAVE_OUT
        )


def pictures_in(folder: Path) -> list[Path]:
    """The picture files of a folder, by the numbers in their names.

    Raises:
        DamagedFile: one was not fetched.
        InputFileError: the name of one is not UTF-8.
    """
    files = [path for path in entries(folder) if path.suffix.lower() in SUFFIXES and not path.is_dir()]
    for file in files:
        require_utf8(file)
        require_fetched(file)
    return files
