"""Cases on disk: written cases are read back, and damaged ones refused by name."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest

from benchmarks._match.cases import Case, case_folders, read_case, write_case
from benchmarks._match.truth import Stranger, TrueObject, Truth
from tests.example_scenes import scene_of, thing
from vcage.base.errors import InputFileError
from vcage.base.pictures import write_picture


@pytest.fixture
def case() -> Case:
    """A block and a plate in painted pictures; the target is smaller than the source."""
    objects = [thing("block", (-0.2, 0.0)), thing("plate", (0.1, 0.0))]
    scene = scene_of(objects).model_copy(update={"segmentation_ids": {"block": 1, "plate": 2}})
    rng = np.random.default_rng(0)
    background = rng.integers(0, 255, (480, 640, 3), dtype=np.uint8)
    segmentation = np.zeros((480, 640), np.int32)
    segmentation[200:220, 100:120], segmentation[200:260, 400:460] = 1, 2
    truth = Truth(
        level="moved",
        objects=[TrueObject(id="block", present=True, position=(0.1, 0.1), yaw=0.5, symmetry=4)]
        + [TrueObject(id="plate", present=False)],
        strangers=[Stranger(name="a lemon", position=(0.3, 0.1))],
    )
    target = rng.integers(0, 255, (96, 128, 3), dtype=np.uint8)
    reference = rng.integers(0, 255, (20, 20, 4), dtype=np.uint8)
    return Case(
        "moved/000", scene, background, segmentation, background, target, truth, references={"block": reference}
    )


def test_a_case_is_read_as_it_was_written(case: Case, tmp_path: Path):
    write_case(tmp_path, case)
    (folder,) = case_folders(tmp_path)
    read = read_case(folder, tmp_path)
    assert read.name == case.name
    assert read.scene == case.scene
    assert read.truth == case.truth
    for name in ("source", "segmentation", "background", "target"):
        np.testing.assert_array_equal(getattr(read, name), getattr(case, name))
    np.testing.assert_array_equal(read.references["block"], case.references["block"])


@pytest.mark.parametrize("channels", [1, 4])
def test_a_grey_or_transparent_target_is_read_in_colour(case: Case, tmp_path: Path, channels: int):
    folder = write_case(tmp_path, case)
    picture = np.full((60, 80, channels), 90, np.uint8).squeeze()
    cv2.imwrite(str(folder / "target.png"), picture)
    assert read_case(folder).target.shape == (60, 80, 3)


@pytest.mark.parametrize("name", ["target.png", "truth.json", "scene.json"])
def test_a_case_without_a_file_is_refused_by_name(case: Case, tmp_path: Path, name: str):
    folder = write_case(tmp_path, case)
    (folder / name).unlink()
    with pytest.raises(InputFileError, match=f"moved/000.*{name}") as refused:
        read_case(folder, tmp_path)
    assert "move its folder away" in refused.value.hint


@pytest.mark.parametrize("name", ["target.png", "segmentation.png", "truth.json", "scene.json"])
def test_a_damaged_file_is_refused_with_the_name_of_its_case(case: Case, tmp_path: Path, name: str):
    folder = write_case(tmp_path, case)
    (folder / name).write_bytes(b"not this")
    with pytest.raises(InputFileError, match=f"moved/000.*{name}"):
        read_case(folder)


def test_pictures_of_another_size_than_the_camera_are_refused(case: Case, tmp_path: Path):
    folder = write_case(tmp_path, case)
    write_picture(folder / "background.png", np.zeros((10, 10, 3), np.uint8))
    with pytest.raises(InputFileError, match=r"moved/000.*background.png has 10 x 10"):
        read_case(folder)


def test_a_truth_about_other_objects_is_refused(case: Case, tmp_path: Path):
    folder = write_case(tmp_path, case)
    truth = json.loads((folder / "truth.json").read_text())
    truth["objects"][0]["id"] = "cup"
    (folder / "truth.json").write_text(json.dumps(truth))
    with pytest.raises(InputFileError, match=r"moved/000.*block, cup"):
        read_case(folder)


def test_a_present_object_without_a_position_is_refused(case: Case, tmp_path: Path):
    folder = write_case(tmp_path, case)
    truth = json.loads((folder / "truth.json").read_text())
    truth["objects"][0]["position"] = None
    (folder / "truth.json").write_text(json.dumps(truth))
    with pytest.raises(InputFileError, match=r"moved/000.*no position"):
        read_case(folder)


def test_a_folder_without_cases_is_refused(tmp_path: Path):
    with pytest.raises(InputFileError, match="holds no case"):
        case_folders(tmp_path)


def test_folders_of_cases_may_lie_at_any_depth(case: Case, tmp_path: Path):
    folder = write_case(tmp_path, case)
    shutil.copytree(folder, tmp_path / "one" / "more" / "folder")
    assert [found.relative_to(tmp_path).as_posix() for found in case_folders(tmp_path)] == [
        "moved/000",
        "one/more/folder",
    ]
