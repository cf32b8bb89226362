"""What the stand-in server answers to structured questions: valid JSON from the schema and the prompt alone."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from vcage.base.errors import NoAssetFits, UnreadInstruction
from vcage.models.rules.goals import read_goals
from vcage.models.rules.selection import select_assets
from vcage.models.structured import NONE
from vcage.schema.asset import CatalogueEntry, ContactPoint, FunctionalPoint, Variant, Words

_HOLDERS = ("box", "plate", "tray", "bowl", "basket")


def answer_question(schema: dict[str, Any], prompt: str, pictures: list[np.ndarray]) -> dict[str, Any]:
    """A valid answer; which question it is shows in the schema's fields."""
    fields = schema["properties"]
    if "objects" in fields:
        return _select(_section(prompt, "The catalogue"), _section(prompt, "The task"))
    if "relations" in fields:
        return _arrange(fields["relations"]["items"]["properties"]["subject"]["enum"], prompt)
    if "pairs" in fields:
        return {"pairs": [_pair(*found) for found in _PAIR.findall(prompt)]}
    if "goals" in fields:
        return _read(_section(prompt, "The instruction"), prompt)
    views = [picture for picture in pictures if picture.shape == pictures[0].shape]
    changed = len(views) > 1 and bool(np.abs(views[0].astype(int) - views[-1]).max() > 40)
    seen = "the pictures differ" if changed else "the pictures are the same"
    done, failure = ("yes", "none") if changed else ("no", "lost")
    said = {"observations": seen, "done": done, "failure": failure, "also_moved": []}
    return {**said, "reason": seen, "confidence": 0.8}


_PAIR = re.compile(r"^(\d+)\. Put the (.+?) \([^()]*\) (?:in|on) the (.+?) \(free", re.MULTILINE)
_THING = re.compile(r"^- `([\w-]+)`: (.+?)(?: \(also: (.+?)\))?(?:; .*?things go (in|on) it.*)?$", re.MULTILINE)
_KIND = re.compile(r"^- ([\w-]+) = .*; ([^;]+)$", re.MULTILINE)
_OBJECT = re.compile(r"^- `([\w-]+)`: .*?, role (\w+),", re.MULTILINE)


def _section(prompt: str, title: str) -> str:
    return prompt.partition(f"# {title}\n")[2].partition("\n#")[0].strip()


def _select(listed: str, instruction: str) -> dict[str, Any]:
    variants: dict[str, list[Variant]] = {}
    for asset, looks in _KIND.findall(listed):
        names = [look.partition(" (")[0] for look in looks.split(", ")]
        variants[asset] = [Variant(id=name, colour=name) for name in names]
    catalogue = [
        CatalogueEntry(name=asset, words=_words(asset.replace("_", " ")), variants=found, size=(0.05, 0.05, 0.05))
        for asset, found in variants.items()
    ]
    try:
        chosen = select_assets(instruction, catalogue, np.random.default_rng(0)).objects
    except (NoAssetFits, UnreadInstruction) as error:
        return {"missing": error.details.get("unmatched", [instruction]), "objects": []}
    return {
        "missing": [],
        "objects": [
            {"look": f"{o.asset}/{o.variant}", "role": o.role, "starts_in": o.starts_in or NONE, "reason": o.reason}
            for o in chosen
        ],
    }


def _words(name: str) -> Words:
    return Words(name=name, plural=f"{name}s", description=name, category="thing")


def _read(instruction: str, prompt: str) -> dict[str, Any]:
    """The goals as the rules read them among the things that the prompt lists."""
    things = {name: _thing(*found) for name, *found in _THING.findall(_section(prompt, "The objects"))}
    try:
        found = read_goals(instruction, things)
    except UnreadInstruction as error:
        return {"unread": [error.details["unread"]], "goals": [], "untouched": []}
    goals = [
        {
            "relation": asked.goal.relation,
            "subject": asked.goal.subject,
            "reference": asked.goal.reference or NONE,
            "part": asked.goal.part or NONE,
            "step": asked.step,
            "words": asked.words,
        }
        for asked in found.goals
    ]
    return {"unread": [], "goals": goals, "untouched": found.untouched}


def _thing(phrase: str, synonyms: str, holds: str) -> CatalogueEntry:
    colour, _, name = phrase.partition(" ")
    words = _words(name or phrase).model_copy(update={"synonyms": [s for s in synonyms.split(", ") if s]})
    contact = ContactPoint(id=0, name="middle", position=(0, 0, 0.02), approach=(0, 0, -1), closing=(1, 0, 0))
    points = [FunctionalPoint(id=0, name="floor", holds=holds, position=(0, 0, 0.005))] if holds else []
    return CatalogueEntry(
        name=(name or phrase).replace(" ", "_"),
        words=words,
        variants=[Variant(id="look", colour=colour)],
        size=(0.05, 0.05, 0.05),
        contact_points=[contact],
        functional_points=points,
    )


def _arrange(ids: list[str], prompt: str) -> dict[str, Any]:
    roles = dict(_OBJECT.findall(prompt))
    centre = next((i for i in ids if roles.get(i) == "receptacle"), ids[0])
    relations = [{"subject": centre, "relation": "center", "reference": "table"}]
    places = ("left_of", "right_of", "in_front_of", "behind")
    for index, other in enumerate(i for i in ids if i != centre):
        relations.append({"subject": other, "relation": places[index % 4], "reference": centre})
    return {"text": f"Everything stands around the {centre}.", "relations": relations}


def _pair(number: str, thing: str, place: str) -> dict[str, Any]:
    sensible = place.split()[-1] in _HOLDERS
    return {"number": int(number), "sensible": sensible, "reason": "it is a holder" if sensible else "no"}
