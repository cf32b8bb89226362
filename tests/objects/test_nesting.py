"""How deep containers stand in each other."""

from __future__ import annotations

import pytest

from tests.example_scenes import library
from vcage.objects.asset import Asset


def nested(content: str, holder: str) -> float | None:
    inner, outer = library().asset(content), library().asset(holder)
    return outer.nested_height(inner, outer.annotation.functional_point(0))


def rim(holder: str) -> float:
    asset: Asset = library().asset(holder)
    return asset.opening(asset.annotation.functional_point(0)).rim


@pytest.mark.parametrize(("content", "holder"), [("bowl", "bowl"), ("small_bowl", "small_bowl"), ("cup", "cup")])
def test_a_bowl_stands_in_one_of_its_kind_between_floor_and_rim(content: str, holder: str) -> None:
    asset = library().asset(holder)
    bottom = nested(content, holder)
    assert bottom is not None
    assert asset.opening(asset.annotation.functional_point(0)).floor < bottom < rim(holder) - 0.01


def test_a_bowl_of_a_pot_s_width_stands_on_its_floor() -> None:
    asset = library().asset("pot")
    assert nested("small_bowl", "pot") == pytest.approx(asset.opening(asset.annotation.functional_point(0)).floor)


@pytest.mark.parametrize("holder", ["ramekin", "cup"])
def test_a_bowl_that_would_lie_across_a_rim_does_not_nest(holder: str) -> None:
    assert nested("bowl", holder) is None


@pytest.mark.parametrize("content", ["apple", "lemon", "packaging_box"])
def test_only_round_containers_nest(content: str) -> None:
    assert nested(content, "bowl") is None
