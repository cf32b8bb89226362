"""Where in a receptacle the contents go."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.example_scenes import subtask, thing, workplace
from vcage.base.attempts import LIMITS
from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose, boxes_overlap, world_aabb
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Subtask
from vcage.tasks.chain_slots import slots_for_chain
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import CONTENT_GAP_M, Slot, allocate, arrangements, heading_for, other_slots, slot_in

CONTENTS = ["marker", "marker", "marker", "whiteboard_eraser", "block", "rubber_eraser"]
rng = np.random.default_rng
seeds = st.integers(0, 2**32 - 1)


def contents(count: int) -> list[SceneObject]:
    return [thing(asset, id=f"{asset}-{i}") for i, asset in enumerate(CONTENTS[:count])]


def by_object(chain: list[Subtask], slots: dict[str, Slot]) -> dict[str, Slot]:
    return {s.object: slots[s.id] for s in chain}


def boxes(slots: dict[str, Pose], objects: list[SceneObject]) -> list[np.ndarray]:
    """Boxes (2, 3) in the receptacle's frame."""
    return [world_aabb(o.asset.bounds, slots[o.id]) for o in objects]


def narrowest(found: list[np.ndarray]) -> float:
    """The smallest gap between two boxes, metres."""
    return min((float(np.maximum(a[0] - b[1], b[0] - a[1])[:2].max()) for a, b in combinations(found, 2)), default=1.0)


@settings(deadline=None, max_examples=40)
@given(seeds, st.integers(1, len(CONTENTS)), st.floats(-np.pi, np.pi))
def test_slots_never_overlap(seed: int, count: int, yaw: float):
    objects = contents(count)
    slots = allocate(thing("packaging_box", yaw=yaw), 0, objects, rng(seed))
    for a, b in combinations(boxes(slots, objects), 2):
        assert not boxes_overlap(a, b, CONTENT_GAP_M - 1e-9)


@settings(deadline=None, max_examples=40)
@given(seeds, st.integers(1, len(CONTENTS)))
def test_slots_keep_a_gap_to_the_walls(seed: int, count: int):
    objects, box = contents(count), thing("packaging_box")
    opening = box.asset.opening(box.asset.annotation.functional_point(0))
    centre, half = np.array(opening.centre), np.array(opening.size) / 2 - CONTENT_GAP_M
    for lower, upper in boxes(allocate(box, 0, objects, rng(seed)), objects):
        assert np.all(lower[:2] >= centre - half - 1e-9)
        assert np.all(upper[:2] <= centre + half + 1e-9)
        assert lower[2] == pytest.approx(opening.floor)


@settings(deadline=None, max_examples=20)
@given(seeds, st.floats(-np.pi, np.pi))
def test_a_slot_leaves_room_for_the_present_contents(seed: int, yaw: float):
    box, eraser = thing("packaging_box", (0.1, 0.05), yaw), thing("whiteboard_eraser")
    there = eraser.moved(box.pose * Pose([0.03, 0.02, 0.004]))
    marker = thing("marker")
    (box_of_slot,) = boxes(allocate(box, 0, [marker], rng(seed), [there]), [marker])
    taken = world_aabb(eraser.asset.bounds, Pose([0.03, 0.02, 0.004]))
    assert not boxes_overlap(box_of_slot[:, :2], taken[:, :2], CONTENT_GAP_M - 1e-9)


def test_the_same_seed_gives_the_same_slots():
    box, objects = thing("packaging_box"), contents(4)
    first, second = (allocate(box, 0, objects, rng(7)) for _ in range(2))
    assert all(np.array_equal(first[key].matrix(), second[key].matrix()) for key in first)


def test_objects_that_do_not_fit_together_are_refused_by_name():
    pens = [thing("marker", id=f"marker-{i}") for i in range(30)]
    with pytest.raises(InfeasibleScene) as caught:
        allocate(thing("packaging_box"), 0, pens, rng(0))
    assert set(caught.value.details["objects"]) <= {o.id for o in pens}
    assert "the opening of packaging_box" in caught.value.message


@pytest.mark.parametrize("seed", range(5))
def test_the_slots_of_a_chain_do_not_overlap(seed: int):
    objects = [thing("marker", (-0.2, 0.0)), thing("whiteboard_eraser", (0.22, 0.0)), thing("packaging_box", (0, 0.05))]
    chain = [subtask(o.id, "packaging_box", "inside") for o in objects[:2]]
    slots = slots_for_chain(chain, workplace(objects, rng(seed)))
    a, b = (world_aabb(o.asset.bounds, slots[s.id].pose) for o, s in zip(objects, chain, strict=False))
    assert not boxes_overlap(a, b)


def slots_on_a_tray(
    seed: int, drawn: bool = False, at: tuple[float, float] = (0.0, 0.1), yaw: float = 0.0
) -> list[Pose]:
    objects = [thing("marker", (-0.25, -0.05)), thing("block", (0.25, -0.05)), thing("tray", at, yaw)]
    chain = [subtask(o.id, "tray", "on") for o in objects[:2]]
    slots = slots_for_chain(chain, workplace(objects, rng(seed)), drawn)
    return [slots[s.id].pose for s in chain]


def test_places_on_a_receptacle_follow_from_sizes_wherever_it_stands():
    assert slots_on_a_tray(1) == slots_on_a_tray(2, at=(0.03, 0.12), yaw=0.2)


