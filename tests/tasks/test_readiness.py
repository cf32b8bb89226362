"""The scene as a sub-task needs it."""

from __future__ import annotations

import pytest

from tests.example_scenes import scene_of, subtask, thing
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Subtask
from vcage.tasks.readiness import ready_for

CABINET, STAPLER = thing("cabinet_two_drawers"), thing("stapler", (0.3, 0.0), role="content")
OPEN = Goal(subject="cabinet_two_drawers", relation="open", part="drawer_top")
TRAVEL = CABINET.asset.model.link("drawer_top").joint.far_end
CLOSED = Goal(subject="cabinet_two_drawers", relation="closed", part="drawer_top")


def needing(*requires: Goal) -> Subtask:
    return subtask("stapler", "cabinet_two_drawers", requires=list(requires))


@pytest.mark.parametrize(("requires", "joints"), [([OPEN], (0.0, TRAVEL)), ([CLOSED], ()), ([], ())])
def test_drawers_are_as_the_sub_task_needs_them(requires, joints):
    ready = ready_for(needing(*requires), scene_of([CABINET, STAPLER]), [CABINET, STAPLER])
    assert ready.object("cabinet_two_drawers").joints == pytest.approx(joints)
    assert ready.object("stapler").joints == ()


def test_what_it_does_not_need_stays_as_it_is():
    start = scene_of([CABINET, STAPLER])
    records = [o.model_copy(update={"joints": (0.1, 0.1)}) if o.id == CABINET.id else o for o in start.objects]
    start = start.model_copy(update={"objects": records})
    assert ready_for(needing(CLOSED), start, [CABINET, STAPLER]).object(CABINET.id).joints == (0.1, 0.0)
    assert start.object(CABINET.id).joints == (0.1, 0.1)
