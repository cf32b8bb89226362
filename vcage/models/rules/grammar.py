"""The grammar of instructions, ``instruction.lark``: its forms, and the error for words that none of them has."""

from __future__ import annotations

import difflib
import functools
import re
from dataclasses import dataclass
from pathlib import Path

from lark import Lark

from vcage.base.errors import UnreadInstruction
from vcage.base.files import resource


@dataclass(frozen=True)
class Limits:
    """Limits on sentences.

    Args:
        words: of a sentence.
        readings: ways to read it that are tried.
    """

    words: int = 60
    readings: int = 200


LIMITS = Limits()

_GRAMMAR = Path(__file__).with_name("instruction.lark").read_text("utf-8").replace("~?", " *").replace("~", " +")
FORMS = tuple(re.findall(r"^// > (.+)$", _GRAMMAR, re.MULTILINE))
"""One sentence of each form."""


@functools.lru_cache(maxsize=1)
def grammar() -> Lark:
    """The parser, made once."""
    return Lark(_GRAMMAR, ambiguity="explicit", propagate_positions=True, maybe_placeholders=False)


def not_read(instruction: str, words: str, why: str) -> UnreadInstruction:
    """The error for unread words: the nearest known form, and the models that can read them.

    Args:
        instruction: as typed.
        words: of it, those that are not read; all of it where there are none.
        why: they are not.
    """
    verbs = _verbs(instruction)
    same = [form for form in FORMS if not verbs.isdisjoint(_verbs(form))] or FORMS
    near, *_ = difflib.get_close_matches(instruction, same, n=1, cutoff=0)
    words = words or instruction
    return UnreadInstruction(
        f"{words[:200]!r} in {instruction[:200]!r} is not understood: {why}",
        hint=f"write it like {near!r} (forms: {resource('docs', 'instructions.md')}), or let a model read it: "
        "--models agent, gemini, openai, anthropic or ollama",
        details={"unread": words, "understood": [], "form": near},
    )


def _verbs(text: str) -> set[str]:
    """The verbs in a text, by the names of the terminals that a form of sentence begins with."""
    starts = [word.start() for word in re.finditer(r"\b[a-z]", text.lower())]
    return {name for name, verb in _first_verbs().items() for at in starts if verb.match(text.lower(), at)}


@functools.cache
def _first_verbs() -> dict[str, re.Pattern[str]]:
    """The terminals that a form of sentence begins with, by name."""
    begin = {t.name: re.compile(t.pattern.to_regexp()) for t in grammar().terminals if t.name not in ("WORD", "_AND")}
    return {name: verb for name, verb in begin.items() if any(verb.match(form.lower()) for form in FORMS)}
