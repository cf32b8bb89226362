"""The critic on moving parts, from rendered pictures of real objects."""

from __future__ import annotations

import pytest

from tests.example_scenes import scene_of, thing
from vcage.base.geometry import Pose
from vcage.episodes.question import TOP, Asking, verdict
from vcage.runs.context import StageContext
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal
from vcage.sim.cameras import shoot
from vcage.tasks.scene_objects import SceneObject

pytestmark = pytest.mark.slow

PARTS = {"cabinet_one_drawer": "drawer", "laptop": "screen", "kitchen_timer": "dial", "tap": "lever"}
GRASP = {"kitchen_timer": "turned", "tap": "turned"}


@pytest.fixture(scope="module")
def context() -> StageContext:
    return StageContext("offline")


def judged(
    context: StageContext,
    subject: SceneObject,
    word: str,
    before: float,
    after: float,
    part: int = 0,
    moved: int = 0,
    table: str = "grey_stone",
) -> Verdict:
    """The verdict on pictures of an object with a part at two shares of its range, where the goal is about ``part``."""
    scene = scene_of([subject, thing("block", (0.3, -0.1))])
    world = context.drawn_world(scene.model_copy(update={"table": scene.table.topped(table)}))
    links = subject.asset.model.links
    pictures = []
    for share in (before, after):
        joints = [share * link.joint.far_end if n == moved else 0.0 for n, link in enumerate(links)]
        world.set_object_joints(subject.id, joints)
        pictures.append(shoot(world, scene.top_camera))
    for name in world.object_ids:
        world.set_object_pose(name, Pose([0, 0, -9]))
    empty = shoot(world, scene.top_camera)
    goal = Goal(subject=subject.id, relation=word, part=links[part].name)  # pyrefly: ignore
    seen = {when: {TOP: picture} for when, picture in zip(("before", "after"), pictures, strict=True)}
    return verdict(context, scene, Asking("x", [goal], seen, empty))


@pytest.mark.parametrize("name", PARTS)
def test_a_part_that_moved_all_the_way_is_seen(context: StageContext, name: str) -> None:
    verdict = judged(context, thing(name, (-0.05, 0.05), -0.3), GRASP.get(name, "open"), 0.0, 1.0)
    assert verdict.accepted, verdict.reason


@pytest.mark.parametrize(("name", "share"), [("laptop", 0.45), ("tap", 0.0)])
def test_a_part_that_stayed_or_stopped_half_way_is_seen(context: StageContext, name: str, share: float) -> None:
    verdict = judged(context, thing(name, (-0.05, 0.05), 0.2), GRASP.get(name, "open"), 0.0, share)
    assert not verdict.accepted, verdict.reason


def test_a_shut_drawer_differs_from_one_not_quite_shut(context: StageContext) -> None:
    cabinet = thing("cabinet_one_drawer", (-0.05, 0.05), 0.2)
    assert judged(context, cabinet, "closed", 1.0, 0.0).accepted
    verdict = judged(context, cabinet, "closed", 1.0, 0.4)
    assert not verdict.accepted
    assert "looks" in verdict.reason and "% open" in verdict.reason


def test_seen_positions_are_close_to_the_true_ones(context: StageContext) -> None:
    cabinet = thing("cabinet_one_drawer", (-0.05, 0.05), 0.2)
    for share in (0.3, 0.8):
        reason = judged(context, cabinet, "open", 0.0, share).reason
        seen = float(reason.partition(" looks ")[2].partition(" %")[0]) / 100
        assert abs(seen - share) < 0.15, reason


def test_a_drawer_is_not_taken_for_the_one_above_or_below(context: StageContext) -> None:
    cabinet = thing("cabinet_three_drawers", (-0.05, 0.05), 0.1)
    told = [judged(context, cabinet, "open", 0.0, 1.0, part, 1).accepted for part in range(3)]
    assert told == [False, True, False]


def test_a_door_left_ajar_is_not_shut(context: StageContext) -> None:
    cabinet = thing("hinged_cabinet", (-0.05, 0.05), 0.1)
    assert judged(context, cabinet, "closed", 1.0, 0.0).accepted
    assert not judged(context, cabinet, "closed", 1.0, 0.33).accepted


@pytest.mark.parametrize(
    ("table", "word", "start", "end"), [("grey_stone", "open", 0.0, 1.0), ("white_laminate", "closed", 1.0, 0.0)]
)
def test_a_grey_drawer_is_distinguished_from_the_table_in_the_shadow_of_its_cabinet(
    context: StageContext, table: str, word: str, start: float, end: float
) -> None:
    cabinet = thing("cabinet_three_drawers", (-0.05, 0.05), 0.0, variant="steel")
    done = judged(context, cabinet, word, start, end, table=table)
    assert done.accepted, done.reason
    stopped = start if word == "open" else 0.5
    assert not judged(context, cabinet, word, start, stopped, table=table).accepted
