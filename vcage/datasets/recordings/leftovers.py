"""Datasets of a recording that are neither picture nor command nor state: named, with the reason, few entries each."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping

import h5py

from vcage.datasets.hdf5_contents import address, datasets_in

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

    A group of which nothing is taken is one entry.

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
