"""Answers of the stand-in server to structured questions: valid JSON from written tables, the schema and the prompt.

Nothing here calls our rules. A kind of question is a function, named in :data:`KINDS` under a field that its answers
alone have; what it means is written by hand in ``tables.yml`` where it depends on the instruction.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from tests.model_server.service import Refused
from vcage.models.structured import NONE

_HOLDERS = ("box", "plate", "tray", "bowl", "basket")


@dataclass(frozen=True)
class Asked:
    """A question: the fields of the answer's schema, the first prompt, and the pictures that came with it."""

    fields: dict[str, Any]
    prompt: str
    pictures: list[np.ndarray]

    def section(self, title: str) -> str:
        """The text below a title of the prompt."""
        return self.prompt.partition(f"# {title}\n")[2].partition("\n#")[0].strip().removeprefix("> ")


def answer_question(schema: dict[str, Any], prompt: str, pictures: list[np.ndarray]) -> dict[str, Any]:
    """A valid answer; which question it is shows in the schema's fields."""
    fields = schema["properties"]
    kind = next((field for field in KINDS if field in fields), None)
    if kind is None:
        raise Refused(400, f"the stand-in knows no question with the fields {', '.join(sorted(fields))}")
    return KINDS[kind](Asked(fields, prompt, pictures))


@cache
def _tables() -> dict[str, dict[str, Any]]:
    text = Path(__file__).with_name("tables.yml").read_text(encoding="utf-8")
    return yaml.load(text, Loader=yaml.BaseLoader)  # all are texts, "on" too


def written(instruction: str, *fields: str) -> dict[str, Any]:
    """The table of an instruction, which says at least one of these fields."""
    table = _tables().get(instruction, {})
    if not any(field in table for field in fields):
        raise Refused(400, f"tables.yml says neither {' nor '.join(fields)} of {instruction!r}")
    return table


# --- one function for each kind of question ------------------------------------------------------------


def select(asked: Asked) -> dict[str, Any]:
    """Which objects the task needs."""
    table = written(asked.section("The task"), "objects", "missing")
    chosen = {look: told if isinstance(told, list) else [told, NONE] for look, told in table.get("objects", {}).items()}
    objects = [
        {"look": look, "role": role, "starts_in": start, "starts_in_part": NONE, "reason": "written down"}
        for look, (role, start) in chosen.items()
    ]
    return {"missing": table.get("missing", []), "objects": objects}


def read(asked: Asked) -> dict[str, Any]:
    """Which goals the instruction means."""
    table = written(asked.section("The instruction"), "goals", "unread")
    ids = {phrase.strip(): name for name, phrase in _THING.findall(asked.section("The objects"))} | {"table": "table"}
    goals = [
        {
            "relation": relation,
            "subject": _named(subject, ids),
            "reference": _named(reference, ids),
            "part": NONE,
            "step": 1,
            "arm": NONE,
            "words": words,
        }
        for subject, relation, reference, words in table.get("goals", [])
    ]
    read = {"unread": table.get("unread", []), "wrong_objects": [], "goals": goals}
    return {**read, "descriptions": [], "untouched": []}


def review(asked: Asked) -> dict[str, Any]:
    """Find nothing that a reading lacks or adds, since it is written down."""
    return {"lacks": [], "adds": []}


_THING = re.compile(r"^- `([\w-]+)`: ([\w -]+)", re.MULTILINE)


def _named(told: str, ids: dict[str, str]) -> str:
    """The object that a table means."""
    found = [name for phrase, name in ids.items() if phrase == told or phrase.endswith(f" {told}")]
    if len(found) != 1:
        raise Refused(400, f"{told!r} of tables.yml is not one of {', '.join(ids)}")
    return found[0]


def arrange(asked: Asked) -> dict[str, Any]:
    """Where things stand: the receptacle in the middle, and the others around it."""
    ids = asked.fields["relations"]["items"]["properties"]["subject"]["enum"]
    roles = dict(_OBJECT.findall(asked.prompt))
    centre = next((i for i in ids if roles.get(i) == "receptacle"), ids[0])
    relations = [{"subject": centre, "relation": "center", "reference": "table"}]
    places = ("left_of", "right_of", "in_front_of", "behind")
    for index, other in enumerate(i for i in ids if i != centre):
        relations.append({"subject": other, "relation": places[index % 4], "reference": centre})
    return {"text": f"Everything stands around the {centre}.", "relations": relations}


_OBJECT = re.compile(r"^- `([\w-]+)`: .*?, role (\w+),", re.MULTILINE)


def judge_pairs(asked: Asked) -> dict[str, Any]:
    """Judge which things belong in or on others."""
    return {"pairs": [_pair(number, place) for number, place in _PAIR.findall(asked.prompt)]}


_PAIR = re.compile(r"^(\d+)\. Put the .+? \([^()]*\) (?:in|on) the (.+?) \(free", re.MULTILINE)


def _pair(number: str, place: str) -> dict[str, Any]:
    sensible = place.split()[-1] in _HOLDERS
    return {"number": int(number), "sensible": sensible, "reason": "it is a holder" if sensible else "no"}


def fill_slots(asked: Asked) -> dict[str, Any]:
    """Which grasp and place of each step; it has no opinion."""
    return {"steps": [_no_opinion(name) for name in _STEP.findall(asked.prompt)]}


_STEP = re.compile(r"^## \d+\. `([\w-]+)`:", re.MULTILINE)


def _no_opinion(subtask: str) -> dict[str, Any]:
    return {"subtask": subtask, "grasp": NONE, "place": NONE, "statements": [], "reason": "as it is ranked"}


def word_task(asked: Asked) -> dict[str, Any]:
    """How the task may be said: as the plain sentences of the prompt say it."""
    plain = asked.section("Sentences that say it").splitlines()
    return {"sentences": [{"sentence": line.removeprefix("- ")} for line in plain]}


def judge(asked: Asked) -> dict[str, Any]:
    """Call a sub-task done where something moved."""
    views = [picture for picture in asked.pictures if picture.shape == asked.pictures[0].shape]
    changed = len(views) > 1 and bool(np.abs(views[0].astype(int) - views[-1]).max() > 40)
    seen = "the pictures differ" if changed else "the pictures are the same"
    done, failure = ("yes", "none") if changed else ("no", "lost")
    return {"observations": seen, "done": done, "failure": failure, "also_moved": [], "reason": seen, "confidence": 0.8}


KINDS: dict[str, Callable[[Asked], dict[str, Any]]] = {
    "objects": select,
    "relations": arrange,
    "pairs": judge_pairs,
    "sentences": word_task,
    "steps": fill_slots,
    "goals": read,
    "lacks": review,
    "done": judge,
}
"""A field that only answers of this kind have → the function that answers it."""
