"""Verdicts of the offline critic on objects set down on the table, shown, scanned, hit, weighed or put back."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from types import MappingProxyType

import numpy as np
import pytest

from tests.example_scenes import TABLE_TOP, library, scene_of, thing
from vcage.base.errors import InputFileError
from vcage.base.geometry import Pose
from vcage.episodes.question import TOP, Asking, cameras, verdict
from vcage.runs.context import StageContext
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal
from vcage.schema.plan import TABLE
from vcage.sim.cameras import shoot
from vcage.sim.robots import load_robot
from vcage.sim.world import World
from vcage.tasks.hitting import hitting_poses
from vcage.tasks.reading import reading_poses

pytestmark = pytest.mark.slow

BOX, PLATE, APPLE = thing("cereal_box", (-0.1, -0.05), 0.3), thing("plate", (0.15, 0.05)), thing("apple", (-0.3, 0.1))
SCANNER, SCALE = thing("barcode_scanner", (0.3, -0.1)), thing("electronic_scale", (0.0, 0.1))
HAMMER = thing("hammer", (0.25, -0.1), 0.5)
LARGE, BLOCK = thing("large_block", (-0.2, 0.1)), thing("block", (0.2, 0.1))
THINGS = (BOX, PLATE, APPLE, SCANNER, SCALE, HAMMER, LARGE, BLOCK)
GONE = Pose([0.0, 0.0, -3.0])
FACING = Pose.from_yaw([0.1, 0.2, TABLE_TOP], np.pi)
SHOWN = Goal(subject=BOX.id, relation="presented")


@cache
def context() -> StageContext:
    return StageContext("offline")


@cache
def table(*names: str):
    """A scene of these objects, drawn."""
    objects = {o.id: o for o in THINGS if o.id in names}
    scene = scene_of(list(objects.values()))
    models = {name: library().asset(o.record.asset, o.record.variant).model for name, o in objects.items()}
    return scene, World.of_scene(scene, models, load_robot(scene.robot), render=True)


def judged(
    goals: list[Goal],
    states: Mapping[str, Mapping[str, Pose]],
    *names: str,
    grasped: str | None = None,
    spoilt: Mapping[str, Callable[[np.ndarray], np.ndarray]] = MappingProxyType({}),
) -> Verdict:
    """The verdict on states in which some objects stand elsewhere than at first, some of the pictures spoilt."""
    scene, world = table(*names)

    def seen(poses: Mapping[str, Pose]):
        for record in scene.objects:
            world.set_object_pose(record.id, poses.get(record.id, record.pose.pose()))
        return {name: shoot(world, camera) for name, camera in cameras(scene, goals).items()}

    empty = seen(dict.fromkeys(names, GONE))[TOP]
    told = {when: seen(poses) for when, poses in states.items()}
    for when, spoil in spoilt.items():
        told[when] = {name: spoil(picture) for name, picture in told[when].items()}
    return verdict(context(), scene, Asking("x", goals, told, empty, grasped=grasped))


def shown(pose: Pose) -> Verdict:
    return judged([SHOWN], {"before": {}, "after": {BOX.id: pose}}, BOX.id, PLATE.id)


def test_a_box_whose_front_faces_the_customer_is_presented() -> None:
    told = shown(FACING)
    assert told.accepted, told.reason


@pytest.mark.parametrize("angle", [90, 180, 270])
def test_a_box_that_shows_another_side_is_not(angle: float) -> None:
    told = shown(Pose.from_yaw(FACING.p, FACING.yaw + np.radians(angle)))
    assert not told.accepted and "from the customer" in told.reason


def test_a_box_on_the_robot_s_half_is_not() -> None:
    told = shown(Pose.from_yaw([0.1, -0.15, TABLE_TOP], np.pi))
    assert not told.accepted and "customer's half" in told.reason


def test_a_box_that_stays_or_falls_is_not() -> None:
    assert "still lies where it was" in shown(BOX.pose).reason
    assert "not found on the table" in shown(GONE).reason


@pytest.mark.parametrize(("x", "left"), [(-0.1, True), (0.4, False)])
def test_an_apple_is_left_of_a_plate_or_not(x: float, left: bool) -> None:
    goal = Goal(subject=APPLE.id, relation="left_of", reference=PLATE.id)
    after = {APPLE.id: Pose([x, 0.05, TABLE_TOP])}
    told = judged([goal], {"before": {}, "after": after}, APPLE.id, PLATE.id)
    assert told.accepted is left, told.reason


@pytest.mark.parametrize(("x", "left"), [(0.02, True), (-0.2, False)])
def test_a_block_that_was_moved_is_not_taken_for_the_larger_one_of_its_colour(x: float, left: bool) -> None:
    goal = Goal(subject=LARGE.id, relation="row_left_of", reference=BLOCK.id)
    before = {BLOCK.id: Pose([0.1, -0.1, TABLE_TOP])}
    after = {**before, LARGE.id: Pose([x, -0.1, TABLE_TOP])}
    told = judged([goal], {"before": before, "after": after}, LARGE.id, BLOCK.id)
    assert told.accepted is left, told.reason


@pytest.mark.parametrize(("at", "bare"), [((0.0, -0.1, 0.0), True), ((0.15, 0.05, 0.01), False)])
def test_an_object_set_down_stands_on_the_bare_table(at: tuple[float, float, float], bare: bool) -> None:
    goal = Goal(subject=APPLE.id, relation="on", reference=TABLE)
    after = {APPLE.id: Pose(np.array(at) + [0, 0, TABLE_TOP])}
    told = judged([goal], {"before": {}, "after": after}, APPLE.id, PLATE.id)
    assert told.accepted is bare, told.reason


@pytest.mark.parametrize(("pushed", "moved"), [(0.05, True), (0.005, False)])
def test_a_push_shorter_than_the_object_is_seen(pushed: float, moved: bool) -> None:
    goal = Goal(subject=PLATE.id, relation="on", reference=TABLE)
    after = {PLATE.id: Pose(PLATE.pose.p + [pushed, 0, 0], PLATE.pose.q)}
    told = judged([goal], {"before": {}, "after": after}, APPLE.id, PLATE.id)
    assert told.accepted is moved, told.reason


@pytest.mark.parametrize(("away", "back"), [(0.0, True), (0.08, False)])
def test_a_returned_object_stands_at_its_start(away: float, back: bool) -> None:
    goal = Goal(subject=APPLE.id, relation="back")
    states = {"start": {}, "before": {APPLE.id: Pose([0.1, -0.1, TABLE_TOP])}}
    after = {APPLE.id: Pose(APPLE.pose.p + [away, 0, 0], APPLE.pose.q)}
    told = judged([goal], {**states, "after": after}, APPLE.id, PLATE.id)
    assert told.accepted is back, told.reason


@pytest.mark.parametrize(("away", "there"), [(0.0, True), (0.09, False)])
def test_an_object_in_place_of_another_stands_where_that_stood(away: float, there: bool) -> None:
    goal = Goal(subject=APPLE.id, relation="in_place_of", reference=PLATE.id)
    elsewhere = {PLATE.id: Pose([-0.1, -0.1, TABLE_TOP])}
    states = {"start": {}, "before": elsewhere}
    after = {**elsewhere, APPLE.id: Pose(PLATE.pose.p + [away, 0, 0], APPLE.pose.q)}
    told = judged([goal], {**states, "after": after}, APPLE.id, PLATE.id)
    assert told.accepted is there, told.reason


@pytest.mark.parametrize(("slid", "weighed"), [(0.0, True), (0.04, False)])
def test_a_weighed_object_lies_still_on_the_scale(slid: float, weighed: bool) -> None:
    goals = [Goal(subject=APPLE.id, relation="weighed"), Goal(subject=APPLE.id, relation="on", reference=SCALE.id)]
    top = SCALE.pose.apply(np.array(SCALE.asset.annotation.functional_point(0).position))
    states = {when: {APPLE.id: Pose(top + [away, 0, 0])} for when, away in (("moment", slid), ("after", 0.0))}
    told = judged(goals, {"before": {}, **states}, APPLE.id, SCALE.id)
    assert told.accepted is weighed, told.reason


def scanned(pose: Pose) -> Verdict:
    states = {"before": {}, "moment": {SCANNER.id: pose}, "after": {}}
    return judged([Goal(subject=BOX.id, relation="scanned")], states, BOX.id, SCANNER.id, grasped=SCANNER.id)


def test_a_scanner_seen_before_a_code_reads_it() -> None:
    told = scanned(next(iter(reading_poses(SCANNER, BOX, TABLE_TOP))))
    assert told.accepted, told.reason


@pytest.mark.parametrize("away", [(0.12, 0.0), (0.0, -0.12)])
def test_a_scanner_seen_elsewhere_reads_nothing(away: tuple[float, float]) -> None:
    there = next(iter(reading_poses(SCANNER, BOX, TABLE_TOP)))
    assert not scanned(Pose(there.p + [*away, 0.0], there.q)).accepted


def test_a_scanner_that_lies_where_it_was_reads_nothing() -> None:
    told = scanned(SCANNER.pose)
    assert not told.accepted and "lies where it was" in told.reason


def test_without_a_picture_of_the_moment_nothing_is_read() -> None:
    goal = Goal(subject=BOX.id, relation="scanned")
    told = judged([goal], {"before": {}, "after": {}}, BOX.id, SCANNER.id, grasped=SCANNER.id)
    assert not told.accepted and "no picture shows the moment" in told.reason


def hit(pose: Pose, after: Pose = APPLE.pose) -> Verdict:
    """The verdict on a hammer at a pose at the moment, and an apple at another one afterwards."""
    states = {"before": {}, "moment": {HAMMER.id: pose}, "after": {APPLE.id: after}}
    goal = Goal(subject=APPLE.id, relation="hit")
    return judged([goal], states, APPLE.id, HAMMER.id, grasped=HAMMER.id)


ON_APPLE = next(hitting_poses(HAMMER, APPLE, above_m=0.0))


def test_a_hammer_seen_on_a_thing_hits_it() -> None:
    told = hit(ON_APPLE)
    assert told.accepted, told.reason


@pytest.mark.parametrize("away", [(0.06, 0.0, 0.0), (0.0, -0.06, 0.0), (0.0, 0.0, 0.07)])
def test_a_hammer_seen_beside_a_thing_or_over_it_hits_nothing(away: tuple[float, float, float]) -> None:
    told = hit(Pose(ON_APPLE.p + away, ON_APPLE.q))
    assert not told.accepted and "is seen with its head on" in told.reason


def test_a_hammer_that_lies_where_it_was_hits_nothing() -> None:
    told = hit(HAMMER.pose)
    assert not told.accepted and "lies where it was" in told.reason


def test_what_was_swept_away_is_not_hit() -> None:
    told = hit(ON_APPLE, after=Pose(APPLE.pose.p + [0.08, 0.0, 0.0], APPLE.pose.q))
    assert not told.accepted and told.failure == "disturbed"


def stranger(picture: np.ndarray) -> np.ndarray:
    """With something magenta on the table that was not there."""
    height, width = picture.shape[:2]
    painted = picture.copy()
    painted[int(0.6 * height) : int(0.68 * height), int(0.62 * width) : int(0.68 * width)] = (200, 30, 160)
    return painted


def noise(picture: np.ndarray) -> np.ndarray:
    return np.random.default_rng(0).integers(0, 256, picture.shape, dtype=np.uint8)


DONE = {
    "presented": ([SHOWN], {BOX.id: FACING}, (BOX.id, PLATE.id)),
    "left_of": (
        [Goal(subject=APPLE.id, relation="left_of", reference=PLATE.id)],
        {APPLE.id: Pose([-0.1, 0.05, TABLE_TOP])},
        (APPLE.id, PLATE.id),
    ),
    "on": (
        [Goal(subject=APPLE.id, relation="on", reference=TABLE)],
        {APPLE.id: Pose([0.0, -0.1, TABLE_TOP])},
        (APPLE.id, PLATE.id),
    ),
}
SPOILT = {"black": np.zeros_like, "noise": noise, "a stranger": stranger, "upside down": lambda p: p[::-1, ::-1].copy()}


CASES = [*(("on", what) for what in SPOILT), ("presented", "noise"), ("left_of", "black")]


@pytest.mark.parametrize(("done", "what"), CASES)
def test_a_picture_that_cannot_be_of_this_table_is_never_a_yes(done: str, what: str) -> None:
    goals, after, names = DONE[done]
    told = judged(goals, {"before": {}, "after": after}, *names, spoilt={"after": SPOILT[what]})
    assert not told.accepted and told.reason


@pytest.mark.parametrize("what", SPOILT)
def test_a_scan_whose_last_picture_cannot_be_of_this_table_is_not_one(what: str) -> None:
    states = {"before": {}, "moment": {SCANNER.id: next(iter(reading_poses(SCANNER, BOX, TABLE_TOP)))}, "after": {}}
    goals, names = [Goal(subject=BOX.id, relation="scanned")], (BOX.id, SCANNER.id)
    told = judged(goals, states, *names, grasped=SCANNER.id, spoilt={"after": SPOILT[what]})
    assert not told.accepted, told.reason


def test_a_picture_of_another_size_is_an_error_that_names_it() -> None:
    goals, after, names = DONE["on"]
    with pytest.raises(InputFileError, match=r"after, top.* takes 640 x 480"):
        judged(goals, {"before": {}, "after": after}, *names, spoilt={"after": lambda p: p[::2, ::2].copy()})


def test_a_question_without_goals_is_an_error() -> None:
    _, after, names = DONE["on"]
    with pytest.raises(InputFileError, match="no goal"):
        judged([], {"before": {}, "after": after}, *names)
