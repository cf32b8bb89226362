from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from tests.models.tabletop import (
    BLOCKS,
    BOX,
    BREADS,
    CAMERA,
    ERASER,
    HEIGHT,
    LIGHT,
    MARKERS,
    PLATE,
    Thing,
    draw,
    scene_of,
    table_picture,
)
from vcage.base.errors import InfeasibleScene, InputFileError
from vcage.base.geometry import Pose
from vcage.layout import intended
from vcage.models.protocols import EditRequest
from vcage.models.rules.cutouts import cutouts
from vcage.models.rules.editor import OfflineEditor
from vcage.models.rules.layout import plan_layout
from vcage.models.rules.light import Light, find_light
from vcage.models.rules.painting import View
from vcage.models.rules.painting import paint_objects as paint_at
from vcage.vision.detector import BackgroundDetector
from vcage.vision.embedder import ClassicalEmbedder
from vcage.vision.protocols import Detection

BREAD_BOX = BOX.moved(id="bread-box", colour=(150, 100, 60))
SCENES = {
    "stationery": [BOX, *MARKERS, ERASER],
    "blocks": [PLATE, *BLOCKS],
    "bread": [BREAD_BOX, *BREADS],
}


def request_for(name: str, seed: int = 0) -> EditRequest:
    things = SCENES[name]
    picture, ids = draw(things)
    scene = scene_of(things)
    return EditRequest(picture, table_picture(), ids, scene, plan_layout(scene, (), np.random.default_rng(seed)))


def regions(ids: np.ndarray, count: int) -> list[Detection]:
    return [Detection((0, 0, 1, 1), ids == index + 1, 1.0) for index in range(count)]


@pytest.mark.parametrize("name", SCENES)
def test_every_object_is_found_in_the_target_where_the_plan_put_it(name: str) -> None:
    request = request_for(name)
    target = OfflineEditor().rearrange(request)
    items = cutouts(request.scene, request.segmentation)
    found = BackgroundDetector().detect(target, [i.record.id for i in items], request.background)
    assert len(found) == len(items)
    source = ClassicalEmbedder().embed(request.picture, regions(request.segmentation, len(items)))
    likeness = source @ ClassicalEmbedder().embed(target, found).T
    for item, row in zip(items, likeness, strict=True):
        u0, v0, u1, v1 = found[int(row.argmax())].box
        world = CAMERA.unproject(np.array([(u0 + u1) / 2, (v0 + v1) / 2]), item.height)
        assert np.linalg.norm(world[:2] - request.layout.boxes[item.record.id][:, :2].mean(axis=0)) < 0.012, (
            item.record.id
        )
        assert row.max() > 0.9


def at_pose(thing: Thing, at: tuple[float, float], turn: float = 0.0) -> Pose:
    return Pose.from_yaw((*at, HEIGHT), thing.yaw + turn)


def moved(thing: Thing, at: tuple[float, float], turn: float = 0.0, light: bool = True) -> tuple[np.ndarray, ...]:
    """(drawn, true picture, true pixels, background) of one thing moved alone."""
    picture, ids = draw([thing])
    items = cutouts(scene_of([thing]), ids)
    shadows = find_light(picture, table_picture(), items, CAMERA, HEIGHT) if light else None
    poses = {thing.id: at_pose(thing, at, turn)}
    drawing = paint_at(picture, table_picture(), items, poses, View(CAMERA, shadows, HEIGHT))
    truth, pixels = draw([thing.moved(at=at, yaw=thing.yaw + turn)])
    return drawing.picture, truth, pixels > 0, table_picture()


TALL = Thing("can", (70, 110, 180), (0.07, 0.07, 0.14), (-0.35, 0.15), round=True)


@pytest.mark.parametrize("thing", [TALL, BOX, BLOCKS[0], ERASER], ids=lambda thing: thing.id)
@pytest.mark.parametrize(("at", "turn"), [((0.3, -0.1), 0.0), ((0.0, 0.0), 0.8), ((-0.3, 0.1), -1.2)])
def test_a_moved_object_occludes_at_its_new_place(thing: Thing, at: tuple[float, float], turn: float) -> None:
    drawn, _, truth, background = moved(thing, at, turn, light=False)
    covered = np.abs(drawn.astype(int) - background).max(axis=-1) > 12
    assert (covered & truth).sum() / (covered | truth).sum() > 0.8


def test_shadows_fall_where_the_light_of_the_source_throws_them() -> None:
    drawn, truth, pixels, background = moved(TALL, (0.25, 0.1))
    around = cv2.dilate(pixels.astype(np.uint8), np.ones((61, 61))).astype(bool) & ~pixels
    plain = np.abs(background.astype(int) - truth)[around].mean()
    assert np.abs(drawn.astype(int) - truth)[around].mean() < 0.7 * plain


