"""Stack: an object is put on another whose top it fills, edge on edge."""

from __future__ import annotations

from vcage.tasks.slots import stands_flush
from vcage.tasks.templates.place import Placing

STACK = Placing("stack", takes=stands_flush)
