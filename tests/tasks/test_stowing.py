"""Things in drawers, at the start and once these are open."""

from __future__ import annotations

import numpy as np
import pytest

from tests.example_scenes import robot, scene_of, subtask, thing, workplace, world_of
from vcage.base.errors import InfeasibleScene
from vcage.schema.goals import Description, Goal
from vcage.schema.subtasks import Subtask
from vcage.tasks.described import complaints, untrue
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import initial_state
from vcage.tasks.stowing import reached, ready_for, stow, with_part
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.templates.set_down import SET_DOWN

CABINET = thing("cabinet_two_drawers", (0.0, 0.06))
ON_TABLE = Goal(subject="battery_pack", relation="on", reference="table")
IN_DRAWER = Goal(subject="battery_pack", relation="inside", reference="cabinet_two_drawers", part="drawer_top")
OPEN = Goal(subject="cabinet_two_drawers", relation="open", part="drawer_top")
SAID = Description(
    subject="battery_pack", relation="inside", reference="cabinet_two_drawers", part="drawer_top", words="from it"
)


def stowed(part: str = "drawer_top", seed: int = 0) -> SceneObject:
    """A pack of batteries in a closed drawer."""
    pack = thing("battery_pack", role="content", container=CABINET.id)
    record = pack.record.model_copy(update={"container_part": part})
    pack = SceneObject(record, pack.asset, pack.pose)
    return pack.moved(stow(CABINET, part, [pack], robot(), np.random.default_rng(seed))[pack.id])


@pytest.mark.parametrize("part", ["drawer_top", "drawer_bottom"])
def test_a_stowed_object_lies_still_in_its_drawer(part):
    pack = stowed(part)
    world = world_of([CABINET, pack])
    report = world.settle()
    assert report.settled and report.drift_m[pack.id] < 0.002
    said = SAID.model_copy(update={"part": part})
    scene = scene_of([CABINET, pack]).model_copy(update={"descriptions": [said]})
    assert untrue(scene, [CABINET, pack.moved(world.object_pose(pack.id))]) == []


def test_an_object_in_another_drawer_is_not_at_its_described_place():
    scene = scene_of([CABINET, stowed()]).model_copy(update={"descriptions": [SAID]})
    (complaint,) = complaints(scene, [CABINET, stowed("drawer_bottom")])
    assert "inside the top drawer of the" in complaint and "'from it'" in complaint


def test_an_object_larger_than_the_drawer_is_refused():
    mug = thing("mug", role="content", container=CABINET.id)
    many = [SceneObject(mug.record.model_copy(update={"id": f"mug{k}"}), mug.asset, mug.pose) for k in range(6)]
    with pytest.raises(InfeasibleScene):
        stow(CABINET, "drawer_top", many, robot(), np.random.default_rng(0))


def test_the_planner_knows_the_drawer_of_the_object():
    state = initial_state([CABINET, stowed()])
    assert IN_DRAWER in state and ON_TABLE not in state


def test_a_drawer_takes_along_its_contents_and_nothing_else():
    pack, below = stowed(), stowed("drawer_bottom")
    other = SceneObject(below.record.model_copy(update={"id": "other"}), below.asset, below.pose)
    _, moved, stays = with_part([CABINET, pack, other], CABINET.id, "drawer_top")
    assert moved.pose.p - pack.pose.p == pytest.approx([0, -CABINET.asset.model.link("drawer_top").joint.upper, 0])
    assert stays is other


def test_taking_it_out_needs_the_drawer_open_and_is_examined_so():
    pack = stowed()
    proposal = next(p for p in SET_DOWN.proposals([CABINET, pack], [ON_TABLE])[0] if p.goal == ON_TABLE)
    found, refused = proposal.examine(workplace([CABINET, pack]))
    assert found is not None, [refusal.reason for refusal in refused]
    assert found.requires == [OPEN] and found.grasps
    ready = ready_for(found, scene_of([CABINET, pack]), [CABINET, pack])
    there = reached(pack, [CABINET])
    assert any(ready.object(CABINET.id).joints)
    assert ready.object(pack.id).pose.position == pytest.approx(there.thing.pose.p.tolist(), abs=1e-5)


def test_it_is_put_onto_a_plate_from_the_open_drawer():
    pack, plate = stowed(), thing("plate", (0.3, -0.1), role="receptacle")
    pairs, _ = TEMPLATES["place"].proposals([CABINET, pack, plate], [])
    pair = next(p for p in pairs if (p.thing.id, p.receptacle.id) == (pack.id, plate.id))
    found, refused = pair.examine(workplace([CABINET, pack, plate]))
    assert found is not None, [refusal.reason for refusal in refused]
    assert found.requires == [OPEN]


def test_taking_from_a_lower_drawer_needs_the_upper_ones_closed():
    there = reached(stowed("drawer_bottom"), [CABINET])
    assert [str(goal) for goal in there.requires] == [
        "cabinet_two_drawers/drawer_bottom open",
        "cabinet_two_drawers/drawer_top closed",
    ]


@pytest.mark.parametrize(("start", "goes"), [("drawer_top", "drawer_bottom"), ("drawer_bottom", "drawer_top")])
def test_nothing_goes_from_a_drawer_into_one_over_or_under_it(start, goes):
    pairs, _ = TEMPLATES["place"].proposals([CABINET, stowed(start)], [])
    refusals = {p.goal.part: p.impossible() for p in pairs if p.thing.id == "battery_pack"}
    assert refusals[goes] is not None and "one over the other" in refusals[goes].reason
    assert refusals[start] is None


def test_an_object_in_no_drawer_is_reached_in_place():
    pack = thing("battery_pack", (0.3, -0.1), role="content")
    there = reached(pack, [CABINET])
    assert (there.thing, there.others, there.requires) == (pack, [CABINET], [])


STAPLER = thing("stapler", (0.3, 0.0), role="content")
TRAVEL = CABINET.asset.model.link("drawer_top").joint.far_end
CLOSED = Goal(subject="cabinet_two_drawers", relation="closed", part="drawer_top")


def needing(*requires: Goal) -> Subtask:
    return subtask("stapler", "cabinet_two_drawers", requires=list(requires))


@pytest.mark.parametrize(("requires", "joints"), [([OPEN], (0.0, TRAVEL)), ([CLOSED], ()), ([], ())])
def test_drawers_are_as_the_sub_task_needs_them(requires, joints):
    ready = ready_for(needing(*requires), scene_of([CABINET, STAPLER]), [CABINET, STAPLER])
    assert ready.object("cabinet_two_drawers").joints == pytest.approx(joints)
    assert ready.object("stapler").joints == ()


def test_unneeded_objects_stay_unchanged():
    start = scene_of([CABINET, STAPLER])
    records = [o.model_copy(update={"joints": (0.1, 0.1)}) if o.id == CABINET.id else o for o in start.objects]
    start = start.model_copy(update={"objects": records})
    assert ready_for(needing(CLOSED), start, [CABINET, STAPLER]).object(CABINET.id).joints == (0.1, 0.0)
    assert start.object(CABINET.id).joints == (0.1, 0.1)
