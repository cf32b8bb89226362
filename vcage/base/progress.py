"""Progress of long work, as a callback; the caller decides how to show it."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str, int, int], None]
"""Called before each step of a job with the step's name, its number from 0, and how many there are."""


def silent(_step: str, _number: int, _total: int) -> None:
    """Show nothing."""
