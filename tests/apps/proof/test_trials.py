"""TrialPlaces and tries of a single object: nine of ten must succeed."""

from __future__ import annotations

import numpy as np
import pytest

from tests.apps.proof.conftest import CUBE, contact
from vcage.apps.proof.trials import Tally


@pytest.mark.parametrize(("tries", "failures", "passed"), [(10, 0, True), (10, 1, True), (10, 2, False), (3, 1, True)])
def test_one_failure_is_allowed(tries: int, failures: int, passed: bool) -> None:
    tally = Tally(tries)
    for number in range(tries):
        tally.add("slipped" if number < failures else None)
    check = tally.check("joint", "lid")
    assert check.passed is passed
    assert (check.tries, check.succeeded) == (tries, tries - failures)


def test_a_single_try_that_fails_is_no_proof() -> None:
    tally = Tally(1)
    tally.add("slipped")
    assert not tally.check("joint", "lid").passed


def test_a_reason_is_told_once() -> None:
    tally = Tally(3)
    for reason in ("slipped", "slipped", "tipped"):
        tally.add(reason)
    assert tally.check("joint", "lid").reasons == ["slipped", "tipped"]


def test_places_for_an_approach_from_the_side_face_the_robot(make, places) -> None:
    asset, rng = make(CUBE), np.random.default_rng(0)
    side = contact(approach=(1, 0, 0), closing=(0, 1, 0))
    for _ in range(20):
        pose = places.for_carrying(asset, side, rng)
        assert pose.rotation()[:, 0] @ (0, 1, 0) > np.cos(np.radians(31))
