"""What the stand-in server answers to structured questions: valid JSON from the schema and the prompt alone."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from vcage.base.errors import NoAssetFits
from vcage.models.rules.chain import compose_chain
from vcage.models.rules.selection import select_assets
from vcage.models.rules.words import COLOURS
from vcage.schema.asset import CatalogueEntry, Variant, Words
from vcage.schema.subtasks import ChainOption

_HOLDERS = ("box", "plate", "tray", "bowl", "basket")


def answer_question(schema: dict[str, Any], prompt: str, pictures: list[np.ndarray]) -> dict[str, Any]:
    """A valid answer; which question it is shows in the schema's fields."""
    fields = schema["properties"]
    if "objects" in fields:
        return _select(fields["objects"]["items"]["properties"]["look"]["enum"], _section(prompt, "The task"))
    if "relations" in fields:
        return _arrange(fields["relations"]["items"]["properties"]["subject"]["enum"], prompt)
    if "pairs" in fields:
        return {"pairs": [_pair(*found) for found in _PAIR.findall(prompt)]}
    if "chain" in fields:
        options = [_option(*found) for found in _OPTION.findall(prompt)]
        return {"reason": "in order", "chain": compose_chain(_section(prompt, "The task"), options)}
    changed = len(pictures) > 1 and bool(np.abs(pictures[0].astype(int) - pictures[-1]).max() > 40)
    seen = "the pictures differ" if changed else "the pictures are the same"
    return {"observations": seen, "accepted": changed, "reason": seen, "confidence": 0.8}


_PAIR = re.compile(r"^(\d+)\. Put the (.+?) \([^()]*\) (?:in|on) the (.+?) \(free", re.MULTILINE)
_OPTION = re.compile(r"^- `([\w-]+)`: (.+?) \(moves `([\w-]+)` to `([\w-]+)`\)", re.MULTILINE)
_SENTENCE = re.compile(r"Put the (.+?) (?:into|onto) the (.+)\.")
_OBJECT = re.compile(r"^- `([\w-]+)`: .*?, role (\w+),", re.MULTILINE)


def _section(prompt: str, title: str) -> str:
    return prompt.partition(f"# {title}\n")[2].partition("\n#")[0].strip()


def _select(looks: list[str], instruction: str) -> dict[str, Any]:
    variants: dict[str, list[Variant]] = {}
    for look in looks:
        asset, _, variant = look.partition("/")
        variants.setdefault(asset, []).append(Variant(id=variant, colour=variant))
    catalogue = [
        CatalogueEntry(name=asset, words=_words(asset.replace("_", " ")), variants=found, size=(0.05, 0.05, 0.05))
        for asset, found in variants.items()
    ]
    try:
        chosen = select_assets(instruction, catalogue, np.random.default_rng(0)).objects
    except NoAssetFits as error:
        return {"missing": error.details.get("unmatched", [instruction]), "objects": []}
    return {
        "missing": [],
        "objects": [
            {"look": f"{o.asset}/{o.variant}", "role": o.role, "starts_in": o.starts_in or "", "reason": o.reason}
            for o in chosen
        ],
    }


def _words(name: str) -> Words:
    return Words(name=name, plural=f"{name}s", description=name, category="thing")


def _option(name: str, text: str, thing: str, place: str) -> ChainOption:
    sentence = _SENTENCE.fullmatch(text)
    if sentence is None:
        raise ValueError(f"not a sentence of the stand-in: {text!r}")
    thing_kind, place_kind = (_kind(words) for words in sentence.groups())
    return ChainOption(
        id=name, text=text, object=thing, receptacle=place, object_kind=thing_kind, receptacle_kind=place_kind
    )


def _kind(phrase: str) -> CatalogueEntry:
    """What a phrase of a scene says of its object: 'red block'."""
    name = " ".join(word for word in phrase.split() if word not in COLOURS) or phrase
    look = Variant(id="look", colour=phrase)
    return CatalogueEntry(name=name.replace(" ", "_"), words=_words(name), variants=[look], size=(0.05, 0.05, 0.05))


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
    text = f"Put the {thing} into the {place}." if sensible else ""
    return {"number": int(number), "sensible": sensible, "reason": "it is a holder" if sensible else "no", "text": text}
