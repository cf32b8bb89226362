"""What happens in a world is seen."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from tests.example_scenes import TABLE_TOP, thing, world_of
from vcage.base.geometry import Pose
from vcage.schema.goals import Goal
from vcage.sim.world import PHYSICS_HZ, World
from vcage.tasks.hitting import hitting_poses
from vcage.tasks.reading import reading_poses
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.state import Watch
from vcage.tasks.truth import goals_hold

BAR, SCALE = "chocolate_bar", "electronic_scale"
WEIGHED = Goal(subject=BAR, relation="weighed")
SCANNED = Goal(subject="cookie_box", relation="scanned")


def watched(objects: Sequence[SceneObject], goal: Goal) -> tuple[World, Watch]:
    world = world_of(objects)
    world.settle()
    return world, Watch(world, {o.id: o for o in objects}, [goal])


def on_scale(world: World, name: str, aside: float = 0.0) -> None:
    scale = thing(SCALE).asset
    top = scale.annotation.functional_point(0).position
    world.set_object_pose(name, Pose([top[0] + aside, top[1], TABLE_TOP + top[2] + 0.002]))


def test_an_object_still_on_a_scale_for_a_second_is_weighed() -> None:
    world, watch = watched([thing(BAR, (0.3, 0.0)), thing(SCALE)], WEIGHED)
    on_scale(world, BAR)
    world.step(int(1.5 * PHYSICS_HZ))
    assert watch.lasted_s(WEIGHED) >= 1.0
    assert goals_hold([WEIGHED], watch).success


def test_half_a_second_on_a_scale_is_too_short() -> None:
    world, watch = watched([thing(BAR, (0.3, 0.0)), thing(SCALE)], WEIGHED)
    on_scale(world, BAR)
    world.step(int(0.5 * PHYSICS_HZ))
    truth = goals_hold([WEIGHED], watch)
    assert not truth.success and "was weighed for 0" in truth.reason


def test_with_something_else_on_the_scale_nothing_is_weighed() -> None:
    world, watch = watched([thing(BAR, (0.3, 0.0)), thing("block", (-0.3, 0.0)), thing(SCALE)], WEIGHED)
    on_scale(world, BAR, -0.03)
    on_scale(world, "block", 0.06)
    world.step(2 * PHYSICS_HZ)
    assert watch.lasted_s(WEIGHED) == 0


def test_an_object_on_the_table_is_not_weighed() -> None:
    world, watch = watched([thing(BAR, (0.3, 0.0)), thing(SCALE)], WEIGHED)
    world.step(2 * PHYSICS_HZ)
    assert watch.lasted_s(WEIGHED) == 0


@pytest.mark.parametrize(("seconds", "read"), [(0.5, True), (0.1, False)])
def test_a_code_before_a_scanner_for_a_moment_is_read(seconds: float, read: bool) -> None:
    box, scanner = thing("cookie_box", (0.1, 0.05)), thing("barcode_scanner", (-0.2, 0.0))
    world, watch = watched([box, scanner], SCANNED)
    there = next(iter(reading_poses(scanner, box, TABLE_TOP)))
    for _ in range(int(seconds * PHYSICS_HZ)):
        world.set_object_pose(scanner.id, there)  # held
        world.step()
    assert goals_hold([SCANNED], watch).success is read


def test_events_after_the_end_of_a_watch_are_not_seen() -> None:
    world, watch = watched([thing(BAR, (0.3, 0.0)), thing(SCALE)], WEIGHED)
    watch.stop()
    on_scale(world, BAR)
    world.step(2 * PHYSICS_HZ)
    assert watch.lasted_s(WEIGHED) == 0


@pytest.mark.parametrize("held", [True, False])
def test_only_a_tool_between_the_fingers_hits(held: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    block, hammer = thing("block"), thing("hammer", (-0.3, 0.0))
    over = hammer.moved(next(hitting_poses(hammer, block, above_m=0.0)))
    _, watch = watched([block], Goal(subject="block", relation="hit"))
    monkeypatch.setattr(watch, "thing", {"block": block, "hammer": over}.__getitem__)
    monkeypatch.setattr(watch, "objects", {"block": block, "hammer": over})
    monkeypatch.setattr(watch, "touching", {"block": {"hammer"}, "hammer": {"block", "left"}}.__getitem__)
    monkeypatch.setattr(watch, "holds", lambda arm, name: held and (arm, name) == ("left", "hammer"))
    assert watch.is_hit("block") is held
