"""Inserting: a peg is held behind its middle, slid into a hole along its axis, and let go."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from tests.example_scenes import thing, world_of
from tests.example_scenes import workplace as example
from vcage.base.geometry import Pose
from vcage.goals import KINDS
from vcage.schema.goals import Goal
from vcage.schema.robot import Robot
from vcage.sim.kinematics import kinematics_of
from vcage.sim.robots import load_robot
from vcage.tasks.inserting import free_holes, inserted, inserted_poses, inserting_ways
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.state import Watch
from vcage.tasks.task import Task
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.truth import goals_hold

PEG, BLOCK = thing("peg", (-0.2, 0.0), 0.3), thing("peg_block", (0.1, -0.05))
GOAL = Goal(subject=PEG.id, relation="inserted_in", reference=BLOCK.id)
INSERT = TEMPLATES["insert"]


def examined(*objects: SceneObject, goal: Goal = GOAL, robot: str = "aloha_agilex"):
    (proposal,), _ = INSERT.proposals(objects, [goal])
    arms = {name: kinematics_of(arm) for name, arm in load_robot(robot).arms.items()}
    return proposal.examine(replace(example([*objects]), kinematics=arms))


def why_not(*objects: SceneObject, goal: Goal = GOAL) -> str:
    """The first reason why something is not inserted."""
    (proposal,), _ = INSERT.proposals(objects, [goal])
    if (refusal := proposal.impossible()) is not None:
        return refusal.reason
    subtask, refused = proposal.examine(example([*objects]))
    assert subtask is None
    return refused[0].reason


def in_line(share: float, number: int = 0, id: str = PEG.id) -> SceneObject:
    """The peg in line with the hole, its end as deep in that as a share of its depth."""
    peg = thing("peg", (-0.2, 0.2), id=id)
    poses = [pose for depth, pose in at_depths(peg) if depth == share]
    return peg.moved(poses[number])


def at_depths(peg: SceneObject):
    """Depths of the end, as shares of the hole's, and poses there."""
    for way in inserting_ways(peg, BLOCK, peg.asset.annotation.carrying_points[0], []):
        inwards = (way[-1].p - way[0].p) / np.linalg.norm(way[-1].p - way[0].p)
        for depth in (-0.3, 0.0, 0.5, 0.7, 0.8, 1.2):
            yield depth, Pose(way[0].p + (0.03 + depth * 0.06) * inwards, way[0].q)


def test_a_peg_in_reach_of_a_block_is_inserted_in_it() -> None:
    subtask, _ = examined(PEG, BLOCK)
    assert subtask is not None and subtask.goals == [GOAL]
    assert (subtask.object, subtask.grasped, subtask.receptacle) == (PEG.id, PEG.id, None)
    assert subtask.text == "Insert the red peg into the green peg block."
    assert len({subtask.text, *subtask.texts}) >= 10


def test_nothing_is_inserted_unless_it_is_asked_for() -> None:
    assert not INSERT.proposals([PEG, BLOCK], ())[0]


@pytest.mark.parametrize("name", ["mug", "block", "marker"])
def test_what_is_no_peg_is_refused_by_name(name: str) -> None:
    other = thing(name, (-0.2, -0.05))
    goal = Goal(subject=other.id, relation="inserted_in", reference=BLOCK.id)
    assert "is no peg that goes into a hole" in why_not(other, BLOCK, goal=goal)


def test_what_has_no_hole_is_refused_by_name() -> None:
    bowl = thing("bowl", (0.05, 0.05))
    goal = Goal(subject=PEG.id, relation="inserted_in", reference=bowl.id)
    assert why_not(PEG, bowl, goal=goal) == "white bowl has no hole to insert something in"


def test_a_peg_that_is_too_thick_is_refused_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vcage.tasks.templates.insert.suits", lambda *_: False)
    assert why_not(PEG, BLOCK) == "red peg is too thick for the hole of green peg block"


@pytest.mark.parametrize("share", [0.5, 1.2])
def test_a_hole_with_a_peg_in_it_is_taken(share: float) -> None:
    other = in_line(share, id="other")
    assert free_holes(BLOCK, [other]) == []
    assert why_not(PEG, BLOCK, other) == "every hole of green peg block is taken"


def test_a_peg_before_a_hole_leaves_it_free() -> None:
    assert len(free_holes(BLOCK, [in_line(-0.3, id="other")])) == 1


def test_more_pegs_than_holes_are_refused_by_name() -> None:
    pegs = [thing("peg", (0.2 * number, -0.2), id=f"peg_{number}") for number in range(2)]
    goals = [Goal(subject=peg.id, relation="inserted_in", reference=BLOCK.id) for peg in pegs]
    found, refused = INSERT.proposals([*pegs, BLOCK], goals)
    assert found == []
    assert {one.reason for one in refused} == {"green peg block has 1 hole, and 2 things are to be inserted in it"}


