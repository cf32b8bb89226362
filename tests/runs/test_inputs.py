"""Files that were edited or damaged between the stages are refused by name, and nothing is written."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from tests.run_folders import Finished, copied
from vcage.base.errors import InputFileError, SchemaMismatch
from vcage.base.files import RunFolder, read_json, write_json
from vcage.base.pictures import read_picture, write_picture
from vcage.runs.inputs import read_matches, read_pictures, read_plan, state_layout
from vcage.schema.scene import Scene
from vcage.stages import inpaint_plan


@pytest.fixture
def run(finished: Finished, tmp_path: Path) -> RunFolder:
    return copied(finished.run, tmp_path / "run", before="search_subtasks")


def edit(path: Path, change: Callable[[Any], None]) -> None:
    data = read_json(path)
    change(data)
    write_json(path, data)


def test_outputs_of_the_stages_are_accepted(finished):
    scene = Scene.read(finished.run.scene)
    assert len(read_matches(finished.run, scene).matches) == len(scene.objects)
    assert read_plan(finished.run, scene, finished.context).relations
    assert read_pictures(finished.run, scene).source.shape[2] == 3


def test_a_plan_edited_into_a_contradiction_is_refused(run, finished):
    def swap(plan: Any) -> None:
        first = plan["relations"][-1]
        plan["relations"].append({**first, "subject": first["reference"], "reference": first["subject"]})

    edit(run.plan, swap)
    with pytest.raises(InputFileError, match=r"plan\.json is not possible"):
        read_plan(run, Scene.read(run.scene), finished.context)


def test_matches_that_lack_an_object_are_refused_with_its_name(run):
    missing = read_json(run.matches)["matches"][0]["object"]
    edit(run.matches, lambda found: found["matches"].pop(0))
    with pytest.raises(InputFileError, match=missing):
        read_matches(run, Scene.read(run.scene))


def test_an_object_matched_twice_is_refused(run):
    edit(run.matches, lambda found: found["matches"].append(found["matches"][0]))
    with pytest.raises(InputFileError, match="one match for each"):
        read_matches(run, Scene.read(run.scene))


@pytest.mark.parametrize("place", [[50.0, -70.0], [900.0, 0.0]])
def test_places_far_from_the_table_are_refused(run, place):
    edit(run.matches, lambda found: found["matches"][0].update(position=place))
    with pytest.raises(InputFileError, match="far from the table"):
        read_matches(run, Scene.read(run.scene))


def test_a_picture_of_another_size_than_the_camera_s_is_refused(run):
    scene = Scene.read(run.scene)
    path = run.root / scene.pictures["background"]
    write_picture(path, read_picture(path)[::2, ::2])
    with pytest.raises(InputFileError, match=r"background\.png"):
        read_pictures(run, scene)


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (lambda o, _scene: o["pose"].update(quaternion=[0, 0, 0, 0]), "unit quaternion"),
        (lambda o, _scene: o.update(aabb=o["aabb"][::-1]), "lower and an upper corner"),
        (lambda o, _scene: o.update(aabb=[[-5, -5, 0.74], [5, 5, 1]]), "the table"),
        (lambda _o, scene: scene["table"].update(size=[0, 0]), "table with an area"),
        (lambda _o, scene: scene["top_camera"].update(height=10**9), r"top_camera\.height: .*8192"),
        (lambda _o, scene: scene["workspace"].update(lower=[-900.0, -1]), "workspace within 10 m"),
        (lambda _o, scene: [o.update(container=c["id"]) for o, c in _ring(scene)], "circle"),
    ],
)
def test_a_scene_that_cannot_be_is_refused_with_its_field(run, change, complaint):
    edit(run.scene, lambda scene: change(scene["objects"][0], scene))
    with pytest.raises(SchemaMismatch, match=complaint):
        Scene.read(run.scene)


def _ring(scene: Any) -> list[tuple[Any, Any]]:
    objects = scene["objects"]
    return list(zip(objects, objects[1:] + objects[:1], strict=True))


def test_a_target_picture_is_refused_by_its_header(run, finished, tmp_path):
    path = tmp_path / "target.png"
    path.write_bytes(cv2.imencode(".png", np.zeros((1, 20_000), np.uint8))[1].tobytes())
    with pytest.raises(InputFileError, match=r"target\.png is too large: 20000 x 1 pixels"):
        inpaint_plan.job(run, inpaint_plan.Options(target=path), finished.context)


def test_the_state_of_a_closed_cabinet_has_a_number_for_each_drawer(run, finished):
    def change(layout: Any) -> None:
        layout["objects"][0].update(asset="cabinet_three_drawers", variant="steel", joints=[])

    edit(run.scene, change)
    run.layout.parent.mkdir(parents=True, exist_ok=True)
    run.layout.write_bytes(run.scene.read_bytes())
    names = state_layout(run, finished.context).names
    cabinet = read_json(run.layout)["objects"][0]["id"]
    assert [name for name in names if ".part" in name] == [f"{cabinet}.part{number}" for number in (1, 2, 3)]
