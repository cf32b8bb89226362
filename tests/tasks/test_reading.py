"""Scanners and bar codes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.example_scenes import TABLE_TOP, thing
from vcage.base.geometry import Pose
from vcage.sim.bodies import Body
from vcage.sim.collision import first_near
from vcage.tasks.reading import SETTINGS, free_reading_poses, in_the_way, reading_poses, reads
from vcage.tasks.scene_objects import SceneObject

SCANNER = thing("barcode_scanner", (-0.2, 0.0))
CODED = ["cereal_box", "cookie_box", "juice_carton", "chips_tube", "chocolate_bar", "gum_jar", "energy_drink"]


def held(mover: SceneObject, still: SceneObject) -> SceneObject:
    return mover.moved(next(iter(reading_poses(mover, still, TABLE_TOP))))


@pytest.mark.parametrize("name", CODED)
def test_a_scanner_held_before_a_code_reads_it(name: str) -> None:
    box = thing(name, (0.1, 0.05), 0.3)
    assert reads(held(SCANNER, box), box)


@settings(deadline=None, max_examples=20)
@given(st.floats(-np.pi, np.pi), st.floats(-np.pi, np.pi))
def test_at_every_heading_of_both_the_held_object_stays_upright_and_over_the_table(yaw: float, other: float) -> None:
    box, scanner = thing("cereal_box", (0.1, 0.05), yaw), thing("barcode_scanner", (-0.2, 0.0), other)
    there = held(scanner, box)
    assert there.pose.rotation()[2, 2] == pytest.approx(1)
    assert there.aabb[0, 2] > TABLE_TOP


@pytest.mark.parametrize("name", CODED)
@pytest.mark.parametrize("off", [[0.003, 0, 0], [-0.003, 0, 0], [0, 0.003, 0], [0, -0.003, 0], [0, 0, 0.003]])
def test_a_scan_tolerates_a_few_millimetres(name: str, off: list[float]) -> None:
    box = thing(name, (0.1, 0.05))
    for pose in reading_poses(box, SCANNER, TABLE_TOP):
        assert reads(box.moved(Pose(pose.p + off, pose.q)), SCANNER)


@pytest.mark.parametrize("name", CODED)
def test_a_turned_scanner_is_aimed_at_the_code(name: str) -> None:
    box = thing(name, (0.1, 0.05))
    (reader,) = SCANNER.asset.annotation.faces_of("reader")
    codes = [box.pose.apply(face.position) for face in box.asset.annotation.faces_of("code")]
    for pose in reading_poses(SCANNER, box, TABLE_TOP):
        x, y, _ = pose.rotation() @ np.asarray(reader.axis)
        beside = [abs(float((code - pose.apply(reader.position)) @ [-y, x, 0.0])) for code in codes]
        assert min(beside) < 1e-9


@settings(deadline=None, max_examples=20)
@given(st.floats(-np.pi, np.pi))
def test_reading_is_mutual(yaw: float) -> None:
    box = thing("cereal_box", (0.1, 0.05), yaw)
    there = held(SCANNER, box)
    assert reads(box, there) and reads(there, box)


@pytest.mark.parametrize("away", [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]])
def test_a_code_far_away_or_aside_is_not_read(away: list[float]) -> None:
    box = thing("cookie_box", (0.1, 0.05))
    there = held(SCANNER, box)
    assert not reads(there.moved(Pose(there.pose.p + away, there.pose.q)), box)


def test_a_scanner_turned_away_reads_nothing() -> None:
    box = thing("cookie_box", (0.1, 0.05))
    there = held(SCANNER, box)
    turned = (Pose.from_yaw([0, 0, 0], np.pi / 2) * Pose(q=there.pose.q)).q
    assert not reads(there.moved(Pose(there.pose.p, turned)), box)


def test_two_boxes_read_nothing() -> None:
    assert not list(reading_poses(thing("cookie_box"), thing("cereal_box", (0.2, 0)), TABLE_TOP))


def test_facing_pairs_come_first_and_some_turned_aside_after_them() -> None:
    box = thing("chocolate_bar", (0.1, 0.05))
    poses = list(reading_poses(SCANNER, box, TABLE_TOP))
    off = [abs((4 * (pose.yaw - poses[0].yaw) + np.pi) % (2 * np.pi) - np.pi) / 4 for pose in poses]
    straight = [angle < 1e-6 for angle in off]
    assert straight == sorted(straight, reverse=True)
    assert any(angle > np.radians(15) for angle in off)
    assert all(reads(SCANNER.moved(pose), box) for pose in poses)


@pytest.mark.parametrize("turn", [-4.0, 4.0])
def test_turns_kept_in_reserve_are_larger_and_still_read_a_thing_turned_in_the_hand(turn: float):
    bar = thing("chocolate_bar", (0.1, 0.05))
    assert min(map(abs, SETTINGS.reserve_turns_deg)) > max(map(abs, SETTINGS.turns_deg))
    poses = list(reading_poses(SCANNER, bar, TABLE_TOP, turns_deg=SETTINGS.reserve_turns_deg))
    turned = Pose.from_yaw([0, 0, 0], np.radians(turn))
    assert poses and all(reads(SCANNER.moved(Pose(pose.p, (turned * Pose(q=pose.q)).q)), bar) for pose in poses)


def test_a_scanner_is_held_clear_of_what_the_coded_thing_lies_on():
    scale = thing("electronic_scale", (0.1, 0.05))
    bar = thing("chocolate_bar", (0.1, 0.05), height=scale.rim(0))
    groups = list(free_reading_poses(SCANNER, bar, [scale], TABLE_TOP))
    assert groups
    body = {scale.id: Body(scale.asset.model, scale.pose)}
    held, least = [Body(SCANNER.asset.model, pose) for poses in groups for pose in poses], min(SETTINGS.clearances_m)
    assert all(first_near(one, body, least) is None for one in held)


def test_poses_with_most_room_around_the_held_object_come_first():
    scale = thing("electronic_scale", (0.1, 0.05))
    bar = thing("chocolate_bar", (0.1, 0.05), height=scale.rim(0))
    first, *_, last = free_reading_poses(SCANNER, bar, [scale], TABLE_TOP)
    body, most = {scale.id: Body(scale.asset.model, scale.pose)}, max(SETTINGS.clearances_m)
    assert all(first_near(Body(SCANNER.asset.model, pose), body, most) is None for pose in first)
    assert len(last) > len(first)


def test_what_leaves_no_room_before_a_code_is_named():
    box = thing("cereal_box", (0.1, 0.05))
    around = [
        thing("lotion_bottle", pose.p[:2], id=f"b{i}") for i, pose in enumerate(reading_poses(SCANNER, box, TABLE_TOP))
    ]
    assert not list(free_reading_poses(SCANNER, box, around, TABLE_TOP))
    assert in_the_way(SCANNER, box, around, TABLE_TOP) in around
