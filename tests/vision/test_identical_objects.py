"""Objects that look the same are told apart by the plan, and by nothing else."""

from __future__ import annotations

import numpy as np

from tests.models.tabletop import Thing, scene_of
from vcage.schema.matches import Match
from vcage.schema.plan import Relation
from vcage.schema.scene import Scene
from vcage.vision.identical_objects import matched_box, settle_identical

PLATE = Thing("plate", (230, 230, 225), (0.2, 0.2, 0.02), (0.0, 0.0), round=True, role="receptacle")
FIRST = Thing("block", (200, 40, 40), (0.04, 0.04, 0.04), (0.3, 0.1))
SECOND = Thing("block_2", (200, 40, 40), (0.04, 0.04, 0.04), (-0.3, 0.1))
PLAN = [
    Relation(subject="block", relation="left_of", reference="plate"),
    Relation(subject="block_2", relation="right_of", reference="plate"),
]


def twins(same: bool = True) -> Scene:
    scene = scene_of([PLATE, FIRST, SECOND])
    looks = {"plate": "plate", "block": "block", "block_2": "block" if same else "cube"}
    objects = [o.model_copy(update={"asset": looks[o.id], "variant": "plain"}) for o in scene.objects]
    return scene.model_copy(update={"objects": objects})


def match(object_id: str, x: float, method: str = "feature", yaw: float = 0.0) -> Match:
    return Match(
        object=object_id,
        method=method,
        similarity=0.9,
        confidence=0.9,
        box=(0, 0, 10, 10),
        position=(x, 0.0),
        yaw=yaw,
        turned=yaw,
        ncc=0.9,
    )


def matched(scene: Scene, *matches: Match) -> dict[str, float]:
    return {m.object: m.position[0] for m in settle_identical(scene, PLAN, matches)}


def test_two_that_look_the_same_are_exchanged_where_the_plan_holds_then():
    found = matched(twins(), match("plate", 0.0), match("block", 0.3), match("block_2", -0.3))
    assert (found["block"], found["block_2"]) == (-0.3, 0.3)


def test_objects_that_fulfil_the_plan_stay():
    found = matched(twins(), match("plate", 0.0), match("block", -0.3), match("block_2", 0.3))
    assert (found["block"], found["block_2"]) == (-0.3, 0.3)


def test_objects_that_look_different_are_never_exchanged():
    found = matched(twins(same=False), match("plate", 0.0), match("block", 0.3), match("block_2", -0.3))
    assert (found["block"], found["block_2"]) == (0.3, -0.3)


def test_objects_that_were_not_found_are_left_alone():
    found = matched(twins(), match("plate", 0.0), match("block", 0.3, "kept"), match("block_2", -0.3))
    assert (found["block"], found["block_2"]) == (0.3, -0.3)


def test_the_heading_in_the_world_goes_along():
    settled = settle_identical(
        twins(), PLAN, [match("plate", 0.0), match("block", 0.3, yaw=1.0), match("block_2", -0.3, yaw=-0.5)]
    )
    assert {m.object: m.yaw for m in settled}["block"] == -0.5


def test_a_matched_box_is_the_object_s_box_around_the_matched_place():
    record = twins().object("block")
    box = matched_box(record, match("block", -0.2))
    np.testing.assert_allclose(np.ptp(box, axis=0), np.ptp(np.array(record.aabb), axis=0))
