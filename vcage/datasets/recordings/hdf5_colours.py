"""Order of red and blue in the encoded pictures of HDF5 recordings."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from contextlib import AbstractContextManager
from functools import cached_property
from typing import Any, ClassVar, Self

import h5py
import numpy as np

from vcage.base.errors import DamagedFile, UsageError
from vcage.datasets.recordings.colours import SETTINGS, Colours, is_marked, leaning, settle
from vcage.datasets.recordings.recording import Recording
from vcage.datasets.recordings.streams import RecordedCamera
from vcage.datasets.stored_pictures import ENCODED, encoded_bytes, stored_picture

COLOURS = "jpeg_colours"
"""Attribute of files that say whether red and blue are ``swapped`` in their encoded pictures, or ``true``."""

STORED = (*ENCODED, "raw")
"""Storages of pictures that lie in the file itself."""


class Hdf5Colours(Recording):
    """Settles the order of colours of a recording in an open file; a subclass opens it."""

    SWAPPED: ClassVar[bool] = False
    """The layout's own writer swaps red and blue of encoded pictures."""

    COLOURS_SURE: ClassVar[bool] = True
    """Nobody writes them otherwise."""

    def with_colours(self, colours: Colours) -> Self:
        other = super().with_colours(colours)
        other.__dict__.pop("colours", None)  # cached for the old order
        return other

    def swapped(self, camera: str) -> bool:
        storage, colours = self.camera(camera).storage, self.colours
        if colours is None or not colours.swapped:
            return False
        return storage in (STORED if colours.source == "option" else ENCODED)

    def put_back_swapped(self, camera: str) -> bool:
        marked = any(self._marks.get(self.camera(camera).key, ())) if self.SWAPPED else False
        return self.swapped(camera) or marked  # PNG cannot carry a mark

    @cached_property
    def colours(self) -> Colours | None:
        if self._settled is not None:
            if self._settled.source == "option" and self.has_encoded_pictures:
                self.stated_colours()  # no one order is true of pictures that differ
            return self._settled
        if not self.has_encoded_pictures:
            return None
        return self.stated_colours() or settle(self.SWAPPED, self.colour_votes())

    def stated_colours(self) -> Colours | None:
        """Return the order of colours as it is stated; None where the content of the pictures must show it.

        Raises:
            DamagedFile: some pictures are marked, and others are not.
        """
        stated = self._attributes.get(COLOURS)
        if stated is not None:
            return Colours(stated == "swapped", "file", sure=True)
        if self.COLOURS_SURE:
            return Colours(self.SWAPPED, "layout", sure=True)
        first: dict[bool, str] = {}
        for key, marks in self._marks.items():
            for index, mark in enumerate(marks):
                first.setdefault(mark, f"{key}[{index}]")
        if len(first) > 1:
            raise DamagedFile(
                f"{self}: {first[True]} is marked as RGB, {first[False]} is not: red and blue may differ in order",
                hint="write it again with one order of colours, or leave it out",
            )
        every = True in first and len(self._marks) == len(self._encoded)
        return Colours(False, "file", sure=True) if every else None

    def colour_votes(self) -> list[int]:
        """Return the votes of some pictures of each camera with encoded pictures."""
        votes = []
        with self._file() as file:
            for camera in self._encoded:
                what, dataset = f"{self.path}:{camera.key}", file[camera.key]
                some = np.unique(np.linspace(0, camera.frames - 1, SETTINGS.pictures_looked_at).astype(int))
                votes += [leaning(stored_picture(dataset, int(index), what)) for index in some]
        return votes

    @property
    def has_encoded_pictures(self) -> bool:
        """True if the order of red and blue is in question."""
        return bool(self._encoded)

    @property
    def _encoded(self) -> list[RecordedCamera]:
        return [camera for camera in self.cameras if camera.storage in ENCODED]

    @cached_property
    def _marks(self) -> dict[str, list[bool]]:
        """Key of a camera with JPEG → true for each picture that declares red and blue in the right order."""
        keys = {camera.key: camera.frames for camera in self._encoded if camera.storage == "jpeg"}
        with self._file() as file:
            return {
                key: [is_marked(encoded_bytes(file[key], index)) for index in range(frames)]
                for key, frames in keys.items()
            }

    def _camera_notes(self) -> list[str]:
        asked = self.colours is not None and self.colours.source == "option"
        if asked and not any(camera.storage in STORED for camera in self.cameras):
            raise UsageError(
                f"the pictures of {self} lie in videos, whose colours are settled",
                hint="leave --colours out; or compress the original recording again, with --colours",
            )
        note = None if self.colours is None else self.colours.note
        return super()._camera_notes() + ([] if note is None else [note])

    @property
    @abstractmethod
    def _attributes(self) -> Mapping[str, Any]:
        """Attributes of the file that are understood."""

    @abstractmethod
    def _file(self) -> AbstractContextManager[h5py.File]:
        """Open the file for reading."""
