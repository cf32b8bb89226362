from __future__ import annotations

import numpy as np
import pytest

from tests.models.tabletop import (
    BLOCKS,
    BOX,
    BREADS,
    CAMERA,
    ERASER,
    HEIGHT,
    MARKERS,
    PLATE,
    draw,
    scene_of,
    table_picture,
)
from vcage.errors import InputFileError
from vcage.geometry import boxes_overlap
from vcage.models.offline.arrange import arrange
from vcage.models.offline.detector import BackgroundDetector
from vcage.models.offline.editor import OfflineEditor
from vcage.models.offline.embedder import ClassicalEmbedder
from vcage.models.offline.footprints import footprints
from vcage.models.offline.layout import plan_layout
from vcage.models.protocols import Detection, EditRequest

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
    return EditRequest(picture, table_picture(), ids, scene, plan_layout(scene, np.random.default_rng(seed)))


def regions(ids: np.ndarray, count: int) -> list[Detection]:
    return [Detection((0, 0, 1, 1), ids == index + 1, 1.0) for index in range(count)]


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("seed", range(3))
def test_arranged_objects_keep_their_relations_and_do_not_overlap(name: str, seed: int) -> None:
    request = request_for(name, seed)
    items = footprints(request.scene, request.segmentation)
    placed = arrange(request.scene, request.plan, items)
    half = {i.record.id: i.half_size(placed[i.record.id].turn) for i in items}
    boxes = {k: np.stack([p.centre - half[k], p.centre + half[k]]) for k, p in placed.items()}
    keys = list(boxes)
    assert not any(boxes_overlap(boxes[a], boxes[b]) for i, a in enumerate(keys) for b in keys[:i])
    sides = {"left_of": (0, -1), "right_of": (0, 1), "in_front_of": (1, -1), "behind": (1, 1)}
    for r in request.plan.relations:
        if r.relation in sides:
            axis, sign = sides[r.relation]
            assert sign * (placed[r.subject].centre - placed[r.reference].centre)[axis] > 0, r


@pytest.mark.parametrize("name", SCENES)
def test_every_object_is_found_in_the_target_where_the_plan_put_it(name: str) -> None:
    request = request_for(name)
    target = OfflineEditor().rearrange(request)
    items = footprints(request.scene, request.segmentation)
    placed = arrange(request.scene, request.plan, items)
    found = BackgroundDetector().detect(target, [i.record.id for i in items], request.background)
    assert len(found) == len(items)
    source = ClassicalEmbedder().embed(request.picture, regions(request.segmentation, len(items)))
    likeness = source @ ClassicalEmbedder().embed(target, found).T
    for item, row in zip(items, likeness, strict=True):
        u0, v0, u1, v1 = found[int(row.argmax())].box
        world = CAMERA.unproject(np.array([(u0 + u1) / 2, (v0 + v1) / 2]), item.height)
        assert np.linalg.norm(world[:2] - placed[item.record.id].centre) < 0.012, item.record.id
        assert row.max() > 0.9


def test_an_object_of_the_target_covers_as_much_as_in_the_source() -> None:
    request = request_for("blocks")
    found = BackgroundDetector().detect(OfflineEditor().rearrange(request), ["a"] * 4, request.background)
    before = sorted((request.segmentation == index).sum() for index in range(1, 5))
    after = sorted(d.mask.sum() for d in found)
    assert np.allclose(after, before, rtol=0.25)


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


def test_footprints_measure_the_turned_rectangle() -> None:
    marker = MARKERS[0]
    _, ids = draw([marker])
    item = footprints(scene_of([marker]), ids)[0]
    assert item.size[0] == pytest.approx(0.14, abs=0.006) and item.size[1] == pytest.approx(0.018, abs=0.008)
    assert item.axis == pytest.approx(marker.yaw, abs=0.05)
    assert item.height == pytest.approx(HEIGHT + 0.009)
