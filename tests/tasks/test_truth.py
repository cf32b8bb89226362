"""What the simulator's state says of a goal."""

from __future__ import annotations

import numpy as np
import pytest

from tests.example_scenes import TABLE_TOP, thing, world_of
from vcage.base.geometry import Pose
from vcage.schema.episodes import Truth
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Grasp, Statement, Subtask
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.state import StillState
from vcage.tasks.truth import Watch, goals_hold, others_stay, subtask_done, watch_of

BOX = thing("packaging_box", (0.1, 0.05), 0.5)


def truth(subject: SceneObject, receptacle: SceneObject = BOX, relation: str = "inside") -> Truth:
    goal = Goal(subject=subject.id, relation=relation, reference=receptacle.id)
    return goals_hold([goal], StillState({o.id: o for o in (subject, receptacle)}))


def marker_at(x: float, y: float, z: float, yaw: float = 0.0) -> SceneObject:
    """A marker at a place in the box's frame."""
    marker = thing("marker")
    return marker.moved(BOX.pose * Pose.from_yaw([x, y, z], yaw))


def test_the_absence_of_a_lasting_goal_is_reported():
    assert goals_hold([], StillState({})).reason == "nothing was asked for that lasts"


def test_contents_on_the_floor_of_the_box_are_inside():
    assert truth(marker_at(0.03, -0.02, 0.004)).success


def test_an_object_beside_the_box_is_not_inside():
    found = truth(marker_at(0.25, 0.0, 0.0))
    assert not found.success
    assert found.reason == "marker is 14.0 cm outside packaging_box"


def test_an_object_above_the_box_is_not_inside():
    assert not truth(marker_at(0.0, 0.0, 0.1)).success


def test_an_object_across_the_rim_is_not_inside():
    rim = BOX.asset.opening(BOX.asset.annotation.functional_point(0)).rim
    assert not truth(marker_at(0.0, 0.08, rim, np.pi / 2)).success


def test_an_object_on_another_content_is_inside():
    assert truth(marker_at(0.0, 0.0, 0.004 + 0.02)).success


def test_a_box_that_has_tipped_holds_nothing():
    tipped = BOX.moved(BOX.pose * Pose(q=[np.cos(0.15), np.sin(0.15), 0, 0]))
    marker = thing("marker").moved(tipped.pose * Pose([0, 0, 0.004]))
    assert truth(marker, tipped).reason == "packaging_box is tipped"


def test_the_truth_follows_a_pushed_receptacle():
    pushed = BOX.moved(Pose([-0.2, 0.1, TABLE_TOP]))
    assert not truth(marker_at(0.0, 0.0, 0.004), pushed).success


def test_a_block_on_a_plate_is_on_it():
    plate = thing("plate", (0.1, 0.0))
    assert truth(thing("block", (0.12, 0.01), height=TABLE_TOP + 0.0066), plate, "on").success


def test_a_block_on_the_rim_of_a_plate_is_not_on_its_middle():
    plate = thing("plate", (0.1, 0.0))
    assert not truth(thing("block", (0.2, 0.0), height=TABLE_TOP + 0.02), plate, "on").success


def test_all_goals_must_hold():
    inside, outside = marker_at(0.0, 0.0, 0.004), thing("block", (-0.3, 0.0))
    goals = [Goal(subject=s, relation="inside", reference=BOX.id) for s in ("marker", "block")]
    found = goals_hold(goals, StillState({o.id: o for o in (inside, outside, BOX)}))
    assert not found.success
    assert found.reason.startswith("block is")


def test_beside_is_judged_by_the_boxes_of_both_objects():
    left = thing("block", (-0.2, 0.05))
    assert truth(left, relation="left_of").success
    assert truth(left, relation="right_of").reason == "block is not right_of packaging_box"


# --- moving parts --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def cabinet() -> SceneObject:
    return thing("cabinet_one_drawer")


def part(word: str, reference: str | None = None) -> Goal:
    return Goal(subject="cabinet_one_drawer", relation=word, part="drawer", reference=reference)


