"""Check 3: what can be held passes, what cannot says why."""

from __future__ import annotations

import pytest

from tests.apps.proof.conftest import CUBE, contact
from vcage.apps.proof.grasping import check_contact


def test_a_cube_is_lifted_held_and_shaken(make, places) -> None:
    check = check_contact(make(CUBE, contacts=[contact()]), contact(), places, tries=3, seed=0)
    assert (check.passed, check.succeeded) == (True, 3)


def test_a_too_wide_object_is_refused_without_a_try(make, places) -> None:
    wide = make([[(-0.02, -0.05, 0), (0.02, 0.05, 0.04)]])
    check = check_contact(wide, contact(), places, tries=3, seed=0)
    assert not check.passed and check.tries == 0
    assert "10.0 cm wide" in check.reasons[0]


def test_a_point_beside_the_material_is_refused(make, places) -> None:
    check = check_contact(make(CUBE), contact(position=(0.05, 0, 0.025)), places, tries=3, seed=0)
    assert not check.passed and check.tries == 0


def test_a_way_blocked_by_the_object_itself_is_refused(make, places) -> None:
    roofed = [*CUBE, [(-0.05, -0.05, 0.06), (0.05, 0.05, 0.07)]]
    check = check_contact(make(roofed), contact(), places, tries=3, seed=0)
    assert not check.passed and "would touch the object" in check.reasons[0]


def test_a_too_heavy_object_slips(make, places) -> None:
    heavy = make(CUBE, mass=60.0, contacts=[contact()])
    check = check_contact(heavy, contact(), places, tries=2, seed=0)
    assert not check.passed and check.tries == 2
    assert check.reasons


@pytest.mark.slow
def test_tries_are_the_same_for_the_same_seed(make, places) -> None:
    first, second = (
        check_contact(make(CUBE, contacts=[contact()]), contact(), places, tries=2, seed=4) for _ in range(2)
    )
    assert first == second
