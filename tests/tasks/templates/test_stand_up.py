"""Standing up: what lies on its side is put down standing, wherever it goes."""

from __future__ import annotations

import pytest

from tests.example_scenes import scene_of, sensible, thing, workplace, world_of
from vcage.base.errors import NoFeasibleTask
from vcage.schema.goals import AskedGoal, Goal, goal_of
from vcage.tasks.chain_slots import slots_for_chain
from vcage.tasks.ruled_out import require_only_stood_up
from vcage.tasks.search import compose, find_subtasks
from vcage.tasks.state import Watch
from vcage.tasks.task import Task
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.truth import goals_hold

BOTTLE = thing("bottle", (-0.15, -0.05), 2.0, variant="water_lying")
TRAY = thing("tray", (0.1, 0.05))
UPRIGHT = Goal(subject="bottle", relation="upright")


def examined(template: str, goal: Goal, *others):
    ((proposal,), _) = TEMPLATES[template].proposals([BOTTLE, *others], [goal])
    return proposal.examine(workplace([BOTTLE, *others]))


def test_it_is_put_down_standing_on_the_table() -> None:
    ((proposal, _), _) = TEMPLATES["set_down"].proposals([BOTTLE], [UPRIGHT])
    assert {str(goal) for goal in proposal.goals} == {"bottle upright", "bottle on table"}


def test_in_a_receptacle_it_stands_too() -> None:
    step, refused = examined("place", Goal(subject="bottle", relation="on", reference="tray"), TRAY)
    assert step is not None, refused
    assert UPRIGHT in step.goals
    slot = slots_for_chain([step], workplace([BOTTLE, TRAY]))[step.id]
    for pose in slot.poses({"tray": TRAY}):
        stands = BOTTLE.moved(pose).as_standing
        assert stands.pose.rotation()[2, 2] > 0.999 and stands.aabb[0, 2] == pytest.approx(TRAY.pose.p[2], abs=0.03)


@pytest.mark.slow
def test_a_lying_bottle_is_stood_up_in_the_simulator() -> None:
    ((proposal, _), _) = TEMPLATES["set_down"].proposals([BOTTLE], [UPRIGHT])
    place = workplace([BOTTLE])
    step, refused = proposal.examine(place)
    assert step is not None, refused
    world, slots = world_of([BOTTLE]), slots_for_chain([step], place)
    watch = Watch(world, {"bottle": BOTTLE}, step.goals)
    task = Task(world, {"bottle": BOTTLE}, {"bottle": slots[step.id]})
    assert not goals_hold([UPRIGHT], watch).success
    task.pick("bottle", [(grasp.contact, grasp.arm) for grasp in step.grasps])
    task.place()
    task.home()
    assert goals_hold(step.goals, watch).success, goals_hold(step.goals, watch).reason


def test_it_is_not_stood_up_in_a_bowl_that_nobody_named() -> None:
    objects = [BOTTLE, thing("bowl", (0.1, 0.05))]
    found = find_subtasks(workplace(objects), sensible, [UPRIGHT])
    assert any({str(goal) for goal in one.goals} == {"bottle inside bowl", "bottle upright"} for one in found.kept)
    asked = [AskedGoal(goal=UPRIGHT, step=1, words="stand the bottle up")]
    scene = scene_of(objects).model_copy(update={"instruction": "Stand the bottle up", "goals": asked})
    ((step,),) = (chain.subtasks for chain in compose(scene, objects, found.kept, found.refused))
    assert next(one.goals[-1] for one in found.kept if one.id == step).reference == "table"


@pytest.mark.parametrize(
    "goal", [["bottle", "shaken"], ["bottle", "back"], ["block", "on", "bottle"], ["bottle", "lifted"]]
)
def test_nothing_else_is_done_with_what_lies(goal: list[str]) -> None:
    asked = [AskedGoal(goal=goal_of(one), step=1, words="so it is asked") for one in (["bottle", "upright"], goal)]
    with pytest.raises(NoFeasibleTask, match="drink bottle lies on its side at the start"):
        require_only_stood_up(asked, [BOTTLE, thing("block")])


@pytest.mark.parametrize(("before", "after"), [(1, 1), (1, 2)])
def test_a_thing_is_put_beside_what_was_stood_up(before: int, after: int) -> None:
    require_only_stood_up(beside_it(before, after), [BOTTLE, thing("block")])


def test_a_thing_is_not_put_beside_what_still_lies() -> None:
    with pytest.raises(NoFeasibleTask, match="drink bottle lies on its side at the start"):
        require_only_stood_up(beside_it(2, 1), [BOTTLE, thing("block")])


def test_a_thing_is_not_stood_up_beside_what_is_stood_up_later() -> None:
    can = thing("can", variant="corn_lying")
    wanted = (UPRIGHT, goal_of(["bottle", "beside", "can"])), (goal_of(["can", "upright"]),)
    asked = [AskedGoal(goal=goal, step=step, words="it") for step, goals in enumerate(wanted) for goal in goals]
    with pytest.raises(NoFeasibleTask, match="can lies on its side at the start"):
        require_only_stood_up(asked, [BOTTLE, can])


def beside_it(upright: int, beside: int) -> list[AskedGoal]:
    """A bottle is stood up, and a block put beside it, each in a step."""
    goals = ((upright, UPRIGHT), (beside, goal_of(["block", "beside", "bottle"])))
    return [AskedGoal(goal=goal, step=step, words="so it is asked") for step, goal in goals]


def test_a_standing_bottle_may_be_shaken() -> None:
    asked = AskedGoal(goal=goal_of(["bottle", "shaken"]), step=1, words="Shake the bottle")
    require_only_stood_up([asked], [thing("bottle")])
