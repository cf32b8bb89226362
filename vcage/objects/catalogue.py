"""The catalogue as text, one compact line per kind, which a prompt and a person read; and in numbers."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable
from typing import Any

from vcage.base.text import one_line
from vcage.schema.asset import Annotation, CatalogueEntry, FunctionalPoint
from vcage.schema.base import Point3

LEGEND = (
    "name = what it is (category; scenes); size class and size in cm; what can be done with it, with the room in cm "
    "for what is put in or on it; looks"
)
"""What the parts of a line are."""

UNBUILT = "not built yet"
"""In place of a size."""

SCENES = ("kitchen", "bathroom", "office_desk", "cashier_desk", "cabinet")
"""The scenes of the paper's experiments, as the annotations' scene tags call them."""


def catalogue_text(entries: Iterable[CatalogueEntry]) -> str:
    """One line per kind: name, description, other names, where it belongs, size, points and looks."""
    return "\n".join(catalogue_line(entry) for entry in entries)


def catalogue_line(entry: CatalogueEntry) -> str:
    """The line of one kind; see :data:`LEGEND`."""
    words = entry.words
    size = f"{size_class(entry)} {'x'.join(f'{100 * edge:.0f}' for edge in entry.size)}" if any(entry.size) else UNBUILT
    kind = "; ".join([words.category, *([",".join(words.scene_tags)] if words.scene_tags else [])])
    looks = ", ".join(_look(variant.id, variant.colour) for variant in entry.variants)
    looks += ", any colour" if entry.any_colour else ""
    return one_line(f"- {entry.name} = {_called(entry)} ({kind}); {size}; {_abilities(entry)}; {looks}")


def size_class(entry: CatalogueEntry) -> str:
    """'tiny', 'small', 'medium' or 'large' by the longest edge: up to 6, 12, 20 cm, and beyond."""
    longest = max(entry.size)
    return next(
        (word for word, limit in (("tiny", 0.06), ("small", 0.12), ("medium", 0.20)) if longest <= limit), "large"
    )


def _called(entry: CatalogueEntry) -> str:
    """The description, after the name where the identifier does not say it, and names that add a word."""
    words = entry.words
    known = set(_parts(entry.name))
    parts = []
    for name in (words.name, *words.synonyms):
        if not set(_parts(name)) <= known:
            parts.append(name)
            known |= set(_parts(name))
    return ": ".join([*([", ".join(parts)] if parts else []), words.description.rstrip(".")])


def _parts(text: str) -> list[str]:
    return re.findall(r"[a-z0-9]+", text.lower())


def _look(variant: str, colour: str) -> str:
    return variant if set(_parts(variant)) == set(_parts(colour)) else f"{variant} ({colour})"


def _abilities(entry: CatalogueEntry) -> str:
    """'graspable, holds in 21.2x12.2x6.3 and on 13.3x13.3': the inner size of each place, its drawer or lid named."""
    rooms = {room.point: room.size for room in entry.rooms}
    places = Counter(_place(point, rooms.get(point.id)) for point in entry.functional_points)
    holds = [place if number == 1 else f"{place} (x{number})" for place, number in places.items()]
    grasp = "graspable" if entry.can_be_carried else "not graspable"
    return f"{grasp}, holds {' and '.join(holds)}" if holds else grasp


def _place(point: FunctionalPoint, room: Point3 | None) -> str:
    """'in drawer_top 21.2x12.2x6.3': an open top has no height."""
    size = "" if room is None else "x".join(f"{100 * edge:.1f}" for edge in room if edge)
    return " ".join(word for word in (point.holds, point.part or "", size) if word)


def count_kinds(annotations: Iterable[Annotation]) -> dict[str, Any]:
    """Count kinds and variants, and kinds per scene and per source."""
    annotations = list(annotations)
    tags = Counter(tag for annotation in annotations for tag in set(annotation.words.scene_tags))
    return {
        "kinds": len(annotations),
        "variants": sum(len(annotation.variants) for annotation in annotations),
        "scenes": {scene: tags[scene] for scene in SCENES},
        "sources": dict(sorted(Counter(annotation.source for annotation in annotations).items())),
    }
