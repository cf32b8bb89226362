"""Nine of ten."""

from __future__ import annotations

import pytest

from vcage.apps.proof.tally import Tally


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
