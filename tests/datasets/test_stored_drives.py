"""Commands to drives come back from a file unchanged, and take few bytes there."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from vcage.base.errors import DamagedFile
from vcage.datasets.stored_drives import read_drives, write_drives
from vcage.sim.drives import PARTS, DriveLayout, DriveLog, on_grid

LAYOUT = DriveLayout(joints=6, dof=8)
STEPS = 1000


@pytest.fixture
def drives() -> DriveLog:
    """One arm that swings, and one at rest off the origin."""
    time = np.arange(STEPS)[:, None] / 250
    rows = np.zeros((STEPS, LAYOUT.size))
    for part in PARTS[:-1]:
        rows[:, LAYOUT.part(part)] = on_grid(part, np.sin(3 * time + np.arange(LAYOUT.size)[LAYOUT.part(part)]))
    rows[:, LAYOUT.part("opening")] = np.where(time > 2, 1 / 3, 1.0)
    rest = np.tile(rows[7], (STEPS, 1))
    layouts = {"left": LAYOUT, "right": LAYOUT}
    return DriveLog(110, [110, 700], layouts, {"left": list(rows), "right": list(rest)}, frames_from=110)


@pytest.fixture
def file(drives: DriveLog, tmp_path: Path) -> Path:
    with h5py.File(tmp_path / "drives.hdf5", "w") as file:
        write_drives(file.create_group("drives"), drives)
    return tmp_path / "drives.hdf5"


def test_drives_come_back_bit_for_bit(drives, file):
    with h5py.File(file) as stored:
        found = read_drives(stored["drives"])
    assert (found.settled, found.restarts, found.layouts) == (110, [110, 700], drives.layouts)
    assert found.frames_from == 110
    for arm, rows in drives.rows.items():
        assert np.array_equal(np.stack(found.rows[arm]), np.stack(rows))


def test_frames_of_older_files_count_from_the_first_step_of_the_world(file):
    with h5py.File(file, "r+") as stored:
        del stored["drives"].attrs["frames_from"]
        assert read_drives(stored["drives"]).frames_from == 0


def put(file: h5py.File, name: str, value: object) -> None:
    """Other data in place of a dataset's, with the attributes that it has."""
    attributes = dict(file[name].attrs)
    del file[name]
    file[name] = value
    file[name].attrs.update(attributes)


ATTRIBUTES = [
    ("drives", "settled", 10**9),
    ("drives", "frames_from", 111),
    ("drives", "settled", -1),
    ("drives", "settled", 110.5),
    ("drives", "settled", "110"),
    ("drives", "restarts", "[-5, 1e9]"),
    ("drives", "restarts", 110),
    ("drives", "restarts", np.array([110.0])),
    ("drives", "restarts", np.array([109])),
    ("drives", "restarts", np.array([110, 1111])),
    ("drives", "restarts", np.array([700, 700])),
    ("drives", "restarts", np.arange(100, 1102)),
    ("drives/left/told", "joints", 99),
    ("drives/left/told", "joints", 0),
    ("drives/left/told", "position", np.nan),
    ("drives/left/told", "position", 1e300),
    ("drives/left/told", "velocity", "fast"),
    ("drives/left/told", "torque", -1.0),
]


@pytest.mark.parametrize(("part", "name", "value"), ATTRIBUTES)
def test_an_attribute_that_no_simulation_takes_is_refused_by_file_and_part(file, part, name, value):
    with h5py.File(file, "r+") as stored:
        stored[part].attrs[name] = value
        with pytest.raises(DamagedFile, match=rf"drives\.hdf5:/{part} has .*{name}"):
            read_drives(stored["drives"])


@pytest.mark.parametrize("name", ["settled", "restarts"])
def test_a_missing_attribute_is_named(file, name):
    with h5py.File(file, "r+") as stored:
        del stored["drives"].attrs[name]
        with pytest.raises(DamagedFile, match=f"attribute {name} None"):
            read_drives(stored["drives"])


TABLES = [
    ("opening", lambda table: table * np.nan, "is not finite"),
    ("opening", lambda table: table * np.inf, "is not finite"),
    ("opening", lambda table: table + 1e7, "beyond"),
    ("opening", lambda table: table[:, 1:], "has the shape"),
    ("opening", lambda table: "open", "expected a table"),
    ("told", lambda table: table.astype(float), "expected a table"),
    ("told", lambda table: table[0], "expected a table"),
    ("told", lambda table: table * 0 + 2**30, "beyond"),
]


@pytest.mark.parametrize(("name", "change", "reason"), TABLES)
@pytest.mark.filterwarnings("ignore:invalid value")
def test_numbers_that_no_drive_takes_are_refused_by_file_and_dataset(file, name, change, reason):
    with h5py.File(file, "r+") as stored:
        put(stored, f"drives/left/{name}", change(stored[f"drives/left/{name}"][()]))
        with pytest.raises(DamagedFile, match=rf"drives\.hdf5:/drives/left/{name} .*{reason}"):
            read_drives(stored["drives"])


def test_a_missing_part_is_named(file):
    with h5py.File(file, "r+") as stored:
        del stored["drives/left/opening"]
        with pytest.raises(DamagedFile, match="/drives/left has no dataset opening"):
            read_drives(stored["drives"])
        del stored["drives/left"]
        stored["drives/left"] = 3
        with pytest.raises(DamagedFile, match="/drives/left is not the group of an arm"):
            read_drives(stored["drives"])


def test_arms_have_as_many_steps_as_each_other(file):
    with h5py.File(file, "r+") as stored:
        for name in ("told", "opening"):
            put(stored, f"drives/left/{name}", stored[f"drives/left/{name}"][:, 1:])
        with pytest.raises(DamagedFile, match="left has 999, right has 1000"):
            read_drives(stored["drives"])


def test_an_arm_that_rests_takes_next_to_nothing(file):
    with h5py.File(file) as stored:
        sizes = {arm: stored[f"drives/{arm}/told"].id.get_storage_size() for arm in ("left", "right")}
    assert sizes["right"] < 1000 < sizes["left"] < STEPS * 4 * LAYOUT.size / 3
