"""Turn: a dial or lever is turned as far as it goes, around its own axis."""

from __future__ import annotations

from vcage.tasks.templates.operated import Operated

TURN = Operated(
    name="turn",
    action="turn",
    word="turned",
    start=lambda _: 0.0,
    target=lambda joint: joint.far_end,
)
