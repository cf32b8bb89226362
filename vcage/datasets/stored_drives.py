"""Commands to the drives at every physics step in an episode's file: a few bits for each number.

All but the opening of a gripper are whole steps of a grid (:mod:`vcage.sim.drives`), and change smoothly. So their
third differences over time are stored, (numbers, S) int32 with the sign in the lowest bit (0, -1, 1, -2 … are 0, 1, 2,
3 …), shuffled and compressed: 31 kB for 12 s, where float32 takes 600.

Layout, in ``/drives``, whose attributes are ``settled``, ``restarts`` and ``frames_from``, which files of 0.1.0 lack
(:class:`~vcage.sim.drives.DriveLog`)::

    <arm>/told    (2 n + dof, S) int32, see above: positions and velocities of the n joints, torques of all dof
    <arm>/opening (1, S) float64, as it is

Attributes of ``told``: joints (n), and position, velocity and torque, the size of one step of each.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import h5py
import numpy as np

from vcage.base.errors import DamagedFile
from vcage.datasets.hdf5_contents import require_numbers_fit
from vcage.sim.drives import GRID, DriveLayout, DriveLog
from vcage.sim.world import PHYSICS_HZ

ORDER = 3
"""Of the differences: of 2, 3 and 4 the one that takes least."""


@dataclass(frozen=True)
class DriveLimits:
    """Limits on a file.

    Args:
        max_settled_steps: physics steps before the first row; a minute.
        max_restarts: worlds that are built afresh.
        max_value: of any command to a drive, in its unit (rad, m, per s, N m, N).
    """

    max_settled_steps: int = 60 * PHYSICS_HZ
    max_restarts: int = 1000
    max_value: float = 1e6


LIMITS = DriveLimits()


def write_drives(group: h5py.Group, drives: DriveLog) -> None:
    """Fill a group."""
    group.attrs["settled"] = drives.settled
    group.attrs["frames_from"] = drives.frames_from
    group.attrs["restarts"] = np.array(drives.restarts, np.int64)
    for arm, rows in drives.rows.items():
        table, layout = np.stack(rows), drives.layouts[arm]
        steps = [np.rint(table[:, layout.part(part)] / step) for part, step in GRID.items()]
        told = _create(group, f"{arm}/told", _packed(np.concatenate(steps, axis=1)))
        told.attrs.update({"joints": layout.joints, **GRID})
        _create(group, f"{arm}/opening", table[:, layout.part("opening")])


def read_drives(group: h5py.Group, limits: DriveLimits = LIMITS) -> DriveLog:
    """Read and check the output of :func:`write_drives` for simulation.

    Args:
        group: of a possibly foreign file.
        limits: on the steps and numbers.

    Raises:
        DamagedFile: a part is missing, or has another type or shape, or a number that is not finite, too large or out
            of order; names the file and the part.
    """
    layouts, rows = {}, {}
    for arm, stored in group.items():
        if not isinstance(stored, h5py.Group):
            raise _refused(stored, "is not the group of an arm")
        layouts[arm], table = _read_arm(stored, limits)
        rows[arm] = list(table)
    if not rows or len({len(own) for own in rows.values()}) > 1:
        lengths = ", ".join(f"{arm} has {len(own)}" for arm, own in rows.items())
        raise _refused(group, f"must have as many steps for one arm as for another: {lengths or 'it has no arm'}")
    settled = _whole_number(group, "settled", 0, limits.max_settled_steps)
    frames_from = _whole_number(group, "frames_from", 0, settled) if "frames_from" in group.attrs else 0
    restarts = _read_restarts(group, settled, len(next(iter(rows.values()))), limits)
    return DriveLog(settled, restarts, layouts, rows, frames_from)


def _read_arm(group: h5py.Group, limits: DriveLimits) -> tuple[DriveLayout, np.ndarray]:
    """Return the layout and the (S, k) rows of an arm."""
    told, opening = (_table(group, name, kinds) for name, kinds in (("told", "iu"), ("opening", "f")))
    if opening.shape != (1, told.shape[1]):
        raise _refused(opening, f"has the shape {opening.shape}, expected (1, {told.shape[1]})")
    joints = _whole_number(told, "joints", 1, told.shape[0] // 3)
    layout = DriveLayout(joints, told.shape[0] - 2 * joints)
    values = _unpacked(told[()].T)
    parts = {part: values[:, layout.part(part)] * _step(told, part) for part in GRID}
    parts["opening"] = opening[()].T
    for part, found in parts.items():
        if not (np.abs(found) <= limits.max_value).all():  # which NaN is not either
            what = opening if part == "opening" else told
            raise _refused(what, f"holds a number for {part} that is not finite, or beyond {limits.max_value:g}")
    return layout, np.concatenate(list(parts.values()), axis=1)


def _table(group: h5py.Group, name: str, kinds: str) -> h5py.Dataset:
    """Return a dataset of numbers along two axes, with at least one step."""
    found = group.get(name)
    if not isinstance(found, h5py.Dataset):
        raise _refused(group, f"has no dataset {name}")
    if found.dtype.kind not in kinds or found.ndim != 2 or 0 in found.shape:
        raise _refused(found, f"is {found.shape} {found.dtype}, expected a table of numbers over time")
    require_numbers_fit(found)
    return found


def _step(told: h5py.Dataset, part: str) -> float:
    """Return the size of one step of a part."""
    found = told.attrs.get(part)
    if not isinstance(found, (float, np.floating)) or not 0 < found <= 1:  # which NaN is not either
        raise _refused(told, f"has the attribute {part} {found!r}, expected a step above 0, at most 1")
    return float(found)


def _whole_number(owner: h5py.Group | h5py.Dataset, name: str, least: int, most: int) -> int:
    found = owner.attrs.get(name)
    if not isinstance(found, (int, np.integer)) or not least <= found <= most:
        raise _refused(owner, f"has the attribute {name} {found!r}, expected a whole number from {least} to {most}")
    return int(found)


def _read_restarts(group: h5py.Group, settled: int, steps: int, limits: DriveLimits) -> list[int]:
    """Return steps, increasing, among the recorded ones."""
    found = group.attrs.get("restarts")
    if not isinstance(found, np.ndarray) or found.ndim != 1 or found.dtype.kind not in "iu":
        raise _refused(group, f"has the attribute restarts {found!r}, expected a list of whole numbers")
    restarts = found.tolist()
    if len(restarts) > limits.max_restarts:
        raise _refused(group, f"has {len(restarts)} restarts; at most {limits.max_restarts} are simulated")
    rising = all(one < after for one, after in pairwise(restarts))
    if restarts and not (rising and settled <= restarts[0] and restarts[-1] <= settled + steps):
        raise _refused(group, f"has restarts that do not increase from {settled} to at most {settled + steps}")
    return restarts


def _refused(owner: h5py.Group | h5py.Dataset, why: str) -> DamagedFile:
    return DamagedFile(
        f"{owner.file.filename}:{owner.name} {why}", hint="restore the file, or record the episode again"
    )


def _create(group: h5py.Group, name: str, table: np.ndarray) -> h5py.Dataset:
    """Write a table (S, k) with time along its rows, compressed in one piece."""
    data = np.ascontiguousarray(table.T)
    filters = {"shuffle": True, "compression": "gzip", "compression_opts": 9, "fletcher32": True}
    return group.create_dataset(name, data=data, chunks=data.shape, track_times=False, **filters)


def _packed(values: np.ndarray) -> np.ndarray:
    """Return (S, k) int32 of whole numbers."""
    before = np.zeros((ORDER, values.shape[1]), np.int64)
    differences = np.diff(values.astype(np.int64), n=ORDER, axis=0, prepend=before)
    return ((differences << 1) ^ (differences >> 63)).astype(np.int32)


def _unpacked(stored: np.ndarray) -> np.ndarray:
    """Return (S, k) whole numbers of the output of :func:`_packed`."""
    folded = stored.astype(np.int64)
    values = (folded >> 1) ^ -(folded & 1)
    for _ in range(ORDER):
        values = values.cumsum(axis=0)
    return values
