"""A chain gone through before anything moves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from tests.articulated import TRAVEL, asset_of, drawer_cabinet, drawer_handle, standing
from tests.example_scenes import (
    TABLE_TOP,
    block_and_plate,
    robot,
    scene_of,
    sensible,
    template,
    thing,
    workplace,
)
from vcage.base.errors import NoFeasibleTask
from vcage.base.geometry import Pose
from vcage.schema.goals import AskedGoal, Goal
from vcage.schema.plan import TABLE
from vcage.schema.subtasks import Grasp, Subtask
from vcage.sim.bodies import Body
from vcage.sim.motion import MotionFailed, MotionPlanner
from vcage.sim.world import World
from vcage.tasks import rehearsal
from vcage.tasks.chain_rehearsal import examined, rehearsed
from vcage.tasks.proven_chain import require_chain
from vcage.tasks.rehearsal import Rehearsal
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import find_subtasks
from vcage.tasks.slots import Slot
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.workcell import TaskFailed

BLOCK, PLATE, BOWL = thing("block", (-0.1, -0.1)), thing("plate", (0.15, 0.0)), thing("bowl", (-0.3, 0.1))
OBJECTS: list[SceneObject] = [BLOCK, PLATE, BOWL]


def rng() -> np.random.Generator:
    return np.random.default_rng(0)


@pytest.fixture(scope="module")
def chain() -> list[Subtask]:
    """Block onto the plate, then into the bowl."""
    found = find_subtasks(workplace(OBJECTS), sensible)
    by_place = {s.receptacle: s for s in found.kept if s.object == BLOCK.id}
    return [by_place[PLATE.id], by_place[BOWL.id]]


def test_the_planned_grasp_of_a_step_is_tried_first(chain):
    contact, far_left = chain[0].grasps[0].contact, thing("block", (-0.9, -0.1))
    grasps = [Grasp(contact=contact, arm="right", score=9.0), Grasp(contact=contact, arm="left", score=1.0)]
    step = chain[0].model_copy(update={"grasps": grasps})
    (then,) = rehearsed([step], {}, [far_left, PLATE, BOWL], scene_of(OBJECTS), rng())
    assert [grasp.arm for grasp in then.grasps] == ["left", "right"]


def test_grasps_that_suit_the_slot_are_added_and_come_first(chain):
    (right,) = [grasp for grasp in chain[0].grasps if grasp.arm == "right"][:1]
    step = chain[0].model_copy(update={"grasps": [right.model_copy(update={"score": -99.0})]})
    slot = Slot(
        PLATE.id,
        step.functional_point,
        Pose([0.0, 0.0, PLATE.asset.opening(PLATE.asset.annotation.functional_point(0)).floor]),
    )
    (then,) = rehearsed([step], {step.id: slot}, OBJECTS, scene_of(OBJECTS), rng())
    assert {grasp.arm for grasp in then.grasps} == {"left", "right"}


def test_a_step_whose_motions_cannot_be_planned_is_refused_with_the_reason(chain):
    far_away = thing("block", (-3.0, -0.1))
    with pytest.raises(NoFeasibleTask, match=rf"{chain[0].id} cannot be planned: no grasp of .* block"):
        rehearsed(chain[:1], {}, [far_away, PLATE, BOWL], scene_of(OBJECTS), rng())


def test_drawer_contents_go_with_the_drawer_and_nothing_else_moves(tmp_path):
    cabinet = asset_of("cabinet", drawer_cabinet(tmp_path), [drawer_handle()])
    drawer = standing(cabinet, Pose.from_yaw([-0.15, 0.09, TABLE_TOP], -0.1))
    floor = cabinet.bounds_of("drawer_upper")[0]
    inside = thing("block", (0.0, 0.0), id="rides")
    inside = inside.moved(drawer.part_box("drawer_upper").pose * Pose([0.0, -0.02, float(floor[2])]))
    objects = {o.id: o for o in (drawer, inside, PLATE)}
    world = World(template().table, {o.id: Body(o.asset.model, o.pose) for o in objects.values()}, robot())
    task = Rehearsal(world, objects, {})
    task.operate(drawer.id, 0, TRAVEL)
    assert world.object_joints(drawer.id) == pytest.approx([0.0, TRAVEL])
    assert np.linalg.norm(world.object_pose("rides").p - inside.pose.p) == pytest.approx(TRAVEL)
    assert world.object_pose(PLATE.id).p == pytest.approx(PLATE.pose.p)
    assert world.steps == 0


def test_a_moved_object_is_examined_at_its_new_place(chain):
    slots = {chain[0].id: Slot(PLATE.id, 0, Pose([0.0, 0.0, 0.0066]))}
    there = PLATE.pose * Pose([0.0, 0.0, 0.0066])
    (_, then) = rehearsed(chain, slots, OBJECTS, scene_of(OBJECTS), rng())
    assert then.id == chain[1].id
    on_plate = thing("block", tuple(there.p[:2]), height=float(there.p[2]), container=PLATE.id)
    alone = examined(chain[1], workplace([on_plate, PLATE, BOWL]))
    assert alone is not None
    assert {(g.contact, g.arm) for g in then.grasps} == {(g.contact, g.arm) for g in alone.grasps}


def test_an_object_moved_out_of_reach_is_not_feasible_any_more(chain):
    slots = {chain[0].id: Slot(TABLE, None, Pose([0.0, 3.0, 0.74]), turns=(0.0,))}
    with pytest.raises(NoFeasibleTask, match="cannot be planned"):
        rehearsed(chain, slots, OBJECTS, scene_of(OBJECTS), rng())


def asked(objects: list[SceneObject]):
    goal = Goal(subject="block", relation="on", reference="plate")
    return scene_of(objects).model_copy(
        update={"goals": [AskedGoal(goal=goal, step=0, words="Put the block on the plate")]}
    )


def test_a_layout_that_allows_the_instruction_is_as_required():
    objects = block_and_plate()
    require_chain(asked(objects), objects, rng())


def test_a_layout_without_an_arm_in_reach_of_the_object_is_not_as_required():
    block, plate = block_and_plate()
    objects = [block, plate.moved(Pose([0.0, 3.0, 0.74]))]
    with pytest.raises(NoFeasibleTask, match="block"):
        require_chain(asked(objects), objects, rng())


def test_contents_go_along_with_their_container():
    mug, tray = thing("mug", (-0.2, 0.0)), thing("tray", (0.15, 0.05))
    floor = mug.asset.opening(mug.asset.annotation.functional_points[0]).floor
    block = thing("block", (-0.2, 0.0), height=TABLE_TOP + floor, container="mug")
    objects = {o.id: o for o in (mug, tray, block)}
    world = World(template().table, {o.id: Body(o.asset.model, o.pose) for o in objects.values()}, robot())
    task = Rehearsal(world, objects, {"mug": Slot("tray", 0, Pose([0.0, 0.0, 0.005]))})
    task.pick("mug", [(point.id, arm) for point in mug.asset.annotation.carrying_points for arm in ("left", "right")])
    task.place("tray")
    np.testing.assert_allclose(world.object_pose("block").p[:2], world.object_pose("mug").p[:2], atol=1e-6)
    assert np.linalg.norm(world.object_pose("mug").p[:2] - tray.pose.p[:2]) < 0.01


def rehearsal_of(*things: SceneObject, slots: Mapping[str, Slot] | None = None) -> Rehearsal:
    """A rehearsal among some objects."""
    objects = {o.id: o for o in things}
    world = World(template().table, {o.id: Body(o.asset.model, o.pose) for o in things}, robot())
    return Rehearsal(world, objects, slots or {})


HIT_BLOCK, HAMMER = thing("block", (0.05, 0.05)), thing("hammer", (-0.2, -0.05), 0.6)
HELD_AT = [(1, "left"), (0, "left")]


def test_a_hit_is_planned_with_the_way_down(monkeypatch):
    rehearsal_of(HIT_BLOCK, HAMMER).hit(HAMMER.id, HIT_BLOCK.id, HELD_AT)

    def none(*_, **__):
        raise MotionFailed("there is no way down")

    monkeypatch.setattr(rehearsal, "way_down", none)
    with pytest.raises(TaskFailed, match="hammer cannot be brought over block: there is no way down"):
        rehearsal_of(HIT_BLOCK, HAMMER).hit(HAMMER.id, HIT_BLOCK.id, HELD_AT)


def test_a_hit_among_what_is_in_the_way_is_not_planned():
    ring = [
        thing("cereal_box", (0.05 + 0.13 * np.cos(a), 0.05 + 0.13 * np.sin(a)), a + np.pi / 2, id=f"box_{number}")
        for number, a in enumerate(np.linspace(0, 2 * np.pi, 5, endpoint=False).tolist())
    ]
    with pytest.raises(TaskFailed, match="hammer cannot be held over block"):
        rehearsal_of(HIT_BLOCK, HAMMER, *ring).hit(HAMMER.id, HIT_BLOCK.id, HELD_AT)


def test_wiping_is_planned_with_the_way_down_and_the_strokes(monkeypatch):
    board, sponge = thing("cutting_board", (0.05, 0.05), 0.3), thing("sponge", (-0.25, -0.02), 0.6)
    rehearsal_of(board, sponge).wipe(sponge.id, board.id, HELD_AT)

    def none(*_, **__):
        raise MotionFailed("there is no stroke")

    monkeypatch.setattr(rehearsal, "rehearse_wipe", none)
    with pytest.raises(TaskFailed, match="sponge cannot be brought over cutting_board: there is no stroke"):
        rehearsal_of(board, sponge).wipe(sponge.id, board.id, HELD_AT)


@pytest.fixture
def scan():
    """The rehearsal of a scan, and the arguments of :meth:`Rehearsal.show`."""
    box, scanner = thing("cookie_box", (0.1, 0.05), np.pi / 2), thing("barcode_scanner", (-0.15, 0.0))
    (proposal,), _ = TEMPLATES["scan"].proposals([box, scanner], ())
    subtask, _ = proposal.examine(workplace([box, scanner]))
    assert subtask is not None
    moved = subtask.grasped or subtask.object
    (still,) = {box.id, scanner.id} - {moved}
    return rehearsal_of(box, scanner), (moved, still, [(grasp.contact, grasp.arm) for grasp in subtask.grasps])


def test_a_scan_without_a_way_to_some_poses_is_planned_to_others(scan, monkeypatch):
    (task, asked), chosen = scan, Rehearsal._choose_showing

    def after_far_ones(*args, **more):
        plan, hover, groups = chosen(task, *args, **more)
        return plan, hover, iter([[Pose([3.0, 0.0, TABLE_TOP])], *groups])

    monkeypatch.setattr(task, "_choose_showing", after_far_ones)
    task.show(*asked)


def test_what_has_no_way_to_where_a_code_is_read_is_said_to_have_none_before_the_scanner(scan, monkeypatch):
    task, (moved, still, grasps) = scan
    monkeypatch.setattr(rehearsal, "LIMITS", replace(rehearsal.LIMITS, ways_past_arms=0))
    with pytest.raises(TaskFailed, match=f"{moved} cannot be brought before {still}"):
        task.show(moved, still, grasps)


@pytest.mark.parametrize("held_up", [True, False])
def test_past_an_arm_that_holds_something_up_a_thing_is_carried_on_a_simple_way_alone(held_up, monkeypatch):
    """A random tree that finds a way here may find none a millimetre away, where the robot will be."""
    can, block, plate = thing("can", (-0.2, 0.05)), thing("block", (0.25, -0.1)), thing("plate", (0.2, 0.12))
    slots = {"block": Slot("plate", 0, Pose([0.0, 0.0, 0.0066]))}
    task = rehearsal_of(can, block, plate, slots=slots)
    if held_up:
        task.pick("can", [(point.id, "left") for point in can.asset.annotation.carrying_points])
        task.hold()
    after = Rehearsal(task.world, {o.id: o for o in (can, block, plate)}, slots)
    after.pick("block", [(0, "right"), (1, "right")])
    searched: list[bool] = []
    move = MotionPlanner.move

    def noted(*args, search: bool = True, **more):
        searched.append(search)
        return move(*args, search=search, **more)

    monkeypatch.setattr(MotionPlanner, "move", noted)
    after.place("plate")
    assert searched == [False] * held_up
