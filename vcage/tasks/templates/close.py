"""Close: what is open is closed, along the true arc or line of its joint."""

from __future__ import annotations

from vcage.tasks.templates.operated import Operated

CLOSE = Operated(
    name="close",
    action="open",
    word="closed",
    start=lambda joint: joint.far_end,
    target=lambda _: 0.0,
    opposite="open",
)
