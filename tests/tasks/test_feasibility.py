"""What geometry and inverse kinematics can tell of a candidate before it is simulated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.articulated import (
    LID_RANGE,
    TRAVEL,
    asset_of,
    drawer_cabinet,
    drawer_floor,
    drawer_handle,
    lid_handle,
    lidded_chest,
    standing,
)
from tests.example_scenes import TABLE_TOP, block_and_plate, kinematics, sensible, thing, workplace
from vcage.base.geometry import Pose
from vcage.schema.asset import FunctionalPoint
from vcage.schema.goals import Goal
from vcage.sim.robots import load_robot
from vcage.tasks.access import access
from vcage.tasks.feasibility import Transfer, examine, fits, opens_wide_enough, palm_meets
from vcage.tasks.findings import Feasibility
from vcage.tasks.grasps import grasp_poses
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import find_subtasks
from vcage.tasks.slots import Slot


def point(receptacle: SceneObject):
    return receptacle.asset.annotation.functional_point(0)


def finding(target: SceneObject, receptacle: SceneObject, *others: SceneObject, contact: int = 0) -> Feasibility:
    place, floor = point(receptacle), receptacle.asset.opening(point(receptacle)).floor
    poses = Slot(receptacle.id, place.id, Pose([0.0, 0.0, floor])).poses({receptacle.id: receptacle})
    by, around = target.asset.annotation.contact_point(contact), [receptacle, *others]
    transfer = Transfer.into(target, by, receptacle, place, poses, around)
    return examine(transfer, workplace([]))


def ring(middle: SceneObject, spacing: float) -> list[SceneObject]:
    """Eight bottles around an object."""
    x, y = middle.pose.p[:2]
    around = [(x + spacing * i, y + spacing * j) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j]
    return [thing("lotion_bottle", xy, id=f"bottle-{i}") for i, xy in enumerate(around)]


def test_a_block_fits_on_a_plate():
    check = fits(thing("block"), plate := thing("plate"), point(plate))
    assert check.passed
    assert check.value == pytest.approx(0.133 - 0.04, abs=0.003)


def test_a_plate_does_not_fit_on_a_block():
    check = fits(thing("plate"), block := thing("block"), point(block))
    assert not check.passed
    assert "does not fit on" in check.message


def test_an_object_that_fits_only_when_turned_by_a_quarter_fits():
    box = thing("packaging_box")
    width, depth = box.asset.opening(point(box)).size
    assert width > depth
    block = thing("block")
    half = (depth / 2 - 0.01, width / 2 - 0.001)
    model = block.asset.model.model_copy(update={"lower": (-half[0], -half[1], 0.0), "upper": (*half, 0.04)})
    plank = replace(block, asset=replace(block.asset, model=model))
    assert fits(plank, box, point(box)).passed


def test_the_gripper_holds_a_block():
    block = thing("block")
    assert opens_wide_enough(block, block.asset.annotation.contact_point(0), kinematics()).passed


def test_material_wider_than_the_gripper_is_refused_with_its_width():
    box = thing("packaging_box")
    middle = box.asset.annotation.contact_point(2).model_copy(update={"position": (0.0, 0.0, 0.002)})
    check = opens_wide_enough(box, middle, kinematics())
    assert not check.passed
    assert check.value == pytest.approx(0.228, abs=0.01)
    assert "22.8 cm wide" in check.message


def test_a_block_in_reach_is_feasible_and_its_checks_all_passed():
    found = finding(*block_and_plate())
    assert found.feasible
    assert found.reason == ""
    assert all(check.passed for check in found.checks)
    names = [check.name for check in found.checks]
    assert names == ["opening", "way_free", "reach_grasp", "drop", "reach_place"]


def test_the_arms_come_in_the_order_of_their_scores():
    scores = [grasp.score for grasp in finding(*block_and_plate()).grasps]
    assert scores == sorted(scores, reverse=True)


def test_an_object_no_arm_reaches_is_refused_as_out_of_reach():
    block = thing("block", (0.0, 0.9))
    found = finding(block, thing("plate", (0.05, 0.05)))
    assert not found.feasible
    assert "does not reach 'sides, fingers left and right'" in found.reason


def test_a_receptacle_that_no_arm_reaches_is_refused_as_out_of_reach():
    found = finding(thing("block", (-0.2, -0.05)), thing("plate", (0.0, 1.2)))
    assert not found.feasible
    assert "does not reach 'flat middle'" in found.reason


def test_neighbours_that_leave_no_room_for_the_fingers_are_named():
    block, plate = block_and_plate()
    bottles = ring(block, 0.05)
    found = finding(block, plate, *bottles)
    assert not found.feasible
    assert found.reason.startswith(f"{bottles[0].record.phrase} is in the way of the hand")


def test_tall_things_that_keep_the_hand_high_above_the_receptacle_are_refused_with_the_drop():
    block, plate = block_and_plate()
    found = finding(block, plate, *ring(plate, 0.07))
    assert not found.feasible
    assert "can only be let go" in found.reason
    drop = next(check for check in found.checks if check.name == "drop")
    assert drop.value > drop.limit


def test_a_finding_is_the_same_every_time():
    first, second = (finding(*block_and_plate()) for _ in range(2))
    assert first == second


@pytest.mark.parametrize("yaw", np.linspace(-np.pi, np.pi, 7)[:-1])
def test_a_block_is_feasible_at_every_heading(yaw: float):
    block, plate = block_and_plate()
    assert finding(block.moved(Pose.from_yaw(block.pose.p, yaw)), plate).feasible


# --- objects whose parts move --------------------------------------------------------------------------

PLACE = Pose([0.0, 0.12, TABLE_TOP])
TOP = FunctionalPoint(id=1, name="top of the cabinet", holds="on", position=(0, 0, 0.22))
SHELF = FunctionalPoint(id=2, name="shelf", holds="in", position=(0, 0, 0.1), axis=(0, -1, 0))
INSIDE = FunctionalPoint(id=0, name="inside", holds="in", position=(0, 0, 0.008))


@pytest.fixture(scope="module")
def cabinet(tmp_path_factory):
    model = drawer_cabinet(tmp_path_factory.mktemp("cabinet"))
    return asset_of("cabinet", model, [drawer_handle()], [drawer_floor(), TOP])


@pytest.fixture(scope="module")
def chest(tmp_path_factory):
    return asset_of("chest", lidded_chest(tmp_path_factory.mktemp("chest")), [lid_handle()], [INSIDE])


def test_nothing_is_carried_by_the_handle_of_a_drawer(cabinet):
    assert cabinet.annotation.carrying_points == []
    block = thing("block").asset
    assert block.annotation.carrying_points == block.annotation.contact_points
    assert (block.entry().can_be_carried, cabinet.entry().can_be_carried) == (True, False)


def test_a_closed_drawer_takes_nothing(cabinet):
    check = access(standing(cabinet, PLACE), drawer_floor())
    assert not check.passed
    assert check.message == "the drawer upper of brown cabinet is closed"


def test_an_open_drawer_does(cabinet):
    assert access(standing(cabinet, PLACE, (0.0, TRAVEL)), drawer_floor()).passed


def test_a_lid_keeps_contents_in_until_it_is_open(chest):
    assert access(standing(chest, PLACE), INSIDE).message == "the lid of brown chest is closed"
    assert access(standing(chest, PLACE, (LID_RANGE,)), INSIDE).passed


def test_the_top_of_a_cabinet_is_open(cabinet):
    assert access(standing(cabinet, PLACE), TOP).passed


def test_a_container_open_to_the_front_is_reached_from_the_side(cabinet):
    check = access(standing(cabinet, PLACE), SHELF)
    assert not check.passed
    assert check.message == "'shelf' of brown cabinet can only be reached from the side"


def test_an_object_goes_into_a_drawer_opened_first(cabinet):
    objects = [thing("block", (-0.2, -0.1)), standing(cabinet, PLACE)]
    found = find_subtasks(workplace(objects), sensible)
    into = next(s for s in found.kept if s.functional_point == 0)
    assert into.requires == [Goal(subject="cabinet", relation="open", part="drawer_upper")]
    assert "brown cabinet has no contact point to carry it by" in [r.reason for r in found.refused]


def test_a_palm_that_lies_across_the_object_is_in_its_own_way():
    sign, gripper = thing("payment_sign"), load_robot("aloha_agilex").arms["left"].gripper
    left = sign.asset.annotation.contact_point(1)
    straight, *_, across, _ = grasp_poses(sign.pose, left, gripper, TABLE_TOP, (0.0, np.radians(-80), np.radians(80)))
    meet = [palm_meets(sign, grasp, gripper) for grasp in (straight, across)]
    assert meet == [False, True]
