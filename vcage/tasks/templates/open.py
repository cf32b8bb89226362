"""Open: a drawer, door, lid or screen is opened as far as it goes, along the true arc or line of its joint."""

from __future__ import annotations

from vcage.tasks.templates.operated import Operated

OPEN = Operated(
    name="open",
    action="open",
    word="open",
    opposite="closed",
)
