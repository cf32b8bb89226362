"""How high and how long arms hold up what they still hold at the end."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class HoldingSettings:
    """Settings of one arm, and of both.

    Args:
        lift_m: height over its place to which an object is lifted.
        clear_m: least height over the table of what one arm holds, also where it turns between the fingers.
        held_s: time for which it is then watched, seconds.
    """

    lift_m: float = 0.1
    clear_m: float = 0.06
    held_s: float = 0.5


SETTINGS = HoldingSettings()
