"""A chain gone through before anything moves."""

from __future__ import annotations

import numpy as np
import pytest

from tests.scenes import GROUND, block_and_plate, kinematics, scene_of, sensible, thing
from vcage.base.errors import NoFeasibleTask
from vcage.base.geometry import Pose
from vcage.schema.goals import AskedGoal, Goal
from vcage.schema.plan import TABLE
from vcage.schema.subtasks import Subtask
from vcage.tasks.rehearsal import examined, rehearsed, require_chain
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import find_subtasks
from vcage.tasks.slots import Slot

BLOCK, PLATE, BOWL = thing("block", (-0.1, -0.1)), thing("plate", (0.15, 0.0)), thing("bowl", (-0.3, 0.1))
OBJECTS: list[SceneObject] = [BLOCK, PLATE, BOWL]


def rng() -> np.random.Generator:
    return np.random.default_rng(0)


@pytest.fixture(scope="module")
def chain() -> list[Subtask]:
    """Block onto the plate, then into the bowl."""
    found = find_subtasks(OBJECTS, kinematics(), sensible, GROUND, rng())
    by_place = {s.receptacle: s for s in found.kept if s.object == BLOCK.id}
    return [by_place[PLATE.id], by_place[BOWL.id]]


def test_what_nothing_has_moved_is_taken_as_it_is(chain):
    assert rehearsed(chain[:1], {}, OBJECTS, kinematics(), GROUND, rng()) == chain[:1]


def test_what_was_moved_is_examined_where_it_was_put(chain):
    slots = {chain[0].id: Slot(PLATE.id, 0, Pose([0.0, 0.0, 0.0066]))}
    there = PLATE.pose * Pose([0.0, 0.0, 0.0066])
    (_, then) = rehearsed(chain, slots, OBJECTS, kinematics(), GROUND, rng())
    assert then is not None
    assert then.id == chain[1].id
    on_plate = thing("block", tuple(there.p[:2]), height=float(there.p[2]), container=PLATE.id)
    alone = examined(chain[1], [on_plate, PLATE, BOWL], kinematics(), GROUND, rng())
    assert alone is not None
    assert then.grasps == alone.grasps


def test_what_was_moved_out_of_reach_is_not_feasible_any_more(chain):
    slots = {chain[0].id: Slot(TABLE, None, Pose([0.0, 3.0, 0.74]), turns=(0.0,))}
    assert rehearsed(chain, slots, OBJECTS, kinematics(), GROUND, rng())[1] is None


def asked(objects: list[SceneObject]):
    goal = Goal(subject="block", relation="on", reference="plate")
    return scene_of(objects).model_copy(
        update={"goals": [AskedGoal(goal=goal, step=0, words="Put the block on the plate")]}
    )


def test_a_layout_in_which_the_instruction_can_be_carried_out_is_as_required():
    objects = block_and_plate()
    require_chain(asked(objects), objects, kinematics(), rng())


def test_a_layout_in_which_no_arm_reaches_what_is_asked_for_is_not():
    block, plate = block_and_plate()
    objects = [block, plate.moved(Pose([0.0, 3.0, 0.74]))]
    with pytest.raises(NoFeasibleTask, match="block"):
        require_chain(asked(objects), objects, kinematics(), rng())
