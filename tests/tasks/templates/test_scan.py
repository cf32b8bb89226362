"""Scanning: whichever of scanner and code can be brought to the other is moved."""

from __future__ import annotations

import numpy as np
import pytest

from tests.example_scenes import TABLE_TOP, thing, workplace, world_of
from vcage.base.geometry import Pose
from vcage.schema.goals import Goal
from vcage.tasks import use
from vcage.tasks.reading import reads
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.state import Watch
from vcage.tasks.task import Task
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.truth import goals_hold

BOX, SCANNER = thing("cookie_box", (0.1, 0.05), np.pi / 2), thing("barcode_scanner", (-0.15, 0.0))
SCANNED = Goal(subject=BOX.id, relation="scanned")
SCAN = TEMPLATES["scan"]
SHIFT_M = -0.04
"""Along the fingers; farther than a code may be beside the axis of a window."""


def examined(box: SceneObject, scanner: SceneObject):
    (proposal,), _ = SCAN.proposals([box, scanner], ())
    return proposal.examine(workplace([box, scanner]))


def test_a_code_in_reach_of_a_scanner_in_reach_is_scanned() -> None:
    subtask, _ = examined(BOX, SCANNER)
    assert subtask is not None and subtask.goals == [SCANNED]
    assert (subtask.object, subtask.tool, subtask.receptacle) == (BOX.id, SCANNER.id, None)
    assert len({subtask.text, *subtask.texts}) >= 10


def test_an_object_without_a_code_is_refused_when_requested() -> None:
    block = thing("block")
    _, refused = SCAN.proposals([block, SCANNER], [Goal(subject=block.id, relation="scanned")])
    assert [r.reason for r in refused] == ["red block has no bar code"]


def test_a_code_out_of_reach_is_refused_with_a_reason_for_each_contact_point() -> None:
    subtask, refused = examined(thing("cookie_box", (0.0, 1.0)), thing("barcode_scanner", (0.0, 1.2)))
    assert subtask is None
    assert refused and all("does not reach" in r.reason for r in refused)


def test_the_robot_scans_feasible_objects_and_puts_them_back() -> None:
    subtask, _ = examined(BOX, SCANNER)
    objects = {o.id: o for o in (BOX, SCANNER)}
    world = world_of(list(objects.values()))
    world.settle()
    task, watch = Task(world, objects, {}), Watch(world, objects, [SCANNED])
    moved = subtask.grasped or subtask.object
    still = next(name for name in objects if name != moved)
    task.show(moved, still, [(g.contact, g.arm) for g in subtask.grasps])
    task.home()
    assert goals_hold([SCANNED], watch).success
    assert task.moment is not None and task.moment.objects[moved].p[2] > TABLE_TOP
    assert np.linalg.norm((world.object_pose(moved).p - objects[moved].pose.p)[:2]) < 0.02


def test_what_shifted_in_the_hand_is_brought_before_the_window_again(monkeypatch: pytest.MonkeyPatch) -> None:
    subtask, _ = examined(BOX, SCANNER)
    objects = {o.id: o for o in (BOX, SCANNER)}
    world = world_of(list(objects.values()))
    world.settle()
    task, asked = Task(world, objects, {}), list[bool]()
    moved = subtask.grasped or subtask.object
    still = next(name for name in objects if name != moved)

    def shifted_first(one: SceneObject, other: SceneObject) -> bool:
        if not asked:  # between the fingers, along them
            (arm,) = (name for name in world.arms if world.holds(name, moved))
            along = world.arms[arm].tool_pose.rotation()[:, 0]
            world.set_object_pose(moved, Pose(one.pose.p + SHIFT_M * along, one.pose.q))
        now = [objects[name].moved(world.object_pose(name)) for name in (moved, still)]
        asked.append(reads(*now))
        return asked[-1]

    monkeypatch.setattr(use, "reads", shifted_first)
    task.show(moved, still, [(g.contact, g.arm) for g in subtask.grasps])
    assert asked == [False] and task.moment is not None
    assert reads(*(objects[name].moved(task.moment.objects[name]) for name in (moved, still)))


def test_an_object_at_the_scanners_place_is_named() -> None:
    around = [(dx, dy) for dx in (-0.13, 0.0, 0.13) for dy in (-0.15, 0.15)] + [(-0.13, 0.0), (0.13, 0.0)]
    vases = [thing("vase", (0.1 + dx, 0.05 + dy), id=f"vase-{number}") for number, (dx, dy) in enumerate(around)]
    objects = [BOX, SCANNER, *vases]
    (proposal,), _ = SCAN.proposals(objects, ())
    subtask, refused = proposal.examine(workplace(objects))
    assert subtask is None
    assert any("would touch" in r.reason and "vase" in r.reason for r in refused)
