"""Folders that hold more than is read: nothing in them vanishes without a word."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.datasets.packing.orders import order, packed
from tests.datasets.recordings.layouts import act, jpeg, room
from vcage.base.errors import DamagedFile, InputFileError
from vcage.datasets.packing.inspecting import as_lines, inspect, totals
from vcage.datasets.packing.sources import find_sources
from vcage.datasets.recordings.opening import open_all

READ = ("0.hdf5", "1.HDF5", "2.h5", "3.H5", "4.hdf", "5.he5", "6.Hdf5")


def pictures(folder: Path, count: int = 2) -> Path:
    folder.mkdir(parents=True)
    for index in range(count):
        (folder / f"{index}.jpg").write_bytes(jpeg(room(index)))
    return folder


@pytest.fixture
def mixed(tmp_path, v21) -> Path:
    root = tmp_path / "mixed"
    pictures(root / "cams/left"), pictures(root / "cams/right")
    shutil.copytree(v21, root / "sets/a")
    act(root / "0.hdf5")
    act(root / "1.mat")
    return root


def test_hdf5_files_are_read_in_any_case_and_suffix(tmp_path):
    for name in READ:
        act(tmp_path / name)
    opened = open_all(tmp_path)
    assert [one.path.name for one in opened.recordings] == list(READ)
    assert not opened.passed_over


def test_files_named_like_hdf5_of_another_format_are_damaged_or_named(tmp_path):
    act(tmp_path / "0.hdf5")
    (tmp_path / "1.HDF5").write_bytes(b"no file of numbers")
    (tmp_path / "2.hdf").write_bytes(b"\x0e\x03\x13\x01" + bytes(60))
    opened = open_all(tmp_path)
    assert [path.name for path in opened.damaged] == ["1.HDF5"]
    assert opened.passed_over == {"2.hdf": "HDF4, which is not read"}


def test_a_mixed_folder_names_the_skipped_files(mixed):
    passed = open_all(mixed).passed_over
    assert set(passed) == {"sets/a", "cams", "1.mat"}
    assert "LeRobot data set" in passed["sets/a"] and "2 folders" in passed["cams"] and "rename" in passed["1.mat"]


def test_skipped_files_are_in_the_summary_and_the_notes(mixed, tmp_path):
    found = inspect(mixed)
    assert set(totals(found)["passed_over"]) == {"sets/a", "cams", "1.mat"}
    assert (totals(found)["recordings"], totals(found)["damaged"]) == (1, {})
    assert "sets/a is not read: a LeRobot data set" in as_lines(found)
    done = packed(mixed, tmp_path / "out")
    assert any(note.startswith("sets/a is not read") for note in done.record.notes["."])


def test_a_data_set_beside_a_folder_of_pictures_is_named(tmp_path, v21):
    pictures(tmp_path / "cam"), pictures(tmp_path / "more/inside")
    shutil.copytree(v21, tmp_path / "set")
    opened = open_all(tmp_path)
    assert [one.LAYOUT for one in opened.recordings] == ["pictures"]
    assert set(opened.passed_over) == {"set", "more"}


def test_hdf5_in_a_data_set_is_named(tmp_path, v21):
    act(shutil.copytree(v21, tmp_path / "set") / "raw.h5")
    assert open_all(tmp_path / "set").passed_over == {"raw.h5": "an HDF5 file; give it by itself"}


def test_a_folder_of_data_sets_lists_the_possible_inputs(tmp_path, v21, v3):
    shutil.copytree(v21, tmp_path / "a")
    shutil.copytree(v3, tmp_path / "more/b")
    with pytest.raises(InputFileError, match="LeRobot data set") as refused:
        open_all(tmp_path)
    assert refused.value.hint == "give one of a, more/b"


def test_pictures_further_down_are_named_where_nothing_else_is(tmp_path):
    pictures(tmp_path / "one/two/three")
    with pytest.raises(InputFileError, match=r"one \(pictures in 1 folder\)"):
        open_all(tmp_path)


def test_files_of_a_data_set_and_of_an_output_are_not_named_as_skipped(tmp_path, v21):
    act(tmp_path / "in.hdf5")
    packed(tmp_path / "in.hdf5", tmp_path / "out")
    assert open_all(tmp_path / "out").passed_over == {} == open_all(v21).passed_over


def test_a_damaged_file_of_another_suffix_is_refused(tmp_path):
    act(tmp_path / "0.hdf5")
    (tmp_path / "1.he5").write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n")
    with pytest.raises(DamagedFile, match="git lfs pull"):
        find_sources(tmp_path, order(tmp_path, tmp_path / "out").settings)
