"""Other content of a folder of recordings: recordings of other kinds, and files in unknown formats."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path

import h5py

from vcage.datasets.hdf5_contents import address, datasets_in
from vcage.datasets.hdf5_files import SIGNATURE
from vcage.datasets.lerobot.meta import FIRST_INFO, INFO
from vcage.datasets.recordings.picture_folder import SUFFIXES as PICTURES

SUFFIXES = (".hdf5", ".h5", ".hdf", ".he5")
"""Ends of the names of HDF5 files, in lower case."""

SIGNATURES = {SIGNATURE: "HDF5", b"\x0e\x03\x13\x01": "HDF4"}
"""First bytes of a file → its format."""

OTHERS = {"HDF5": "HDF5 under another name; rename it to .hdf5", "HDF4": "HDF4, which is not read"}
"""Format of a file whose name does not tell it → description."""

NOT_HDF5 = (*PICTURES, ".json", ".jsonl", ".parquet", ".mp4", ".txt", ".md", ".yaml", ".yml")
"""Ends of the names of files that are not opened."""


def is_hdf5_by_name(file: Path) -> bool:
    """True if a file is read as HDF5, by the end of its name; HDF4 may have the same one, and is not read."""
    return file.suffix.lower() in SUFFIXES and _format(file) != "HDF4"


def data_sets_in(root: Path, files: Iterable[Path]) -> list[Path]:
    """List the LeRobot data sets below a folder, that itself left out, in the order of its files."""
    found = [file.parent.parent for file in files if Path(*file.parts[-2:]) in (INFO, FIRST_INFO)]
    return list(dict.fromkeys(folder for folder in found if folder != root))


def passed_over(
    root: Path, files: Collection[Path], *, whole: bool = False, folders: Collection[Path] = ()
) -> dict[str, str]:
    """Return the skipped parts below a folder: data sets, folders of pictures, HDF5 files of other names.

    Args:
        root: the folder.
        files: all below it.
        whole: the folder is a data set itself, whose pictures belong to it, and HDF5 files below it are not read.
        folders: of pictures that are read.
    """
    sets = data_sets_in(root, files)
    found = dict.fromkeys(sets, "a LeRobot data set; give it by itself")
    alone = [file for file in files if set(sets).isdisjoint(file.parents)]
    for file in alone:
        kind = _format(file)
        if is_hdf5_by_name(file):
            found |= {file: "an HDF5 file; give it by itself"} if whole else {}
        elif kind is not None:
            found[file] = OTHERS[kind]
    if not whole:
        found |= _pictures(root, alone, folders)
    return {printable(root, path): what for path, what in found.items()}


def _pictures(root: Path, files: Iterable[Path], read: Collection[Path]) -> dict[Path, str]:
    """Return entry of the folder → number of folders with pictures in it that are not read, in words."""
    counts = Counter(file.parent for file in files if file.suffix.lower() in PICTURES)
    more = [folder for folder, count in counts.items() if count > 1 and folder not in read]
    tops = Counter(root if folder == root else root / folder.relative_to(root).parts[0] for folder in more)
    return {top: f"pictures in {count} folder{'s' * (count > 1)}; give it by itself" for top, count in tops.items()}


def printable(root: Path, path: Path) -> str:
    """Return the path from the root on, with escapes where it is not UTF-8."""
    return os.fsencode(path.relative_to(root)).decode(errors="backslashreplace")


def _format(file: Path) -> str | None:
    """Return the format of a regular file by its first bytes, where its name does not tell it; None if unknown."""
    if file.suffix.lower() in NOT_HDF5 or not file.is_file():
        return None
    try:
        with file.open("rb") as data:
            head = data.read(8)
    except OSError:  # its reader complains of it
        return None
    return next((kind for magic, kind in SIGNATURES.items() if head.startswith(magic)), None)


UNKNOWN = "not understood as picture, command or state"

REASONS: Mapping[str, str] = {
    r"^next_obs\b": "the observations one step later",
    r"(^|[/_])depths?($|[/_])": "depth, which a colour video cannot hold",
    r"segmentation|(^|[/_])seg($|[/_])": "segmentation, which a colour video cannot hold",
    r"point_?cloud": "point clouds have no column in a LeRobot data set",
    r"intrinsic|extrinsic|cam2world|sensor_param": "LeRobot has no place for camera calibration",
    r"^(states|env_states|initial_state|init_state)\b": "state of the simulator",
    r"(^|/)(rewards?|dones?|terminated|truncated|success|fail)$": "labels of reinforcement learning, not exported",
    r"(^|[/_])(force|torque|effort|tactile|wrench)s?($|[/_0-9])": "forces, not exported",
    r"(^|[/_])(vel|qvel|velocity|velocities)$": "velocities, not part of the exported state",
    r"(^|[/_])time(stamps?|s)?$": "LeRobot counts time by frames",
    r"(^|[/_])(ee|eef|tcp)[a-z]*([/_]|$)|endpose|end_effector": "end-effector pose, not part of the exported state",
}
"""Pattern of a key → reason; the first that matches counts."""


def leftovers(part: h5py.Group, taken: Collection[str], reasons: Mapping[str, str] | None = None) -> dict[str, str]:
    """Return key relative to ``part`` → reason, of all non-empty datasets in it that are not taken.

    A group without any used part is one entry.

    Args:
        part: of an open file.
        taken: keys of datasets in the file, from its root, without leading slash.
        reasons: of the layout, looked at before :data:`REASONS`.
    """
    prefix = part.name.strip("/")
    used = {key.removeprefix(f"{prefix}/") if prefix else key for key in taken}
    places = {address(part.file[key]) for key in taken if key in part.file}
    used_groups = {parent for key in used for parent in _parents(key)}
    left = [key for key, one in datasets_in(part).items() if one.size and address(one) not in places]
    shown = (next((parent for parent in _parents(key) if parent not in used_groups), key) for key in left)
    every = {**(reasons or {}), **REASONS}
    return {key: _reason_for(key, every) for key in dict.fromkeys(shown)}


def _reason_for(key: str, reasons: Mapping[str, str]) -> str:
    """Return the reason of the first pattern that a key matches."""
    return next((reason for pattern, reason in reasons.items() if re.search(pattern, key)), UNKNOWN)


def _parents(key: str) -> list[str]:
    """Return the groups that a key lies in, the outermost first."""
    return ["/".join(key.split("/")[:end]) for end in range(1, key.count("/") + 1)]
