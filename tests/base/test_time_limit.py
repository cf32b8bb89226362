from __future__ import annotations

import time

import pytest

from vcage.base.time_limit import TimeIsUp, time_limit


def test_what_takes_too_long_is_interrupted_past_every_handler_of_errors():
    with pytest.raises(TimeIsUp), time_limit(0.05):
        while True:
            try:
                time.sleep(0.01)
            except Exception:
                continue


def test_what_is_quick_enough_is_not_interrupted():
    with time_limit(0.2):
        pass
    time.sleep(0.3)
