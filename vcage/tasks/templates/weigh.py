"""Weigh: an object is put on an otherwise empty scale, and lies still there for a second."""

from __future__ import annotations

from vcage.tasks.templates.place import Placing

STILL = 1.0
"""Time for which it lies there alone, seconds."""

WEIGH = Placing("weigh", takes=lambda _target, _scale, point: point.weighs, word="weighed", waits=STILL)