@pytest.mark.parametrize(
    ("share", "is_open", "is_closed"), [(1.0, True, False), (0.5, False, False), (0.05, False, True)]
)
def test_whether_a_part_is_open_or_closed_its_joint_says(cabinet, share: float, is_open: bool, is_closed: bool):
    now = cabinet.moved(cabinet.pose, (share * cabinet.asset.model.links[0].joint.far_end,))
    told = [goals_hold([part(word)], StillState({cabinet.id: now})) for word in ("open", "closed")]
    assert [t.success for t in told] == [is_open, is_closed]
    assert all(t.success or f"open by {100 * share:.0f} %" in t.reason for t in told)


def test_a_thing_in_a_drawer_is_where_the_drawer_is(cabinet):
    opened = cabinet.moved(cabinet.pose, (cabinet.asset.model.links[0].joint.far_end,))
    opening = cabinet.asset.opening(cabinet.asset.annotation.functional_point(0))
    block = thing("block")
    inside = block.moved(opened.frame(0) * Pose([*opening.centre, opening.floor]))
    goal = Goal(subject="block", relation="inside", reference=cabinet.id, part="drawer")
    assert goals_hold([goal], StillState({"block": inside, cabinet.id: opened})).success
    assert not goals_hold([goal], StillState({"block": inside, cabinet.id: cabinet})).success


def test_a_button_pressed_and_released_was_pressed():
    bell = thing("service_bell")
    world = world_of([bell])
    goal = Goal(subject=bell.id, relation="pressed", part="button")
    watch = Watch(world, {bell.id: bell}, [goal])
    assert "by 0 % only" in goals_hold([goal], watch).reason
    world.set_object_joints(bell.id, [bell.asset.model.links[0].joint.far_end])
    world.step(50)
    assert world.object_joints(bell.id)[0] < 0.001
    assert goals_hold([goal], watch).success


def marker_subtask() -> Subtask:
    inside = Goal(subject="marker", relation="inside", reference="packaging_box")
    return Subtask(
        id="marker-into-packaging_box", template="place", text="Put the marker into the box.", object="marker",
        receptacle="packaging_box", functional_point=0, grasps=[Grasp(contact=0, arm="left", score=1.0)],
        goals=[inside], script="subtasks/x.py", checks=[],
    )  # fmt: skip


@pytest.mark.parametrize(("shift", "stays"), [(0.0, True), (0.03, True), (0.08, False)])
def test_an_object_outside_a_subtask_stays_in_place(shift: float, stays: bool) -> None:
    objects = [thing("marker"), BOX, thing("block", (-0.2, 0.1))]
    world = world_of(objects)
    watch = Watch(world, {o.id: o for o in objects})
    was = world.object_pose("block")
    world.set_object_pose("block", Pose(was.p + [shift, 0, 0], was.q))
    found = others_stay(marker_subtask(), watch)
    assert found.success is stays
    assert stays or found.reason == "block was moved by 8 cm on the way"


@pytest.mark.parametrize(
    ("name", "shift", "stays"), [("block", 0.01, True), ("block", 0.03, False), ("hammer", 0.2, True)]
)
def test_what_is_hit_is_where_it_was_when_the_subtask_ends(name: str, shift: float, stays: bool) -> None:
    objects = [thing("block"), thing("hammer", (-0.2, 0.1))]
    world = world_of(objects)
    watch = Watch(world, {o.id: o for o in objects})
    was = world.object_pose(name)
    world.set_object_pose(name, Pose(was.p + [shift, 0, 0], was.q))
    hit = Subtask(
        id="block-hit-with-hammer", template="hit", text="Hit the block.", object="block", tool="hammer",
        grasped="hammer", grasps=[Grasp(contact=0, arm="left", score=1.0)],
        goals=[Goal(subject="block", relation="hit")], script="subtasks/x.py", checks=[],
    )  # fmt: skip
    assert others_stay(hit, watch).success is stays


def test_contents_of_the_moved_object_go_along() -> None:
    plate, block = thing("plate"), thing("block")
    world = world_of([plate, block.moved(Pose(plate.pose.p + [0, 0, 0.02]))])
    watch = Watch(world, {o.id: o for o in (plate, block)})
    for name in ("plate", "block"):
        was = world.object_pose(name)
        world.set_object_pose(name, Pose(was.p + [0.2, 0, 0], was.q))
    moved = marker_subtask().model_copy(update={"object": "plate", "receptacle": "table"})
    assert others_stay(moved, watch).success


