"""What drives were told at every physics step, as it lies in an episode's file: a few bits for each number.

All but the opening of a gripper are whole steps of a grid (:mod:`vcage.sim.drives`), and change smoothly. So their
third differences over time are stored, (numbers, S) int32 with the sign in the lowest bit (0, -1, 1, -2 … are 0, 1, 2,
3 …), shuffled and compressed: 31 kB for 12 s, where float32 takes 600.

Layout, in ``/drives``, whose attributes are ``settled`` and ``restarts`` (:class:`~vcage.sim.drive_log.DriveLog`)::

    <arm>/told    (2 n + dof, S) int32, see above: positions and velocities of the n joints, torques of all dof
    <arm>/opening (1, S) float64, as it is

Attributes of ``told``: joints (n), and position, velocity and torque, the size of one step of each.
"""

from __future__ import annotations

import h5py
import numpy as np

from vcage.sim.drive_log import DriveLog
from vcage.sim.drives import GRID, DriveLayout

ORDER = 3
"""Of the differences: of 2, 3 and 4 the one that takes least."""


def write_drives(group: h5py.Group, drives: DriveLog) -> None:
    """Fill a group."""
    group.attrs["settled"] = drives.settled
    group.attrs["restarts"] = np.array(drives.restarts, np.int64)
    for arm, rows in drives.rows.items():
        table, layout = np.stack(rows), drives.layouts[arm]
        steps = [np.rint(table[:, layout.part(part)] / step) for part, step in GRID.items()]
        told = _create(group, f"{arm}/told", _packed(np.concatenate(steps, axis=1)))
        told.attrs.update({"joints": layout.joints, **GRID})
        _create(group, f"{arm}/opening", table[:, layout.part("opening")])


def read_drives(group: h5py.Group) -> DriveLog:
    """The inverse of :func:`write_drives`."""
    layouts, rows = {}, {}
    for arm, stored in group.items():
        told, attributes = _unpacked(stored["told"][()].T), stored["told"].attrs
        joints = int(attributes["joints"])
        layouts[arm] = layout = DriveLayout(joints, told.shape[1] - 2 * joints)
        values = [told[:, layout.part(part)] * attributes[part] for part in GRID]
        rows[arm] = list(np.concatenate([*values, stored["opening"][()].T], axis=1))
    return DriveLog(int(group.attrs["settled"]), group.attrs["restarts"].tolist(), layouts, rows)


def _create(group: h5py.Group, name: str, table: np.ndarray) -> h5py.Dataset:
    """A dataset of a table (S, k) with time along its rows, compressed in one piece."""
    data = np.ascontiguousarray(table.T)
    filters = {"shuffle": True, "compression": "gzip", "compression_opts": 9, "fletcher32": True}
    return group.create_dataset(name, data=data, chunks=data.shape, track_times=False, **filters)


def _packed(values: np.ndarray) -> np.ndarray:
    """(S, k) int32 of whole numbers."""
    before = np.zeros((ORDER, values.shape[1]), np.int64)
    differences = np.diff(values.astype(np.int64), n=ORDER, axis=0, prepend=before)
    return ((differences << 1) ^ (differences >> 63)).astype(np.int32)


def _unpacked(stored: np.ndarray) -> np.ndarray:
    """(S, k) whole numbers of what :func:`_packed` gives."""
    folded = stored.astype(np.int64)
    values = (folded >> 1) ^ -(folded & 1)
    for _ in range(ORDER):
        values = values.cumsum(axis=0)
    return values