def test_drawn_places_on_a_receptacle_differ_by_seed():
    assert slots_on_a_tray(1, drawn=True) != slots_on_a_tray(2, drawn=True)


@pytest.mark.parametrize("count", [1, 3, 6])
def test_the_first_arrangement_is_the_roomiest_and_always_the_same(count: int):
    box, objects = thing("packaging_box", yaw=0.3), contents(count)
    first, second = (arrangements(box, 0, objects) for _ in range(2))
    assert [poses.keys() for poses in first] == [poses.keys() for poses in second]
    assert all(a[key] == b[key] for a, b in zip(first, second, strict=True) for key in a)
    gaps = [narrowest(boxes(poses, objects)) for poses in first]
    assert min(gaps) >= CONTENT_GAP_M - 1e-9
    assert gaps[0] > gaps[-1] or count == 1


def test_things_close_together_on_a_receptacle_do_not_hide_which_place_is_roomy():
    tray, eraser = thing("tray"), thing("rubber_eraser")
    on_tray = tray.frame(0)
    there = [on_tray * Pose([0.05, y, 0.0]) for y in (-0.02, 0.02)]
    present = [thing("rubber_eraser", id=f"there-{k}").moved(pose) for k, pose in enumerate(there)]
    found = arrangements(tray, 0, [eraser], present)
    away = [float(np.linalg.norm(poses[eraser.id].p[:2] - [0.05, 0.0])) for poses in found]
    assert away[0] > away[-1]


def test_a_chain_whose_contents_do_not_fit_together_is_refused():
    box = thing("packaging_box", (0.0, 0.05))
    pens = [thing("marker", (-0.3 + 0.02 * i, 0.0), id=f"marker-{i}") for i in range(30)]
    with pytest.raises(InfeasibleScene):
        slots_for_chain([subtask(p.id, box.id, "inside") for p in pens], workplace([*pens, box], rng(0)))


def test_a_marker_is_not_put_where_the_fingers_would_open_over_a_wall():
    """Right beside the short wall of a box the fingers must let go from above its rim."""
    objects = [thing("marker", (-0.2, 0.0)), thing("packaging_box", (0, 0.05))]
    for seed in range(10):
        slots = slots_for_chain([subtask("marker", "packaging_box", "inside")], workplace(objects, rng(seed)))
        (pose,) = (slot.pose for slot in slots.values())
        across, half = (abs(pose.p[0]), 0.11) if abs(pose.yaw) > 0.8 else (abs(pose.p[1]), 0.09)
        assert half - across > 0.04


def test_another_slot_keeps_away_from_the_slots_of_other_objects():
    objects = [thing("marker", (-0.2, 0.0)), thing("whiteboard_eraser", (0.22, 0.0)), thing("packaging_box", (0, 0.05))]
    chain = [subtask(o.id, "packaging_box", "inside") for o in objects[:2]]
    slots = by_object(chain, slots_for_chain(chain, workplace(objects, rng(0))))
    there = world_aabb(objects[1].asset.bounds, slots["whiteboard_eraser"].pose)
    others = other_slots(slots, "marker", {o.id: o for o in objects})
    assert len(others) == LIMITS.spare_slots
    for slot in others:
        assert not boxes_overlap(world_aabb(objects[0].asset.bounds, slot.pose), there)


def test_the_other_slots_keep_clear_of_an_object_delivered_off_plan():
    objects = [thing("marker", (-0.2, 0.0)), thing("block", (0.2, 0.0)), thing("packaging_box", (0, 0.05))]
    chain = [subtask(o.id, "packaging_box", "inside") for o in objects[:2]]
    slots = by_object(chain, slots_for_chain(chain, workplace(objects, rng(0))))
    blocks = other_slots(slots, "block", {o.id: o for o in objects})
    assert blocks
    for block in blocks:
        lies = objects[1].moved(objects[2].frame(0) * block.pose)
        markers = other_slots(slots, "marker", {o.id: o for o in (objects[0], lies, objects[2])})
        assert markers
        for slot in markers:
            assert not boxes_overlap(
                world_aabb(objects[0].asset.bounds, slot.pose), world_aabb(objects[1].asset.bounds, block.pose)
            )


def test_the_other_slots_are_always_the_same():
    objects = [thing("marker", (-0.2, 0.0)), thing("packaging_box", (0, 0.05))]
    chain = [subtask("marker", "packaging_box", "inside")]
    slots = by_object(chain, slots_for_chain(chain, workplace(objects, rng(0))))
    first, second = (other_slots(slots, "marker", {o.id: o for o in objects}) for _ in range(2))
    assert first == second


@settings(deadline=None, max_examples=10)
@given(seeds, st.floats(-np.pi, np.pi))
def test_what_is_to_face_the_robot_has_that_heading_wherever_the_receptacle_is_turned(seed: int, yaw: float):
    tray, box = thing("tray", yaw=yaw), thing("soap_bar", yaw=1.0)
    facing = [Goal(subject=box.id, relation="facing_robot")]
    heading = heading_for(facing, tray, 0)
    assert heading is not None
    (pose,) = allocate(tray, 0, [box], rng(seed), headings={box.id: heading}).values()
    (there,) = slot_in(tray, 0, pose, facing, box).poses({tray.id: tray})
    assert np.isclose(np.cos(there.yaw), 1.0)
    assert heading_for([Goal(subject=box.id, relation="on", reference=tray.id)], tray, 0) is None