def test_contents_that_rolled_over_in_the_moved_object_go_along() -> None:
    carrier, egg = thing("toolbox_tray"), thing("egg")
    turned = egg.moved(Pose(egg.pose.p, [np.cos(0.45), np.sin(0.45), 0.0, 0.0]))
    lying = turned.moved(Pose(turned.pose.p + [0, 0.04, TABLE_TOP + 0.003 - turned.lowest], turned.pose.q))
    assert lying.aabb[0, 2] < carrier.aabb[0, 2] < lying.lowest  # the box around it reaches below the floor
    world = world_of([carrier, lying])
    watch = Watch(world, {o.id: o for o in (carrier, lying)})
    for name in (carrier.id, lying.id):
        was = world.object_pose(name)
        world.set_object_pose(name, Pose(was.p + [0.2, 0, 0], was.q))
    moved = marker_subtask().model_copy(update={"object": carrier.id, "receptacle": "table"})
    assert others_stay(moved, watch).success


CABINET = thing("cabinet_two_drawers", (0.0, 0.15))
PARTS = [link.name for link in CABINET.asset.model.links]
OPENS = Subtask(
    id="open-cabinet", template="open", text="Open the drawer.", object=CABINET.id,
    grasps=[Grasp(contact=0, arm="left", score=1.0)], script="subtasks/x.py", checks=[],
    goals=[Goal(subject=CABINET.id, relation="open", part=PARTS[0])],
    statements=[
        Statement(subject=CABINET.id, word="unmoved"), Statement(subject=CABINET.id, word="closed", part=PARTS[1]),
    ],
)  # fmt: skip


@pytest.mark.parametrize(
    ("shift", "other", "told"),
    [
        (0.0, 0.0, None),
        (0.08, 0.0, "not cabinet_two_drawers unmoved any more: cabinet_two_drawers was moved by 8 cm"),
        (0.0, 1.0, f"not cabinet_two_drawers/{PARTS[1]} closed any more: the "),
    ],
)
def test_unchanged_facts_of_a_sub_task_are_judged_with_its_goals(shift: float, other: float, told: str | None) -> None:
    world = world_of([CABINET])
    watch = watch_of(OPENS, world, {CABINET.id: CABINET})
    far = [link.joint.far_end for link in CABINET.asset.model.links]
    was = world.object_pose(CABINET.id)
    world.set_object_pose(CABINET.id, Pose(was.p + [shift, 0, 0], was.q))
    world.set_object_joints(CABINET.id, [far[0], other * far[1]])
    found = subtask_done(OPENS, OPENS.goals, watch)
    assert found.success is (told is None)
    assert told is None or found.reason.startswith(told)
    assert subtask_done(OPENS.model_copy(update={"statements": []}), OPENS.goals, watch).success


def test_contents_are_to_stay_inside() -> None:
    inside = marker_at(0, 0, 0.006)
    world = world_of([BOX, inside])
    stays = Statement(subject="marker", word="inside", reference=BOX.id)
    step = marker_subtask().model_copy(update={"goals": [], "statements": [stays]})
    watch = watch_of(step, world, {o.id: o for o in (BOX, inside)})
    assert subtask_done(step, [], watch).success
    world.set_object_pose("marker", marker_at(0.4, 0, 0.006).pose)
    found = subtask_done(step, [], watch)
    assert not found.success and found.reason.startswith("not marker inside packaging_box any more: marker is ")


def test_the_height_of_a_leaning_object_is_its_lowest_points() -> None:
    marker = thing("marker")
    leaning = marker.moved(
        Pose(marker.pose.p, Pose.from_yaw([0, 0, 0], 0.4).q) * Pose(q=[np.cos(0.3), np.sin(0.3), 0, 0])
    )
    assert leaning.aabb[0, 2] <= leaning.lowest <= leaning.aabb[1, 2]
    assert marker.lowest == pytest.approx(marker.aabb[0, 2], abs=1e-3)


@pytest.mark.parametrize(
    ("x", "y", "there"), [(0.0, 0.0, True), (0.06, -0.06, True), (0.09, 0.09, False), (0.2, 0, False)]
)
def test_a_thing_at_the_centre_of_the_table_is_centred(x: float, y: float, there: bool) -> None:
    block = thing("block").moved(Pose.from_yaw([x, y, TABLE_TOP], 0.0))
    found = goals_hold([Goal(subject=block.id, relation="centred")], StillState({block.id: block}))
    assert found.success is there and ("cm from the centre" in found.reason) is not there
