"""Which points of objects with moving parts a pick and a place may use."""

from __future__ import annotations

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
from tests.scenes import TABLE_TOP, kinematics, sensible, thing
from vcage.base.geometry import Pose
from vcage.schema.asset import FunctionalPoint
from vcage.tasks.access import access, carrying_points
from vcage.tasks.search import search

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
    assert carrying_points(cabinet.annotation) == []
    assert len(carrying_points(thing("block").asset.annotation)) == len(thing("block").asset.annotation.contact_points)


def test_a_closed_drawer_takes_nothing(cabinet):
    check = access(standing(cabinet, PLACE), drawer_floor())
    assert not check.passed
    assert check.message == "the drawer upper of brown cabinet is closed"


def test_an_open_drawer_does(cabinet):
    assert access(standing(cabinet, PLACE, (0.0, TRAVEL)), drawer_floor()).passed


def test_a_lid_keeps_in_what_lies_under_it_until_it_is_open(chest):
    assert access(standing(chest, PLACE), INSIDE).message == "the lid of brown chest is closed"
    assert access(standing(chest, PLACE, (LID_RANGE,)), INSIDE).passed


def test_the_top_of_a_cabinet_is_open(cabinet):
    assert access(standing(cabinet, PLACE), TOP).passed


def test_what_opens_to_the_front_is_reached_from_the_side(cabinet):
    check = access(standing(cabinet, PLACE), SHELF)
    assert not check.passed
    assert check.message == "'shelf' of brown cabinet can only be reached from the side"


def test_the_search_refuses_the_closed_drawer_with_the_reason(cabinet):
    objects = [thing("block", (-0.2, -0.1)), standing(cabinet, PLACE)]
    found = search(objects, kinematics(), sensible, TABLE_TOP, np.random.default_rng(0))
    reasons = {(r.object, r.functional_point): r.reason for r in found.refused}
    assert reasons["block", 0] == "the drawer upper of brown cabinet is closed"
    assert reasons["cabinet", None] == "brown cabinet has no contact point to carry it by"
