"""TrialPlaces and tries of a single object: nine of ten must succeed."""

from __future__ import annotations

import numpy as np
import pytest

from tests.apps.proof.conftest import CUBE, contact
from vcage.apps.proof.trials import tried
from vcage.base.errors import InfeasibleScene


@pytest.mark.parametrize(("tries", "failures", "passed"), [(10, 0, True), (10, 1, True), (10, 2, False), (3, 1, True)])
def test_one_failure_is_allowed(tries: int, failures: int, passed: bool) -> None:
    check = tried("joint", "lid", tries, lambda number: "slipped" if number < failures else None, {})
    assert check.passed is passed
    assert (check.tries, check.succeeded) == (tries, tries - failures)


def test_a_single_try_that_fails_is_no_proof() -> None:
    assert not tried("joint", "lid", 1, lambda _: "slipped", {}).passed


def test_a_reason_is_reported_once() -> None:
    reasons = ("slipped", "slipped", "tipped")
    assert tried("joint", "lid", 3, lambda number: reasons[number], {}).reasons == ["slipped", "tipped"]


def test_a_try_without_a_place_has_failed() -> None:
    def nowhere(_number: int) -> None:
        raise InfeasibleScene("no arm reaches it")

    assert tried("joint", "lid", 3, nowhere, {}).reasons == ["no arm reaches it"]


def test_places_for_an_approach_from_the_side_face_the_robot(make, places) -> None:
    asset, rng = make(CUBE), np.random.default_rng(0)
    side = contact(approach=(1, 0, 0), closing=(0, 1, 0))
    for _ in range(20):
        pose = places.for_carrying(asset, side, rng)
        assert pose.rotation()[:, 0] @ (0, 1, 0) > np.cos(np.radians(31))
