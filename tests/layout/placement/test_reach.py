"""The reach map: exact cells, cut to any workspace, asked once."""

from __future__ import annotations

import logging
from types import SimpleNamespace

import numpy as np
import pytest

from tests.example_scenes import library
from vcage.base.errors import UsageError
from vcage.base.geometry import Pose
from vcage.layout.placement import reach_map
from vcage.layout.placement.reach import reach_for, robot_reach
from vcage.layout.placement.reach_map import EITHER, YAWS, Tilted
from vcage.sim.cameras import overview
from vcage.sim.robots import load_robot

WORKSPACE = np.array([[-0.3, -0.2], [0.3, 0.2]])
HEIGHTS = (0.77, 0.96)


class Disc:
    """An arm that reaches a disc, and counts how often it is asked."""

    def __init__(self, centre=(0.0, 0.0), radius=0.17):
        self.centre, self.radius, self.asked = np.array(centre), radius, 0

    def reachable(self, pose: Pose) -> bool:
        self.asked += 1
        return bool(np.linalg.norm(pose.p[:2] - self.centre) <= self.radius)


def inside(points: np.ndarray, rectangles: np.ndarray) -> np.ndarray:
    return np.any(np.all((rectangles[:, 0] <= points[:, None]) & (points[:, None] <= rectangles[:, 1]), 2), axis=1)


@pytest.fixture
def robot():
    return load_robot("dual_panda")


@pytest.fixture
def disc(monkeypatch: pytest.MonkeyPatch) -> Disc:
    """Stands in for the inverse kinematics of every arm."""
    found = Disc()
    monkeypatch.setattr(reach_map, "kinematics_of", lambda _arm: found)
    return found


def test_no_point_of_a_rectangle_is_out_of_reach_and_few_within_reach_are_missing(robot, disc, tmp_path):
    points = np.random.default_rng(0).uniform(*WORKSPACE, (2000, 2))
    covered = inside(points, robot_reach(robot, WORKSPACE, HEIGHTS, tmp_path))
    distance = np.linalg.norm(points, axis=1)
    assert not np.any(covered & (distance > disc.radius))
    assert covered[distance < disc.radius - 1.5 * reach_map.SETTINGS.cell_m].all()


class Tilting(Disc):
    """An arm that reaches farther with its hand tilted, but not higher than 0.9 m."""

    def reachable(self, pose: Pose) -> bool:
        tilted = -pose.rotation()[2, 2] < 0.9
        far = np.linalg.norm(pose.p[:2] - self.centre) <= self.radius + 0.15 * tilted
        return bool(far and (pose.p[2] < 0.9 or not tilted))


def test_the_hand_tilts_where_no_arm_reaches_straight_down(robot, monkeypatch, tmp_path):
    monkeypatch.setattr(reach_map, "kinematics_of", lambda _arm: Tilting())
    points = np.random.default_rng(0).uniform(*WORKSPACE, (2000, 2))
    covered = inside(points, robot_reach(robot, WORKSPACE, HEIGHTS, tmp_path))
    distance = np.linalg.norm(points, axis=1)
    assert not np.any(covered & (distance > 0.32))
    assert covered[distance < 0.32 - 1.5 * reach_map.SETTINGS.cell_m].all()
    high = robot_reach(robot, WORKSPACE, HEIGHTS, tmp_path, tilted=Tilted(higher=0.09))
    assert not np.any(inside(points, high) & (distance > 0.17)), "0.95 m is too high for a tilted hand"


class Facing(Disc):
    """An arm that reaches any point with the fingers closing about along one direction, the hand tilted."""

    def reachable(self, pose: Pose) -> bool:
        rotation = pose.rotation()
        return bool(-rotation[2, 2] < 0.99 and abs(rotation[0, 1]) > 0.7)


def test_of_two_headings_a_quarter_turn_apart_one_is_enough_where_a_hand_may_choose(robot, monkeypatch, tmp_path):
    monkeypatch.setattr(reach_map, "kinematics_of", lambda _arm: Facing())
    assert robot_reach(robot, WORKSPACE, HEIGHTS, tmp_path).shape == (0, 2, 2)
    chosen = robot_reach(robot, WORKSPACE, HEIGHTS, tmp_path, tilted=Tilted(EITHER))
    np.testing.assert_allclose(chosen, [WORKSPACE])


