"""All recordings at a path, of any known layout."""

from __future__ import annotations

import os.path
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from vcage.base.errors import DamagedFile, InputFileError, UnknownName
from vcage.base.folders import entries, files_below, require_utf8
from vcage.base.placeholders import require_fetched
from vcage.base.text import listed
from vcage.datasets.hdf5_contents import walk
from vcage.datasets.hdf5_files import read_hdf5
from vcage.datasets.lerobot.meta import INFO, refuse_first_versions
from vcage.datasets.recordings.act import ActEpisode, VcageEpisode
from vcage.datasets.recordings.colours import AUTO, BGR, CHOICES, Colours, settle
from vcage.datasets.recordings.hdf5_recording import Hdf5Recording
from vcage.datasets.recordings.lerobot import open_lerobot
from vcage.datasets.recordings.maniskill import ManiSkillTrajectory
from vcage.datasets.recordings.passed_over import SUFFIXES, data_sets_in, is_hdf5_by_name, passed_over, printable
from vcage.datasets.recordings.picture_folder import SUFFIXES as PICTURE_SUFFIXES
from vcage.datasets.recordings.picture_folder import PictureFolder, pictures_in, unread_in
from vcage.datasets.recordings.recording import Recording
from vcage.datasets.recordings.robomimic import IsaacLabDemo, LiberoDemo, RobomimicDemo
from vcage.datasets.recordings.robotwin import RoboTwinEpisode, RoboTwinVisionEpisode

HDF5_LAYOUTS: tuple[type[Hdf5Recording], ...] = (
    LiberoDemo,
    IsaacLabDemo,
    RobomimicDemo,
    ManiSkillTrajectory,
    VcageEpisode,
    RoboTwinEpisode,
    RoboTwinVisionEpisode,
    ActEpisode,
)
"""A file has the first layout that it fits."""


@dataclass(frozen=True)
class Opened:
    """Content of a path.

    Args:
        recordings: in natural order of their names.
        damaged: file of a folder → the error.
        passed_over: file or folder, relative to the path, that is not read beside these → description.
    """

    recordings: Sequence[Recording]
    damaged: Mapping[Path, DamagedFile]
    passed_over: Mapping[str, str] = field(default_factory=dict)


def open_recordings(path: Path) -> list[Recording]:
    """Return the recordings at a path where nothing is damaged; see :func:`open_all`.

    Raises:
        InputFileError: there is nothing at the path, or nothing known.
        DamagedFile: a file is damaged, or in no known layout; names it.
    """
    opened = open_all(path)
    for error in opened.damaged.values():
        raise error
    return list(opened.recordings)


def open_all(path: Path, colours: str = AUTO) -> Opened:
    """Open the recordings in a file or a folder.

    They are an HDF5 file or the demonstrations in it, the episodes of a LeRobot data set, all HDF5 files below a
    folder, or the pictures of a folder or of its folders.

    Args:
        path: the file or the folder.
        colours: the order of red and blue in stored pictures, ``rgb`` or ``bgr``; ``auto`` finds it out.

    Raises:
        UnknownName: there is no such order.
        UsageError: the data set has its colours in one order only, and another is asked for.
        InputFileError: there is nothing at the path, or nothing known.
        DamagedFile: the file or the data set's description is damaged, or in no known layout.
    """
    if colours not in CHOICES:
        raise UnknownName("order of colours", colours, CHOICES)
    path = Path(path)
    require_utf8(path)
    opened = _open(path)
    if colours == AUTO:
        return opened
    order = Colours(colours == BGR, "option", sure=True)
    return replace(opened, recordings=[recording.with_colours(order) for recording in opened.recordings])


def _open(path: Path) -> Opened:
    if path.is_file():
        return Opened(_recordings_in(path), {})
    if not path.is_dir():
        require_fetched(path)
        raise InputFileError(
            f"{path} does not exist",
            hint="give an HDF5 file, or a folder of them or of pictures, or a LeRobot data set",
        )
    if os.path.lexists(path / INFO):
        return Opened(open_lerobot(path), {}, passed_over(path, files_below(path), whole=True))
    refuse_first_versions(path)
    below = files_below(path)
    if files := _hdf5_among(below):
        return replace(_open_files(files), passed_over=passed_over(path, below))
    folders = [path, *(folder for folder in entries(path) if folder.is_dir())]
    if any(map(pictures_in, folders)):
        return Opened([PictureFolder(path)], {}, passed_over(path, below, folders=folders))
    raise _nothing_read(path, below, folders)


