"""Check 1 finds each fault of a mesh."""

from __future__ import annotations

import pytest

from tests.apps.proof.conftest import CUBE, TRAY, inside
from vcage.apps.proof.mesh import check_mesh


def test_a_sound_container_passes(make) -> None:
    check = check_mesh(make(TRAY, functional=[inside()]), seed=0)
    assert check.passed, check.reasons
    assert check.measured["cover_mm"] == pytest.approx(0, abs=0.01)


def test_too_many_faces_fail(make) -> None:
    check = check_mesh(make(CUBE, subdivisions=5), seed=0)
    assert not check.passed and "12288 faces" in check.reasons[0]


def test_a_surface_without_a_hull_fails(make) -> None:
    check = check_mesh(make([*CUBE, [(0.02, -0.02, 0), (0.06, 0.02, 0.04)]], CUBE), seed=0)
    assert any("outside the hulls" in reason for reason in check.reasons)


def test_an_invisible_hull_fails(make) -> None:
    check = check_mesh(make(CUBE, [*CUBE, [(0.02, -0.02, 0), (0.06, 0.02, 0.04)]]), seed=0)
    assert any("beyond the mesh" in reason for reason in check.reasons)


def test_a_container_filled_by_its_hull_fails(make) -> None:
    check = check_mesh(make(TRAY, [[(-0.06, -0.05, 0), (0.06, 0.05, 0.03)]], functional=[inside()]), seed=0)
    assert any("functional point 0 'inside'" in reason for reason in check.reasons)


def test_a_container_whose_mesh_has_a_lid_fails(make) -> None:
    lid = [(-0.06, -0.05, 0.03), (0.06, 0.05, 0.032)]
    check = check_mesh(make([*TRAY, lid], TRAY, functional=[inside()]), seed=0)
    assert any("the mesh covers it" in reason for reason in check.reasons)


@pytest.mark.parametrize("mass", [0.0002, 5.0])
def test_an_implausible_mass_fails(make, mass: float) -> None:
    check = check_mesh(make(CUBE, mass=mass), seed=0)
    assert any("kg/m³" in reason for reason in check.reasons)