def test_the_light_is_measured_on_the_shadows() -> None:
    picture, ids = draw([TALL])
    items = cutouts(scene_of([TALL]), ids)
    light = find_light(picture, table_picture(), items, CAMERA, HEIGHT)
    assert light.offset == pytest.approx(LIGHT, abs=0.1)
    assert light.left == pytest.approx([0.7] * 3, abs=0.08)
    assert find_light(table_picture(), table_picture(), items, CAMERA, HEIGHT) is None


def test_a_side_towards_the_light_is_brighter_than_one_away_from_it() -> None:
    light = Light(np.array([0.5, 0.0]), np.full(3, 0.7))
    towards, across, away = light.on_side(np.array([[-1.0, 0], [0, 1.0], [1.0, 0]]))
    assert towards > across == pytest.approx(away) == pytest.approx(0.7)


def test_an_unmoved_object_looks_as_before() -> None:
    drawn, truth, pixels, _ = moved(TALL, TALL.at)
    assert np.abs(drawn.astype(int) - truth)[pixels].mean() < 4


def test_an_object_missing_in_the_source_is_reported_and_left_out(caplog: pytest.LogCaptureFixture) -> None:
    request = request_for("blocks")
    ids = np.where(request.segmentation == 2, 0, request.segmentation)
    request = replace(request, segmentation=ids)
    target = OfflineEditor().rearrange(request)
    assert "red-block: the picture shows nothing of it" in caplog.text
    assert request.hidden == ["red-block"]
    assert request.layout.poses["red-block"].p[:2] == pytest.approx(BLOCKS[0].at)
    assert target.shape == request.picture.shape


def test_an_object_behind_a_tall_one_is_reported() -> None:
    low = BLOCKS[0].moved(at=(0.2, 0.0))
    picture, ids = draw([TALL, low])
    items = cutouts(scene_of([TALL, low]), ids)
    poses = {"can": at_pose(TALL, (0.33, 0.0)), low.id: at_pose(low, (0.39, 0.0))}
    drawing = paint_at(picture, table_picture(), items, poses, View(CAMERA, None, HEIGHT))
    assert drawing.hidden(0.9) == [low.id] and drawing.visible["can"] == 1


def test_an_object_off_the_picture_is_reported() -> None:
    picture, ids = draw([TALL])
    items = cutouts(scene_of([TALL]), ids)
    poses = {"can": at_pose(TALL, (0.9, 0.0))}
    assert paint_at(picture, table_picture(), items, poses, View(CAMERA, None, HEIGHT)).visible == {"can": 0.0}


def test_the_editor_refuses_a_picture_that_would_lose_an_object(monkeypatch: pytest.MonkeyPatch) -> None:
    spread = request_for("blocks").layout
    together = replace(spread, poses={name: Pose.from_yaw((0.8, 0.0, HEIGHT), 0.0) for name in spread.poses})
    monkeypatch.setattr(intended, "intended_layout", lambda *_, **__: together)
    with pytest.raises(InfeasibleScene, match="outside the picture"):
        OfflineEditor().rearrange(request_for("blocks"))


def test_relations_dropped_from_the_picture_are_reported(monkeypatch: pytest.MonkeyPatch, caplog) -> None:
    request = request_for("blocks")
    spread = request_for("blocks").layout
    hidden = replace(spread, poses={**spread.poses, "red-block": Pose.from_yaw((0.8, 0.0, HEIGHT), 0.0)})
    answers = iter((hidden, spread))
    monkeypatch.setattr(intended, "intended_layout", lambda *_, **__: next(answers))
    OfflineEditor().rearrange(request)
    given_up = [r for r in request.plan.relations if "red-block" in (r.subject, r.reference)]
    assert "so that red-block can be seen, the target picture does not keep to" in caplog.text
    assert all(f"{r.subject} {r.relation} {r.reference}" in caplog.text for r in given_up)


def test_the_same_request_gives_the_same_bytes() -> None:
    first, second = (OfflineEditor().rearrange(request_for("stationery")) for _ in range(2))
    assert first.tobytes() == second.tobytes()


def test_pictures_of_another_size_are_refused() -> None:
    request = request_for("blocks")
    with pytest.raises(InputFileError, match="background is 320 x 240"):
        OfflineEditor().rearrange(
            EditRequest(
                request.picture, request.background[::2, ::2], request.segmentation, request.scene, request.plan
            )
        )


def test_cutouts_measure_the_turned_rectangle() -> None:
    marker = MARKERS[0]
    _, ids = draw([marker])
    item = cutouts(scene_of([marker]), ids)[0]
    assert item.size[0] == pytest.approx(0.14, abs=0.006) and item.size[1] == pytest.approx(0.018, abs=0.008)
    assert item.height == pytest.approx(HEIGHT + 0.009)
