from __future__ import annotations

import time

import pytest

from vcage.base.time_limit import TimeLimitReached, time_limit, undisturbed


def test_slow_code_is_interrupted_past_every_error_handler():
    with pytest.raises(TimeLimitReached), time_limit(0.05):
        while True:
            try:
                time.sleep(0.01)
            except Exception:
                continue


def test_fast_code_is_not_interrupted():
    with time_limit(0.2):
        pass
    time.sleep(0.3)


def test_undisturbed_work_finishes_within_its_time():
    done = []
    with pytest.raises(TimeLimitReached), time_limit(0.05):
        with undisturbed(), undisturbed():
            time.sleep(0.1)
            done.append("inside")
        done.append("after")
    assert done == ["inside"]


def test_a_time_that_was_up_is_not_held_against_the_next():
    with pytest.raises(TimeLimitReached), time_limit(0.05), undisturbed():
        time.sleep(0.1)
    with time_limit(5.0), undisturbed():
        pass


def test_an_error_that_the_interruption_was_taken_for_is_the_time_being_up():
    with pytest.raises(TimeLimitReached), time_limit(0.05):
        try:
            time.sleep(1.0)
        except TimeLimitReached:
            raise TypeError("incompatible arguments") from None  # as a binding does while it converts them


def test_an_error_before_the_time_is_up_is_itself():
    with pytest.raises(TypeError), time_limit(5.0):
        raise TypeError("incompatible arguments")


def test_an_interruption_that_was_swallowed_is_followed_by_another():
    with pytest.raises(TimeLimitReached), time_limit(0.05):
        while True:
            try:
                time.sleep(5.0)
            except TimeLimitReached:
                break
        time.sleep(5.0)
