"""Scenes that outcomes are made in: of templates, and of the sentences that ``benchmarks sentences`` runs."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from benchmarks._critic.outcome import Part
from benchmarks._sentences.sources import sentences, slug
from vcage.base.words import word_set
from vcage.stages import select_place

SCENES = {
    "bathroom": select_place.Options(template="bathroom"),
    "cabinet": select_place.Options(template="cabinet"),
    "cashier_desk": select_place.Options(template="cashier_desk"),
    "kitchen": select_place.Options(template="kitchen"),
    "office_desk": select_place.Options(template="office_desk"),
    "scale": select_place.Options(instruction="Weigh the tomato and the chocolate bar, then put them in the basket"),
}
"""Scenes of the outcomes: a template as it is, or the scene of an instruction."""

FURTHER = (
    "Stack the three blocks",
    "Put the egg in the pot",
    "Put the bowl on the microwave",
    "Push the plate next to the mug",
    "Pour the balls from the small bin into the dustbin",
    "Pour the balls from the ramekin into the plastic box",
    "Wipe the customer mat with the sponge",
    "Hit the rubber eraser with the hammer",
    "Hit the tissue box with the hammer",
    "Stand the bottle up",
    "Set the lying can upright",
    "Put the fallen bottle upright on the tray",
)
"""Sentences beside those that are run whole: piles, deep walls, tall tops, what can only be pushed, what is stood up,
and verbs of tools and vessels on kinds of objects that are untouched."""

UNTOUCHED_SCENES = ("bathroom", "office_desk")
"""Scenes kept unseen while a critic is tuned."""

SPLIT = "2026-11-26"
"""The day on which the untouched kinds of objects were drawn. Figures of an earlier day are of another split."""

SEEN_BY_TESTS = word_set(
    "alarm_clock apple bagel ball banana barcode_scanner block bottle bowl cabinet_one_drawer",
    "cabinet_three_drawers can cereal_box croissant cup electronic_scale hammer hinged_cabinet kitchen_timer",
    "laptop large_block mug mug_rack peg peg_block plate service_bell sponge stapler stapler_electric switch tap",
    "tray",
)
"""Kinds of objects that the unit tests of the offline critic show it: they count as looked at, in every scene."""


@dataclass(frozen=True)
class Draw:
    """A scene to make outcomes in.

    Args:
        scene: name, one of :func:`settings`.
        seed: of all choices.
        robot: by name.
        subtasks: number of sub-tasks to execute.
        part: the part of the outcomes to make: the one for tuning, the other, or ``all``.
        templates: kinds of sub-tasks that are carried out; any where none is named.
    """

    scene: str
    seed: int
    robot: str
    subtasks: int
    part: str = "all"
    templates: tuple[str, ...] = ()


@cache
def settings() -> Mapping[str, select_place.Options]:
    """All that a scene is made from, by name: :data:`SCENES`, then one for each sentence."""
    texts = dict.fromkeys([*(sentence.text for sentence in sentences()), *FURTHER])
    return SCENES | {slug(text): select_place.Options(instruction=text) for text in texts}


def part_of(scene: str, asset: str) -> Part:
    """Tell "tuning" from "untouched" outcomes; the latter are kept unseen while a critic is tuned.

    Untouched are about half of the kinds of objects that no unit test shows the critic, and all of these in
    :data:`UNTOUCHED_SCENES`.
    """
    if asset in SEEN_BY_TESTS:
        return "tuning"
    drawn = hashlib.sha256(f"{SPLIT} {asset}".encode()).digest()[0] % 2
    return "untouched" if scene in UNTOUCHED_SCENES or drawn else "tuning"