def test_a_hand_chooses_its_heading_at_a_block_and_where_it_puts_something_but_not_at_a_bar():
    assert Tilted.of(library().asset("block"), "content") == Tilted(EITHER)
    assert Tilted.of(library().asset("chocolate_bar"), "content") == Tilted()
    box = library().asset("packaging_box")
    asked = Tilted.of(box, "receptacle")
    assert asked.headings == EITHER
    assert asked.higher >= box.opening(box.annotation.functional_points[0]).rim


@pytest.mark.parametrize("yaw", np.radians([0, 30, 90, 100, -45]))
def test_a_known_heading_is_reached_with_hands_closing_on_both_sides(yaw):
    """A chocolate bar is held across: the fingers close along its own y, as those of a hand at heading 0 do."""
    (numbers,) = Tilted.of(library().asset("chocolate_bar"), "content", yaw).headings
    off = [(YAWS[number] - yaw + np.pi / 2) % np.pi - np.pi / 2 for number in numbers]
    assert max(map(abs, off)) < np.radians(45) + 1e-6
    assert min(off) <= 1e-6
    assert max(off) >= -1e-6


def test_the_arms_share_the_table(robot, monkeypatch, tmp_path):
    left = robot.arms["left"]
    monkeypatch.setattr(reach_map, "kinematics_of", lambda arm: Disc((-0.2, 0) if arm == left else (0.2, 0)))
    together = robot_reach(robot, WORKSPACE, HEIGHTS, tmp_path)
    assert inside(np.array([[-0.2, 0.0], [0.2, 0.0]]), together).all()


def test_the_common_reach_of_all_arms_lies_between_them(robot, monkeypatch, tmp_path):
    left = robot.arms["left"]
    monkeypatch.setattr(reach_map, "kinematics_of", lambda arm: Disc((-0.1, 0) if arm == left else (0.1, 0)))
    shared = robot_reach(robot, WORKSPACE, HEIGHTS, tmp_path, every=True)
    assert inside(np.array([[0.0, 0.0], [-0.2, 0.0], [0.2, 0.0]]), shared).tolist() == [True, False, False]


def test_without_an_arm_nothing_is_reached(robot, tmp_path):
    assert robot_reach(robot.model_copy(update={"arms": {}}), WORKSPACE, HEIGHTS, tmp_path).shape == (0, 2, 2)


def test_area_outside_the_robots_camera_does_not_count(disc, tmp_path):
    robot, wide = load_robot("aloha_agilex"), 2 * WORKSPACE
    points, disc.radius = np.random.default_rng(0).uniform(*wide, (2000, 2)), 2.0
    sees = overview(robot).sees(np.column_stack([points, np.full(len(points), min(HEIGHTS))]))
    covered = inside(points, robot_reach(robot, wide, HEIGHTS, tmp_path))
    assert 0 < sees.sum() < len(sees)
    assert not (covered & ~sees).any() and covered.sum() > 0.8 * sees.sum()
    blind = robot.model_copy(update={"cameras": {n: c for n, c in robot.cameras.items() if c.arm}})
    np.testing.assert_allclose(robot_reach(blind, wide, HEIGHTS, tmp_path), [wide])


def test_rectangles_are_cut_to_a_workspace_off_the_grid(robot, disc, tmp_path):
    disc.radius, workspace = 1.0, np.array([[-0.07, -0.03], [0.06, 0.08]])
    np.testing.assert_allclose(robot_reach(robot, workspace, HEIGHTS, tmp_path), [workspace])


@pytest.mark.parametrize("workspace", [WORKSPACE[::-1], WORKSPACE * np.nan], ids=["inverted", "nan"])
def test_a_workspace_that_makes_no_sense_is_refused(robot, disc, tmp_path, workspace):
    with pytest.raises(UsageError, match="workspace"):
        robot_reach(robot, workspace, HEIGHTS, tmp_path)


