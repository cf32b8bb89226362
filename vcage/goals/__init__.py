"""Kinds of goals, one file each: word, meaning for the planner, truth in the simulator, wordings, evidence for critics.

A new kind is a file here, and its name in :data:`KINDS`. The package stands low, so that every other may ask a kind; a
kind asks the simulator through :class:`vcage.goals.kind.State`.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from inspect import cleandoc

from vcage.goals.back import BACK
from vcage.goals.beside import BESIDE
from vcage.goals.centred import CENTRED
from vcage.goals.closed import CLOSED
from vcage.goals.facing_robot import FACING_ROBOT
from vcage.goals.handed import HANDED
from vcage.goals.held_by_both import HELD_BY_BOTH
from vcage.goals.held_up import HELD_UP
from vcage.goals.hit import HIT
from vcage.goals.hung_on import HUNG_ON
from vcage.goals.in_place_of import IN_PLACE_OF
from vcage.goals.inserted_in import INSERTED_IN
from vcage.goals.inside import INSIDE
from vcage.goals.kind import TABLE, GoalKind, Stated
from vcage.goals.lifted import LIFTED
from vcage.goals.moved_away import MOVED_AWAY
from vcage.goals.near import NEAR
from vcage.goals.on import ON, ON_TABLE
from vcage.goals.open import OPEN
from vcage.goals.poured import POURED
from vcage.goals.presented import PRESENTED
from vcage.goals.pressed import PRESSED
from vcage.goals.row_left_of import ROW_LEFT_OF
from vcage.goals.scanned import SCANNED
from vcage.goals.shaken import SHAKEN
from vcage.goals.sides import SIDES
from vcage.goals.thresholds import Thresholds
from vcage.goals.turned import TURNED
from vcage.goals.turned_back import TURNED_BACK
from vcage.goals.upright import UPRIGHT
from vcage.goals.weighed import WEIGHED
from vcage.goals.wiped import WIPED

KINDS: dict[str, GoalKind] = {
    kind.word: kind
    for kind in (
        INSIDE, ON, *SIDES, ROW_LEFT_OF, IN_PLACE_OF, BESIDE, NEAR, CENTRED, OPEN, CLOSED, PRESSED, TURNED, TURNED_BACK,
        HELD_UP, HELD_BY_BOTH, SCANNED, WEIGHED, PRESENTED, BACK, MOVED_AWAY, FACING_ROBOT, HANDED, LIFTED, SHAKEN,
        HIT, WIPED, POURED, UPRIGHT, HUNG_ON, INSERTED_IN,
    )
}  # fmt: skip
"""By word, in the order in which prompts explain them."""

PROMPT_WIDTH = 120
"""Columns of a prompt's lines."""


def words() -> list[str]:
    """The words of all kinds: first the states, then the events."""
    return sorted(KINDS, key=lambda word: KINDS[word].event)


def kind_of(goal: Stated) -> GoalKind:
    """The kind of a goal; of the table ``on`` has a meaning of its own."""
    return ON_TABLE if goal.reference == TABLE else KINDS[goal.relation]


def meanings(goals: Iterable[Stated], limits: Thresholds) -> list[list[str]]:
    """The meanings of the words of some goals, each once: lines of a prompt."""
    order = list(KINDS)
    kinds = sorted(map(kind_of, goals), key=lambda kind: order.index(kind.word))
    return [cleandoc(text).split("\n") for text in dict.fromkeys(kind.meaning(limits) for kind in kinds)]


def forms() -> list[list[str]]:
    """Words and fields of all kinds of goals, the words of one form together: lines of a prompt."""
    of_form: dict[str, list[str]] = {}
    for kind in KINDS.values():
        of_form.setdefault(kind.listed, []).append(f"`{kind.word}`{kind.gloss}")
    texts = [f"{', '.join(named)}: {fields}" for fields, named in of_form.items()]
    return [textwrap.wrap(text, PROMPT_WIDTH, break_long_words=False, break_on_hyphens=False) for text in texts]


def written_forms() -> str:
    """The forms of stated goals, each with its words, as in ``SUBJECT inside|on REFERENCE[/PART]``."""
    of_form: dict[str, list[str]] = {}
    for word in words():
        of_form.setdefault(KINDS[word].form, []).append(word)
    return "; ".join(form.format("|".join(named)) for form, named in of_form.items())
