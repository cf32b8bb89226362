"""Paths in records stay in the run folder, and nothing in that folder leads elsewhere."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from vcage.base.errors import InputFileError
from vcage.base.files import RunFolder
from vcage.base.inside import name_complaint, path_complaint, require_no_links

LEADING_OUT = {
    "absolute": "/etc/passwd",
    "up": "../x.png",
    "up inside": "place/../../x.png",
    "up at the end": "place/..",
    "the folder itself": ".",
    "nothing": "",
    "NUL": "place/a\0b.png",
    "a long name": "x" * 300,
    "a long path": "x/" * 1000 + "x",
    "no text": "\ud800.png",
}


@pytest.mark.parametrize("path", LEADING_OUT.values(), ids=LEADING_OUT)
def test_a_path_that_leads_out_is_refused(path: str) -> None:
    assert path_complaint(path)
    with pytest.raises(InputFileError):
        RunFolder("/tmp").file(path)


@pytest.mark.parametrize(("path", "stage"), [("mine/x.png", ""), ("../mine/x", "episodes"), ("../../x", "episodes")])
def test_a_record_names_only_files_of_stages_as_all_else_may_be_a_link(path: str, stage: str, tmp_path: Path) -> None:
    (tmp_path / "mine").symlink_to("/")
    with pytest.raises(InputFileError):
        RunFolder(tmp_path).file(path, stage)


def test_a_path_from_the_folder_of_a_stage_may_lead_to_another_stage(tmp_path: Path) -> None:
    run = RunFolder(tmp_path)
    assert run.file("../episodes/critic/a.png", "verify") == tmp_path / "episodes" / "critic" / "a.png"
    assert run.file("critic/a.png", "episodes") == run.file("episodes/critic/a.png")


@pytest.mark.parametrize("path", ["place/source.png", "./x", "episodes//e.hdf5", "..x/y..", "Ä ö/…"])
def test_a_path_that_stays_inside_is_taken(path: str) -> None:
    assert path_complaint(path) is None


def test_a_path_may_go_up_only_the_allowed_number_of_folders() -> None:
    assert path_complaint("../episodes/x.png", up=1) is None
    assert path_complaint("../../x.png", up=1) and path_complaint("a/../x.png", up=1) and path_complaint("..", up=1)


def test_a_bare_name_has_no_folder() -> None:
    assert name_complaint("x.png") is None
    assert name_complaint("a/x.png") and name_complaint("..") and name_complaint("/x.png")


def linked_folder(root: Path, elsewhere: Path) -> Path:
    (root / "episodes").symlink_to(elsewhere)
    return root / "episodes"


def linked_file(root: Path, elsewhere: Path) -> Path:
    (root / "episodes" / "critic").mkdir(parents=True)
    (root / "episodes" / "critic" / "a.png").symlink_to(elsewhere / "a.png")
    return root / "episodes" / "critic" / "a.png"


def link_to_itself(root: Path, elsewhere: Path) -> Path:
    (root / "report.html").symlink_to("report.html")
    return root / "report.html"


def link_of_a_killed_stage(root: Path, elsewhere: Path) -> Path:
    (root / "episodes.replaced-1").symlink_to(elsewhere)
    return root / "episodes.replaced-1"


def link_within(root: Path, elsewhere: Path) -> Path:
    (root / "notes").mkdir()
    (root / "place").symlink_to("notes")
    return root / "place"


def pipe(root: Path, elsewhere: Path) -> Path:
    os.mkfifo(root / "options.json")
    return root / "options.json"


@pytest.mark.parametrize(
    "plant", [linked_folder, linked_file, link_to_itself, link_of_a_killed_stage, link_within, pipe]
)
def test_a_run_with_a_link_or_a_pipe_is_refused_by_its_name(plant, tmp_path: Path) -> None:
    run, elsewhere = tmp_path / "run", tmp_path / "elsewhere"
    run.mkdir()
    elsewhere.mkdir()
    planted = plant(run, elsewhere)
    with pytest.raises(InputFileError) as told:
        _ = RunFolder(run).scene
    assert told.value.message.startswith(str(planted)) and told.value.details == {"path": str(planted)}


def test_files_outside_a_run_may_be_links(tmp_path: Path) -> None:
    (tmp_path / "home").symlink_to("/")
    (tmp_path / "run").symlink_to(tmp_path)
    assert RunFolder(tmp_path / "run").scene == tmp_path / "place" / "scene.json"


def test_folders_in_one_another_have_an_end(tmp_path: Path) -> None:
    tmp_path.joinpath("place", *["d"] * 65).mkdir(parents=True)
    with pytest.raises(InputFileError, match="more than 64 folders"):
        require_no_links(tmp_path, ["place"])
