"""Close: an open part is closed, along the true arc or line of its joint."""

from __future__ import annotations

from vcage.tasks.templates.operated import Operated

CLOSE = Operated(
    name="close",
    action="open",
    word="closed",
    closes=True,
    opposite="open",
)
