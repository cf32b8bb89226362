"""Press: a button is pushed in with closed fingers, and comes back by itself."""

from __future__ import annotations

from vcage.tasks.templates.operated import Operated

PRESS = Operated(
    name="press",
    action="press",
    word="pressed",
)
