from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from tests.models.catalogue import CATALOGUE, KITCHEN, entry
from tests.models.tabletop import BLOCKS, BOX, ERASER, MARKERS, PLATE, scene_of
from vcage.base.errors import ModelRefused
from vcage.models.rules.reasoner import TRIES, OfflineReasoner
from vcage.plans.check import plan_complaints
from vcage.schema.asset import CatalogueEntry
from vcage.schema.plan import LayoutPlan, Relation, Selection
from vcage.schema.subtasks import ChainOption, PairQuestion

REASONER = OfflineReasoner()


@pytest.mark.parametrize("seed", range(5))
def test_a_layout_holds_every_object_and_no_contradiction(seed: int) -> None:
    scene = scene_of([BOX, *MARKERS, ERASER.moved(role="context"), PLATE.moved(role="context")])
    plan = REASONER.plan_layout(scene, [], np.random.default_rng(seed), partial(plan_complaints, scene=scene))
    assert plan_complaints(plan, scene) == []
    assert all(o.phrase in plan.text for o in scene.objects)


def test_contents_start_beside_their_receptacle_on_both_sides() -> None:
    plan = REASONER.plan_layout(scene_of([PLATE, *BLOCKS]), [], np.random.default_rng(0), lambda _: [])
    words = {r.relation for r in plan.relations if r.subject.endswith("block")}
    assert words == {"left_of", "right_of", "in_front_of"}


def test_what_is_complained_about_is_drawn_again() -> None:
    scene, seen = scene_of([PLATE, *BLOCKS]), []

    def no_red_on_the_left(plan: LayoutPlan) -> list[str]:
        seen.append(plan)
        left = Relation(subject="red-block", relation="left_of", reference="plate")
        return ["not there"] if left in plan.relations or len(seen) == 1 else []

    plan = REASONER.plan_layout(scene, [], np.random.default_rng(0), no_red_on_the_left)
    assert plan is seen[-1] and len(seen) > 1 and seen[0].relations != plan.relations


def test_what_is_always_complained_about_is_refused_after_a_few_draws() -> None:
    seen = []

    def never(selection: Selection) -> list[str]:
        seen.append(selection)
        return ["no room"]

    with pytest.raises(ModelRefused, match="no selection of offline can be used: no room"):
        REASONER.select_assets("Put the blocks on the plate", CATALOGUE, np.random.default_rng(0), never)
    assert len(seen) == TRIES


def ask(thing: str, place: str, holds: str, size: tuple = (0.05, 0.05, 0.05), opening: tuple = (0.2, 0.2, 0.1)):
    question = PairQuestion(
        object="a", object_words=thing, receptacle="b", receptacle_words=place, holds=holds, object_size=size,
        opening_size=opening,
    )  # fmt: skip
    return REASONER.judge_pairs([question])[0]


@pytest.mark.parametrize(
    ("thing", "place", "holds", "text"),
    [
        ("black marker pen", "packaging box", "in", "Put the black marker pen into the packaging box."),
        ("red block", "white plate", "on", "Put the red block onto the white plate."),
        ("bread roll", "bread box", "in", "Put the bread roll into the bread box."),
        ("marker pen: a fat one", "mug", "in", "Put the marker pen into the mug."),
    ],
)
def test_sensible_pairs_get_a_sentence(thing: str, place: str, holds: str, text: str) -> None:
    answer = ask(thing, place, holds)
    assert answer.sensible and answer.text == text and answer.relation == ("inside" if holds == "in" else "on")


@pytest.mark.parametrize(
    ("thing", "place", "holds"),
    [
        ("bagel", "stapler", "on"),
        ("packaging box", "mug", "in"),
        ("croissant", "book", "on"),
        ("stapler", "bread box", "in"),
        ("plate", "red block", "on"),
    ],
)
def test_senseless_pairs_get_a_reason(thing: str, place: str, holds: str) -> None:
    answer = ask(thing, place, holds)
    assert not answer.sensible and answer.reason and not answer.text


def test_what_is_too_large_for_the_opening_is_refused_with_both_sizes() -> None:
    answer = ask("book", "packaging box", "in", size=(0.3, 0.2, 0.03), opening=(0.24, 0.17, 0.07))
    assert not answer.sensible and "30.0 x 20.0 cm" in answer.reason and "24.0 x 17.0 cm" in answer.reason


KINDS = {
    kind.words.name: kind for kind in (*CATALOGUE, entry("bread_roll", "bread roll", "food", ("golden",), KITCHEN))
}


def kind_of(phrase: str) -> CatalogueEntry:
    """The kind that a phrase like 'black marker pen' names, in that colour only."""
    if phrase in KINDS:
        return KINDS[phrase]
    colour, _, name = phrase.partition(" ")
    return KINDS[name].model_copy(update={"variants": [v for v in KINDS[name].variants if v.colour == colour]})


def option(name: str, thing: str, place: str) -> ChainOption:
    return ChainOption(
        id=name,
        text=f"Put the {thing} into the {place}.",
        object=thing.replace(" ", "_"),
        receptacle=place.replace(" ", "_"),
        object_kind=kind_of(thing),
        receptacle_kind=kind_of(place),
    )


OPTIONS = [
    option("eraser-box", "whiteboard eraser", "packaging box"),
    option("black-box", "black marker pen", "packaging box"),
    option("black-mug", "black marker pen", "white mug"),
    option("red-box", "red marker pen", "packaging box"),
    option("croissant-bread", "croissant", "bread box"),
    option("roll-bread", "bread roll", "bread box"),
]


@pytest.mark.parametrize(
    ("instruction", "chain"),
    [
        ("Pack the marker pens and the eraser into the box", ["black-box", "red-box", "eraser-box"]),
        ("Put the bread into the bread box", ["croissant-bread", "roll-bread"]),
        ("Put the red marker into the box", ["red-box"]),
        ("Put three markers into the box", []),
        ("Put the eraser in the mug", []),
    ],
)
def test_a_chain_fulfils_the_whole_instruction_or_nothing(instruction: str, chain: list[str]) -> None:
    assert REASONER.compose_chain(instruction, OPTIONS) == chain


def test_a_thing_that_is_moved_twice_goes_to_its_last_place() -> None:
    options = [option("roll-box", "bread roll", "packaging box"), option("roll-bread", "bread roll", "bread box")]
    text = "Put the bread roll into the packaging box and then put it into the bread box"
    assert REASONER.compose_chain(text, options) == ["roll-bread"]


def test_a_place_that_is_passed_by_is_not_left_out_in_silence(caplog: pytest.LogCaptureFixture) -> None:
    options = [option("roll-box", "bread roll", "packaging box"), option("roll-bread", "bread roll", "bread box")]
    REASONER.compose_chain("Put the bread roll into the packaging box and then put it into the bread box", options)
    assert "'bread roll' goes to 'bread box' at once, not by way of 'packaging box'" in caplog.text


def test_a_later_clause_without_a_place_leaves_things_where_they_went() -> None:
    options = [option("roll-bread", "bread roll", "bread box"), option("roll-box", "bread roll", "packaging box")]
    text = "Put the bread roll into the packaging box and then scan it with the stapler"
    assert REASONER.compose_chain(text, options) == ["roll-box"]


def test_what_is_named_singly_is_not_used_up_by_the_word_for_its_kind() -> None:
    options = [option("roll", "bread roll", "bread box"), option("bagel", "bagel", "bread box")]
    assert REASONER.compose_chain("Put the breads and the bread roll into the bread box", options) == ["bagel", "roll"]
