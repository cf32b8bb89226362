"""How long work tells what it is doing; whoever runs it decides how that is shown."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str, int, int], None]
"""Called before each step of a job with the step's name, its number from 0, and how many there are."""


def silent(_step: str, _number: int, _total: int) -> None:
    """Show nothing."""
