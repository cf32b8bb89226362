"""Goals stated in a small grammar, in place of an instruction for a reasoner; names are resolved in a scene later.

A goal is ``SUBJECT WORD [REFERENCE] [with the left|right arm]``, as in ``marker/red inside packaging_box``. It belongs
to the step of the goal before it, or begins with ``then`` and belongs to the next one.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import get_args

from vcage.base.errors import UnknownName, UsageError
from vcage.base.text import listed, one_line
from vcage.goals import KINDS, words
from vcage.schema.goals import RelationWord
from vcage.schema.plan import TABLE
from vcage.schema.scene import MOST_OF_A_KIND

START_WORDS: tuple[str, ...] = get_args(RelationWord)
OF_THE_TABLE = ("center", "left_of", "right_of", "in_front_of", "behind")
"""Words of start conditions that may refer to the table: its middle third, or an outer one."""

FORMS = "write it like 'marker/red inside packaging_box', 'cabinet_one_drawer/drawer open' or 'chocolate_bar scanned'"

_NAME = r"[a-z0-9][a-z0-9_-]*"
_PATH = re.compile(rf"{_NAME}(?:/{_NAME}){{0,2}}")
_ARM = re.compile(rf"(.*) with the ({_NAME}) arm")
_OBJECT = re.compile(rf"(?:(\d{{1,4}}) )?({_NAME}(?:/{_NAME})?)")
_LONGEST_SHOWN = 80


@dataclass(frozen=True)
class StatedGoal:
    """A goal or a start condition as it was written.

    Args:
        text: all of it.
        subject: names an object, and for ``open``, ``closed``, ``pressed`` and ``turned`` also a part of it.
        word: to become true of it.
        reference: names another object and maybe a part of it, ``table``, or an arm; None where the word takes none.
        step: 1 for the first goals, and one more from each goal that begins with ``then``.
        arm: that must do it; None for any.
    """

    text: str
    subject: str
    word: str
    reference: str | None
    step: int = 1
    arm: str | None = None

    @property
    def names(self) -> list[tuple[str, bool]]:
        """Return the names of objects, the subject first, each with True if it may end with a part."""
        found = [(self.subject, self.word in KINDS and KINDS[self.word].acts_on is not None)]
        if self.reference is not None and self.reference != TABLE and not _names_an_arm(self.word):
            found.append((self.reference, self.word in ("inside", "on")))
        return found


@dataclass(frozen=True)
class StatedTask:
    """A task that is stated without an instruction.

    Args:
        goals: in their order; not empty.
        starts: conditions on where things are at the start.
        objects: (number, name) of the objects of the scene; None if they follow from the goals.
    """

    goals: tuple[StatedGoal, ...]
    starts: tuple[StatedGoal, ...]
    objects: tuple[tuple[int, str], ...] | None

    @classmethod
    def of(cls, goals: Sequence[str], starts: Sequence[str], objects: str | None) -> StatedTask | None:
        """Parse the options; None if they are empty.

        Raises:
            UsageError: a text breaks the grammar, or starts or objects come without goals.
            UnknownName: a word is not one of the grammar.
        """
        if not goals:
            if starts or objects is not None:
                option = "--start" if starts else "--objects"
                raise UsageError(f"{option} needs goals", hint="add --goal")
            return None
        conditions = tuple(_start(text) for text in map(_tidy, starts))
        counted = None if objects is None else tuple(_objects(objects))
        return cls(tuple(_goals([_tidy(goal) for goal in goals])), conditions, counted)

    def record(self) -> dict[str, list[str]]:
        """Return the fields for provenance: the goals, and the rest if it is stated."""
        found = {"goals": [one.text for one in self.goals], "starts": [one.text for one in self.starts]}
        found["objects"] = [f"{count} {name}" for count, name in self.objects or ()]
        return {name: texts for name, texts in found.items() if texts}


def _tidy(text: str) -> str:
    return " ".join(text.split())


def _goals(texts: Sequence[str]) -> Iterator[StatedGoal]:
    step = 1
    for number, text in enumerate(texts):
        rest = text
        if text.startswith("then "):
            if number == 0:
                raise UsageError(f"the first goal, {shortened(text)}, has none before it", hint="leave out 'then'")
            step, rest = step + 1, text.removeprefix("then ")
        arm = _ARM.fullmatch(rest)
        subject, word, reference = _parts(text, arm[1] if arm else rest, "goal", words())
        if arm and _names_an_arm(word):
            raise UsageError(f"the goal {shortened(text)} names two arms", hint="leave out 'with the … arm'")
        yield StatedGoal(text, subject, word, reference, step, arm[2] if arm else None)


def _start(text: str) -> StatedGoal:
    subject, word, reference = _parts(text, text, "start condition", START_WORDS)
    if reference == TABLE and word not in OF_THE_TABLE:
        raise UsageError(f"{shortened(text)}: only {listed(OF_THE_TABLE)} can be stated of the table")
    if word == "center" and reference != TABLE:
        raise UsageError(f"{shortened(text)}: 'center' is of the table alone")
    return StatedGoal(text, subject, word, reference)


def _parts(text: str, sentence: str, what: str, known: Collection[str]) -> tuple[str, str, str | None]:
    """Return subject, word and reference of a text without its step and arm."""
    parts = sentence.split(" ")
    if len(parts) not in (2, 3):
        raise UsageError(f"{shortened(text)} is no {what}", hint=FORMS)
    (subject, word), reference = parts[:2], parts[2] if len(parts) == 3 else None
    for name in (subject, *([reference] if reference else [])):
        if not _PATH.fullmatch(name):
            raise UsageError(f"{shortened(text)} is no {what}: {shortened(name)} is no name", hint=FORMS)
    if word not in known:
        raise UnknownName(f"word in the {what} {shortened(text)}:", word[:_LONGEST_SHOWN], known)
    takes = what != "goal" or KINDS[word].refers_to is not None
    if takes != bool(reference):
        raise UsageError(f"{shortened(text)}: {word!r} takes {'a' if takes else 'no'} reference", hint=FORMS)
    return subject, word, reference


def _names_an_arm(word: str) -> bool:
    return word in KINDS and KINDS[word].refers_to == "arm"


def _objects(text: str) -> Iterator[tuple[int, str]]:
    for one in text.split(","):
        found = _OBJECT.fullmatch(_tidy(one))
        if found is None:
            raise UsageError(
                f"--objects: {shortened(_tidy(one))} is no object",
                hint="write it like 'marker/red, packaging_box, 2 apple'",
            )
        count = int(found[1] or 1)
        if not 1 <= count <= MOST_OF_A_KIND:
            raise UsageError(f"--objects: {found[0]!r} asks for {count}; 1 to {MOST_OF_A_KIND} can be asked for")
        yield count, found[2]


def shortened(text: str) -> str:
    """Quote a text in one line, shortened if it is long."""
    text = one_line(text)
    return repr(text if len(text) <= _LONGEST_SHOWN else f"{text[:_LONGEST_SHOWN]}…")
