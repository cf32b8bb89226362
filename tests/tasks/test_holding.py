"""Things in the air at the end: one in each hand, one in a hand while the other acts, one in both."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from tests.example_scenes import TABLE_TOP, robot, scene_of, thing, world_of
from vcage.base.errors import NoFeasibleTask
from vcage.goals.thresholds import THRESHOLDS
from vcage.schema.goals import AskedGoal, Goal, goal_of
from vcage.schema.subtasks import Subtask
from vcage.sim.kinematics import kinematics_of
from vcage.sim.motion import MotionFailed
from vcage.sim.world import World
from vcage.tasks.holds_with_both import holds_with_both, places_for_both
from vcage.tasks.proven_chain import proven
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import compose, find_subtasks, judging
from vcage.tasks.slots import Slot
from vcage.tasks.state import Watch
from vcage.tasks.synthesis import script_of
from vcage.tasks.task import Task
from vcage.tasks.truth import goals_hold, subtask_done, watch_of
from vcage.tasks.workplace import Workplace

POT = thing("pot", (0.0, 0.0), 0.0)
CAN, BLOCK = thing("can", (-0.2, -0.05)), thing("block", (0.2, -0.05))
CADDY = thing("toolbox_tray", (-0.2, -0.05), 0.0)


def planned(objects: Sequence[SceneObject], *steps: Sequence[str]) -> tuple[list[Subtask], dict[str, Slot]]:
    """The chain for goals, each of a step of its own, and its slots."""
    goals = [goal_of(step) for step in steps]
    asked = [AskedGoal(goal=goal, step=n, words=str(goal)) for n, goal in enumerate(goals, 1)]
    scene = scene_of(objects, "as asked").model_copy(update={"goals": asked})
    rng = np.random.default_rng(0)
    found = find_subtasks(Workplace.of(scene, objects, rng), judging(False), {*goals})
    (chain,) = compose(scene, objects, found.kept, found.refused)
    by_id = {subtask.id: subtask for subtask in found.kept}
    return proven([by_id[name] for name in chain.subtasks], objects, scene, rng)


def played(objects: Sequence[SceneObject], chain: Sequence[Subtask], slots: dict[str, Slot]) -> World:
    """The world after a chain, each step of which is true when it ends."""
    world, by_id = world_of(objects), {o.id: o for o in objects}
    world.settle()
    for step in chain:
        watch = watch_of(step, world, by_id)
        script_of(step).play(Task(world, by_id, {s.object: slots[s.id] for s in (*chain, step) if s.id in slots}))
        watch.stop()
        truth = subtask_done(step, step.goals, watch)
        assert truth.success, truth.reason
    return world


def holds(world: World, objects: Sequence[SceneObject], *goals: Goal) -> bool:
    return goals_hold(goals, Watch(world, {o.id: o for o in objects})).success


def test_each_hand_holds_one_thing_at_the_end():
    objects = [CAN, BLOCK]
    chain, slots = planned(objects, ["can", "held_up"], ["block", "held_up"])
    assert len({step.grasps[0].arm for step in chain}) == 2
    assert holds(played(objects, chain, slots), objects, *(step.goals[0] for step in chain))


def test_the_other_hand_acts_while_one_holds_something_up():
    objects = [CAN, BLOCK, thing("plate", (0.2, 0.12))]
    chain, slots = planned(objects, ["can", "held_up"], ["block", "on", "plate"])
    assert holds(played(objects, chain, slots), objects, *(step.goals[0] for step in chain))


def test_a_thing_is_lifted_with_what_was_put_into_it():
    objects = [CADDY, BLOCK]
    chain, slots = planned(objects, ["block", "inside", "toolbox_tray"], ["toolbox_tray", "held_up"])
    assert holds(played(objects, chain, slots), objects, *(step.goals[0] for step in chain))


def test_a_thing_that_hangs_low_from_its_handle_is_lifted_on_until_all_of_it_is_in_the_air():
    pan = thing("frying_pan", (-0.2, -0.05), 0.0)
    chain, slots = planned([pan], ["frying_pan", "held_up"])
    world = played([pan], chain, slots)
    assert pan.moved(world.object_pose(pan.id)).lowest >= TABLE_TOP + THRESHOLDS.lifted_m


def test_time_may_pass_again_and_again_while_a_hand_holds_something():
    world, by_id = world_of([CAN], robot()), {CAN.id: CAN}
    world.settle()
    task = Task(world, by_id, {})
    task.pick(CAN.id, [(point.id, "left") for point in CAN.asset.annotation.carrying_points])
    for _ in range(6):
        task.wait(0.1)
    assert CAN.moved(world.object_pose(CAN.id)).lowest >= TABLE_TOP + THRESHOLDS.lifted_m


def test_what_a_hand_holds_is_not_put_down_again():
    with pytest.raises(NoFeasibleTask, match="in no order all of them"):
        planned([CAN, BLOCK], ["can", "held_up"], ["can", "beside", "block"])


def test_both_arms_lift_one_thing_at_the_same_time():
    chain, slots = planned([POT], ["pot", "held_by_both"])
    assert [step.template for step in chain] == ["hold_with_both"]
    assert holds(played([POT], chain, slots), [POT], chain[0].goals[0])


def test_both_arms_take_hold_at_even_distances_from_the_middle():
    pairs = places_for_both(POT, next(iter(robot().arms.values())).gripper)
    a, b = (np.array(place.position) for place in pairs[0])
    assert np.allclose((a + b)[:2] / 2, 0, atol=0.01)


def test_two_hands_have_no_room_on_a_small_thing():
    arms = {name: kinematics_of(arm) for name, arm in robot().arms.items()}
    with pytest.raises(MotionFailed, match="two hands have no room on"):
        next(holds_with_both(BLOCK, arms))


def test_both_arms_out_of_reach_are_refused_with_the_reason():
    with pytest.raises(NoFeasibleTask, match="two arms do not both get hold of"):
        planned([thing("pot", (2.0, 0.0))], ["pot", "held_by_both"])
