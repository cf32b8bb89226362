"""What drives were told comes back from a file as it was, and takes little there."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from vcage.datasets.stored_drives import read_drives, write_drives
from vcage.sim.drive_log import DriveLog
from vcage.sim.drives import PARTS, DriveLayout, on_grid

LAYOUT = DriveLayout(joints=6, dof=8)
STEPS = 1000


@pytest.fixture
def drives() -> DriveLog:
    """One arm that swings, and one that rests off the origin."""
    time = np.arange(STEPS)[:, None] / 250
    rows = np.zeros((STEPS, LAYOUT.size))
    for part in PARTS[:-1]:
        rows[:, LAYOUT.part(part)] = on_grid(part, np.sin(3 * time + np.arange(LAYOUT.size)[LAYOUT.part(part)]))
    rows[:, LAYOUT.part("opening")] = np.where(time > 2, 1 / 3, 1.0)
    rest = np.tile(rows[7], (STEPS, 1))
    layouts = {"left": LAYOUT, "right": LAYOUT}
    return DriveLog(110, [110, 700], layouts, {"left": list(rows), "right": list(rest)})


@pytest.fixture
def file(drives: DriveLog, tmp_path: Path) -> Path:
    with h5py.File(tmp_path / "drives.hdf5", "w") as file:
        write_drives(file.create_group("drives"), drives)
    return tmp_path / "drives.hdf5"


def test_drives_come_back_bit_for_bit(drives, file):
    with h5py.File(file) as stored:
        found = read_drives(stored["drives"])
    assert (found.settled, found.restarts, found.layouts) == (110, [110, 700], drives.layouts)
    for arm, rows in drives.rows.items():
        assert np.array_equal(np.stack(found.rows[arm]), np.stack(rows))


def test_an_arm_that_rests_takes_next_to_nothing(file):
    with h5py.File(file) as stored:
        sizes = {arm: stored[f"drives/{arm}/told"].id.get_storage_size() for arm in ("left", "right")}
    assert sizes["right"] < 1000 < sizes["left"] < STEPS * 4 * LAYOUT.size / 3