def held_at(distance: float, articulated: bool = False) -> SimpleNamespace:
    """A pan that is held at a distance from its middle."""
    points = [SimpleNamespace(position=(distance, 0.0, 0.0))]
    annotation = SimpleNamespace(contact_points=points, functional_points=[])
    return SimpleNamespace(name="pan", articulated=articulated, annotation=annotation)


def test_an_object_stands_where_all_points_of_its_role_are_in_reach(caplog):
    with caplog.at_level(logging.WARNING):
        inset = reach_for(held_at(0.05), "content", WORKSPACE[None])
        np.testing.assert_allclose(inset, [[[-0.25, -0.15], [0.25, 0.15]]])
        np.testing.assert_array_equal(reach_for(held_at(0.05), "receptacle", WORKSPACE[None]), WORKSPACE[None])
        assert reach_for(held_at(0.05), "context", WORKSPACE[None]) is None
        assert reach_for(held_at(0.05, articulated=True), "content", WORKSPACE[None]) is None
    assert not caplog.text


def test_an_object_reached_nowhere_all_around_stands_where_its_middle_is_reached_and_that_is_reported(caplog):
    with caplog.at_level(logging.WARNING):
        np.testing.assert_array_equal(reach_for(held_at(0.25), "content", WORKSPACE[None]), WORKSPACE[None])
    assert "pan" in caplog.text and "250 mm" in caplog.text


def test_a_robot_is_asked_once(robot, disc, tmp_path):
    first = robot_reach(robot, WORKSPACE, HEIGHTS, tmp_path)
    asked = disc.asked
    again = robot_reach(robot, WORKSPACE, HEIGHTS, tmp_path)
    np.testing.assert_array_equal(first, again)
    assert disc.asked == asked > 0


@pytest.mark.slow
def test_a_smaller_workspace_needs_no_more_questions_and_a_larger_one_only_the_new(robot, disc, tmp_path):
    robot_reach(robot, WORKSPACE, HEIGHTS, tmp_path)
    asked = disc.asked
    robot_reach(robot, WORKSPACE / 2, HEIGHTS, tmp_path)
    assert disc.asked == asked
    wider = robot_reach(robot, WORKSPACE * 2, HEIGHTS, tmp_path / "first")
    np.testing.assert_array_equal(wider, robot_reach(robot, WORKSPACE * 2, HEIGHTS, tmp_path))


def test_other_heights_and_other_arms_have_maps_of_their_own(robot, disc, tmp_path):
    robot_reach(robot, WORKSPACE, HEIGHTS, tmp_path)
    robot_reach(robot, WORKSPACE, (0.8,), tmp_path)
    moved = robot.arms["left"].model_copy(update={"base": robot.arms["right"].base})
    robot_reach(robot.model_copy(update={"arms": {"left": moved}}), WORKSPACE, HEIGHTS, tmp_path)
    # The moved left arm is the right one in all that matters, so it shares that one's maps: straight down and tilted.
    assert len(list(tmp_path.iterdir())) == 8


@pytest.mark.slow
@pytest.mark.parametrize("content", ["", "{", "[]", '{"nodes": 3}', '{"nodes": [[1, 2]]}'])
def test_a_damaged_map_is_made_again(robot, disc, tmp_path, content, caplog):
    first = robot_reach(robot, WORKSPACE, HEIGHTS, tmp_path)
    for path in tmp_path.iterdir():
        path.write_text(content)
    with caplog.at_level(logging.WARNING):
        np.testing.assert_array_equal(robot_reach(robot, WORKSPACE, HEIGHTS, tmp_path), first)
    assert "damaged" in caplog.text
    assert all(path.stat().st_size > 100 for path in tmp_path.iterdir())


def test_an_unwritable_folder_is_reported_and_skipped(robot, disc, tmp_path, caplog):
    (tmp_path / "file").write_text("")
    with caplog.at_level(logging.WARNING):
        found = robot_reach(robot, WORKSPACE, HEIGHTS, tmp_path / "file")
    assert len(found) and "not kept" in caplog.text


def test_the_real_arms_reach_the_middle_of_their_table(robot, tmp_path):
    middle = np.array([[-0.25, -0.1], [-0.15, 0.0]])
    np.testing.assert_allclose(robot_reach(robot, middle, HEIGHTS, tmp_path), [middle])
