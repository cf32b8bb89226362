"""Labels of success: in which forms they are read, and that the same forms count in every layout."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from tests.datasets.packing.orders import order
from tests.datasets.recordings.layouts import act, robomimic, robotwin
from tests.datasets.recordings.simulators import isaac_lab, libero, maniskill
from vcage.base.errors import DamagedFile
from vcage.datasets.packing.inspecting import inspect
from vcage.datasets.packing.pack import prepare
from vcage.datasets.packing.sources import find_sources
from vcage.datasets.recordings.opening import open_recordings
from vcage.datasets.recordings.success import label_of

FALSE = [
    False,
    0,
    0.0,
    [False],
    [[True, False]],
    "False",
    "0",
    b"no",
    "FAILED",
    "Failure",
    np.array([1, 0]),
    np.bool_(False),
    np.float32(0),
]


@pytest.mark.parametrize("value", FALSE, ids=repr)
def test_every_form_of_a_false_label_is_read(value):
    assert label_of(value, "here") is False


@pytest.mark.parametrize(
    "value", [True, 1, 1.0, [False, True], "true", " Yes ", "Success", "succeeded", np.array([0, 1])], ids=repr
)
def test_every_form_of_a_true_label_is_read(value):
    assert label_of(value, "here") is True


@pytest.mark.parametrize("value", [None, [], np.zeros(0)], ids=repr)
def test_an_empty_label_says_nothing(value):
    assert label_of(value, "here") is None


@pytest.mark.parametrize("value", [2, 0.5, float("nan"), "maybe", "", {"a": 1}, [None, {}]], ids=repr)
def test_an_unclear_label_is_refused_by_its_place(value):
    with pytest.raises(DamagedFile, match=r"here is .*neither true nor false"):
        label_of(value, "here")


def described(path: Path, **row: object) -> Path:
    """ManiSkill trajectories without labels, the second of which the description describes so."""
    maniskill(path, (None, None, None), labels=False)
    file = path.with_suffix(".json")
    told = json.loads(file.read_text())
    for number, one in enumerate(told["episodes"]):
        one.update({"success": True} if number != 1 else row)
    file.write_text(json.dumps(told))
    return path


@pytest.mark.parametrize(
    "row",
    [
        *({"success": value} for value in (False, 0, 0.0, [False], [True, False], "false")),
        *({"success": False, "episode_id": value} for value in ("1", 1.0, "traj_1")),
        *({"success": True, "fail": value} for value in (True, 1, [True])),
    ],
    ids=repr,
)
def test_a_failure_in_the_description_of_maniskill_is_read_in_every_form(tmp_path, row):
    assert [bool(one.failed) for one in open_recordings(described(tmp_path / "a.h5", **row))] == [False, True, False]


@pytest.mark.parametrize(
    ("row", "field"),
    [
        ({"success": "maybe"}, "success of episode 1"),
        ({"episode_id": None}, r"episodes\[1\].episode_id"),
        ({"episode_id": 0}, "describes episode 0 twice"),
    ],
)
def test_an_unclear_description_is_refused_by_its_field(tmp_path, row, field):
    path = described(tmp_path / "a.h5", **row)
    with pytest.raises(DamagedFile, match=rf"a\.json.*{field}"):
        prepare(order(path, tmp_path / "out", target="lerobot-v3.0", task="pick"))


@pytest.mark.parametrize(
    ("content", "field"),
    [([{"episode_id": 1, "success": False}], "its content is list"), ({"episodes": {"1": {}}}, "episodes is dict")],
)
def test_a_description_without_a_list_of_episodes_is_refused_once(tmp_path, content, field):
    path = maniskill(tmp_path / "a.h5", (True, True))
    path.with_suffix(".json").write_text(json.dumps(content))
    with pytest.raises(DamagedFile, match=field) as refused:
        find_sources(path, order(path, tmp_path / "out").settings)
    assert refused.value.message.count("a.json") == 1


@pytest.mark.parametrize(
    ("content", "said"), [({"env_info": {}}, "names no episodes"), ({"episodes": []}, "does not describe it")]
)
def test_a_trajectory_missing_in_the_description_is_reported(tmp_path, content, said):
    path = maniskill(tmp_path / "a.h5", (None,), labels=False)
    path.with_suffix(".json").write_text(json.dumps(content))
    notes = open_recordings(path)[0].notes
    assert any(said in note for note in notes) and not any("nobody" in note for note in notes)


@pytest.mark.parametrize("value", [False, np.uint8(0), np.array([True, False]), b"False", "no"], ids=repr)
@pytest.mark.parametrize("stored", ["attribute", "dataset"])
@pytest.mark.parametrize("write", [isaac_lab, libero, robomimic, robotwin, act])
def test_every_layout_reads_the_same_labels(tmp_path, write, stored, value):
    path = write(tmp_path / "a.hdf5")
    with h5py.File(path, "r+") as file:
        part = file.get("data/demo_0", file)
        part.attrs.pop("success", None)
        if stored == "attribute":
            part.attrs["success"] = value
        else:
            part["success"] = value
    assert open_recordings(path)[0].failed == "its success is false"


def test_an_unclear_label_in_hdf5_is_skipped_as_damaged_on_request(tmp_path):
    path = isaac_lab(tmp_path / "a.hdf5", (True, True))
    with h5py.File(path, "r+") as file:
        file["data/demo_1"].attrs["success"] = "maybe"
    wanted = order(path, tmp_path / "out", target="lerobot-v3.0", task="stack")
    with pytest.raises(DamagedFile, match=r"a\.hdf5:/data/demo_1/success is 'maybe'"):
        prepare(wanted)
    assert list(prepare(replace(wanted, skip_damaged=True)).sources.damaged) == ["a.demo_1"]


@pytest.mark.parametrize("write", [isaac_lab, libero, robotwin])
def test_a_score_stays_in_hdf5_and_is_noted(tmp_path, write):
    path = write(tmp_path / "a.hdf5")
    with h5py.File(path, "r+") as file:
        file.get("data/demo_0", file).attrs["success"] = 0.87
    note = "success is 0.87, which says neither true nor false"
    assert [note in one.notes for one in inspect(path)] == [True]
    assert note in prepare(order(path, tmp_path / "out")).sources.sources[0].notes