def _nothing_read(path: Path, below: Sequence[Path], folders: Sequence[Path]) -> InputFileError:
    """Return the error for a folder in which nothing is read; names its content."""
    if passed := passed_over(path, below):
        named = listed(f"{name} ({what.partition(';')[0]})" for name, what in passed.items())
        sets = [printable(path, one) for one in data_sets_in(path, below)]
        hint = next(iter(passed.values())).partition("; ")[2]
        return InputFileError(
            f"{path} holds no recording that is read from here, but {named}",
            hint=f"give one of {listed(sets)}" if sets else hint or "convert it",
        )
    unread = [name for folder in folders for name in unread_in(folder)]
    return InputFileError(
        f"{path} holds no recording" + (f"; {unread[0]} is of a format that is not read" if unread else ""),
        hint=f"known are {', '.join(SUFFIXES)} files, LeRobot data sets, and folders of pictures "
        f"({', '.join(PICTURE_SUFFIXES)})",
    )


def open_hdf5(path: Path) -> Hdf5Recording:
    """Return the recording in an HDF5 file that holds one, or the first.

    Raises:
        DamagedFile: it is no HDF5, is cut off, or holds no pictures in a known layout.
    """
    return _recordings_in(path)[0]


def hdf5_files(folder: Path) -> list[Path]:
    """Return all HDF5 files below a folder, in natural order; see :func:`vcage.base.folders.files_below`."""
    return _hdf5_among(files_below(folder))


def _hdf5_among(below: Sequence[Path]) -> list[Path]:
    """Return the HDF5 files among others."""
    files = [file for file in below if is_hdf5_by_name(file)]
    for file in files:
        require_utf8(file)
    return files


def _open_files(files: Sequence[Path]) -> Opened:
    found: list[Hdf5Recording] = []
    damaged: dict[Path, DamagedFile] = {}
    for file in files:
        try:
            found += _recordings_in(file)
        except DamagedFile as error:
            damaged[file] = error
    return Opened(_with_colours_settled(found), damaged)


def _recordings_in(path: Path) -> list[Hdf5Recording]:
    """Return the recordings in an HDF5 file, at least one, by its content."""
    with read_hdf5(path) as file:
        keys = [key for key, _ in walk(file)]
        for layout in HDF5_LAYOUTS:
            if found := layout.found_in(path, file, keys):
                return list(found)
    raise DamagedFile(
        f"{path} holds no pictures where a known layout has them (it has: {', '.join(keys[:8]) or 'nothing'})",
        hint="known are RoboTwin's observation/<camera>/rgb and vision/<camera>/colors, ACT's "
        "observations/images/<camera>, ManiSkill's traj_<number>/obs/sensor_data/<camera>/rgb, and "
        "robomimic's data/demo_<number>/obs/<camera>_image",
    )


def _with_colours_settled(recordings: Sequence[Hdf5Recording], voters: int = 20) -> list[Hdf5Recording]:
    """Settle for all recordings of one layout, which were probably made alike, if red and blue are swapped.

    Only ``voters`` of them vote. A recording that states its own order keeps it.
    """
    settled: dict[type[Hdf5Recording], Colours] = {}
    for layout in {type(recording) for recording in recordings if not recording.COLOURS_SURE}:
        own = [one for one in recordings if type(one) is layout]
        some = np.unique(np.linspace(0, len(own) - 1, min(len(own), voters)).astype(int))
        votes = [vote for index in some for vote in _colour_votes(own[index])]
        if votes:
            settled[layout] = settle(layout.SWAPPED, votes)
    return [_settled(one, settled.get(type(one))) for one in recordings]


def _settled(recording: Hdf5Recording, colours: Colours | None) -> Hdf5Recording:
    with suppress(DamagedFile):  # the error comes where the recording is read
        if colours is not None and recording.has_encoded_pictures and recording.stated_colours() is None:
            return recording.with_colours(colours)
    return recording


def _colour_votes(recording: Hdf5Recording) -> list[int]:
    with suppress(DamagedFile):
        return [] if recording.stated_colours() is not None else recording.colour_votes()
    return []