def test_a_block_out_of_reach_is_refused() -> None:
    subtask, refused = examined(PEG, thing("peg_block", (0.0, 1.0)))
    assert subtask is None
    assert any("does not reach the hole of green peg block" in one.reason for one in refused)


def test_the_end_that_goes_in_is_far_from_the_hand() -> None:
    for contact in PEG.asset.annotation.carrying_points:
        for way in inserting_ways(PEG, BLOCK, contact, []):
            held, inwards = way[-1].apply(contact.position), way[-1].p - way[0].p
            assert np.abs(held - BLOCK.pose.p)[0] > 0.03 + 0.015
            assert inwards @ (held - way[-1].p) < 0


def test_a_way_begins_before_the_mouth_and_stays_in_line_with_the_hole() -> None:
    contact = PEG.asset.annotation.carrying_points[0]
    ways = list(inserting_ways(PEG, BLOCK, contact, []))
    assert len(ways) == 2 * 4  # mouths, depths
    for way in ways:
        middles = np.array([pose.apply([0.0, 0.0, 0.012]) for pose in way])
        assert middles[:, 1:] == pytest.approx(np.tile([-0.05, 0.74 + 0.055], (len(way), 1)))
        assert inserted(PEG.moved(way[0]), BLOCK).share == 0.0


@pytest.mark.parametrize(("depth", "share"), [(-0.3, 0.0), (0.0, 0.0), (0.5, 0.5), (0.8, 0.8), (1.2, 1.0)])
def test_a_peg_fills_the_hole_as_far_as_it_is_in(depth: float, share: float) -> None:
    lies = inserted(in_line(depth), BLOCK)
    assert lies is not None and lies.share == pytest.approx(share, abs=1e-6)
    assert share == 0 or (lies.aside_m < 1e-6 and lies.leans_rad < 1e-3)


def test_a_peg_over_the_block_in_parallel_with_the_hole_is_not_in_it() -> None:
    above = in_line(1.2).moved(Pose([0.0, 0.0, 0.04]) * in_line(1.2).pose)
    assert inserted(above, BLOCK).share == 0.0


def test_drawings_for_the_critic_tell_how_much_of_the_hole_is_filled() -> None:
    found = list(inserted_poses(PEG, BLOCK))
    assert found
    for share, pose in found:
        assert inserted(PEG.moved(pose), BLOCK).share == pytest.approx(share, abs=1e-6)


def played(robot: Robot, objects: Sequence[SceneObject], grasps: Sequence[tuple[int, str]]):
    """A watch after inserting."""
    by_id, world = {o.id: o for o in objects}, world_of(objects, robot)
    world.settle()
    task, watch = Task(world, by_id, {}), Watch(world, by_id, [GOAL])
    task.insert(GOAL.subject, str(GOAL.reference), grasps)
    task.home()
    return watch


@pytest.mark.parametrize("robot", ["aloha_agilex", "dual_panda"])
def test_the_robot_inserts_the_peg_and_lets_it_go(robot: str) -> None:
    subtask, refused = examined(PEG, BLOCK, robot=robot)
    assert subtask is not None, refused
    watch = played(load_robot(robot), [PEG, BLOCK], [(grasp.contact, grasp.arm) for grasp in subtask.grasps])
    truth = goals_hold([GOAL], watch)
    assert truth.success, truth.reason
    assert watch.touching(PEG.id) <= {BLOCK.id}
    assert np.linalg.norm(watch.thing(BLOCK.id).pose.p - BLOCK.pose.p) < 0.005


def complaint_of(peg: SceneObject, steps: int) -> str | None:
    """Why a peg is not inserted, some physics steps after it was left at its pose."""
    world = world_of([peg, BLOCK])
    for o in (peg, BLOCK):
        world.set_object_pose(o.id, o.pose)
    watch = Watch(world, {o.id: o for o in (peg, BLOCK)}, [GOAL])
    world.step(steps)
    return KINDS["inserted_in"].complaint(GOAL, watch)


@pytest.mark.parametrize("number", [0, 1])
def test_a_peg_at_rest_in_the_hole_is_inserted(number: int) -> None:
    assert complaint_of(in_line(1.2, number), 500) is None


@pytest.mark.parametrize(
    ("peg", "steps", "why"),
    [
        (PEG, 20, "peg is in no hole of peg_block"),
        (in_line(0.7), 1, "peg fills 70 % of the length of the hole of peg_block, and 75 % are needed"),
        (in_line(0.5), 500, "of the length of the hole of peg_block, and 75 % are needed"),
    ],
    ids=["beside", "not deep enough", "half in"],
)
def test_what_is_not_deep_in_the_hole_is_not_inserted(peg: SceneObject, steps: int, why: str) -> None:
    assert why in str(complaint_of(peg, steps))
