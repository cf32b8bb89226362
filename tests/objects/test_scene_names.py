"""Objects of a scene that a sentence names."""

from __future__ import annotations

import pytest

from vcage.objects.library import Library
from vcage.objects.scene_names import SceneNames
from vcage.schema.goals import Description

LIBRARY = Library.load()


def look(kind: str, variant: str | None = None):
    entry = LIBRARY.entry(kind)
    return entry.model_copy(update={"variants": [v for v in entry.variants if variant in (None, v.id)][:1]})


THINGS = {
    "pen_red": look("marker", "red"),
    "pen_blue": look("marker", "blue"),
    "box": look("packaging_box"),
    "gift": look("gift_box"),
    "notes": look("sticky_notes"),
    "apple": look("apple"),
    "scanner": look("barcode_scanner"),
}
PHRASES = {
    "pen_red": "red marker pen", "pen_blue": "blue marker pen", "box": "brown packaging box", "gift": "gift box",
    "notes": "yellow pad of sticky notes", "apple": "red apple", "scanner": "black barcode scanner",
}  # fmt: skip


def meant(sentence: str, names: SceneNames | None = None) -> list[set[str]]:
    return [set(m.ids) for m in (names or SceneNames(THINGS, PHRASES)).mentions(sentence)]


@pytest.mark.parametrize(
    ("sentence", "ids"),
    [
        ("Put the apple away", [{"apple"}]),
        ("Put the Apple, please, in the packing box", [{"apple"}, {"box"}]),
        ("Put the red pen in the cardboard box", [{"pen_red"}, {"box"}]),
        ("Put the pens in the gift box", [{"pen_red", "pen_blue"}, {"gift"}]),
        ("Put the pen in it", [{"pen_red", "pen_blue"}]),
        ("Put the fruit in the box", [{"apple"}, {"box", "gift"}]),
        ("Put the green pen away", [set()]),
        ("Move the sticky notes", [{"notes"}]),
        ("Scan the bar code of the apple", [{"apple"}]),
        ("Present the apple to the customer", [{"apple"}]),
        ("Take the present", [{"gift"}]),
        ("Can you put it on the table?", []),
    ],
)
def test_a_name_means_all_objects_that_it_fits(sentence, ids):
    assert meant(sentence) == ids


@pytest.mark.parametrize(("said", "plural", "count"), [("both pens", True, 2), ("the three pens", True, 3)])
def test_plural_and_count_are_distinguished(said, plural, count):
    (mention,) = SceneNames(THINGS, PHRASES).mentions(f"Take {said}")
    assert (mention.plural, mention.count) == (plural, count)


def test_a_plural_name_means_one_object():
    (mention,) = SceneNames(THINGS, PHRASES).mentions("Take the sticky notes")
    assert not mention.plural


def plates(*told: tuple[str, str, str], lying: dict[str, str] | None = None, count: int = 2) -> SceneNames:
    things = {name: look("plate", "white") for name in ("a", "b", "c")[:count]} | {"box": look("packaging_box")}
    descriptions = [Description(subject=s, relation=r, reference=o, words="the plate") for s, r, o in told]
    phrases = dict.fromkeys(things, "white plate") | {"box": "brown packaging box"}
    return SceneNames(things, phrases, descriptions, lying)


def test_two_of_a_kind_are_distinguished_by_their_description():
    names = plates(("a", "left_of", "b"))
    assert meant("Use the left plate", names) == [{"a"}]
    assert meant("Use the plate on the right", names) == [{"b"}]
    assert meant("Put it to the left of the plate", names) == [{"a", "b"}]
    assert names.calls(["a"]) == ["the left white plate", "the left plate"]


def test_of_three_in_a_row_one_is_in_the_middle():
    names = plates(("b", "right_of", "a"), ("b", "left_of", "c"), count=3)
    assert [meant(f"Use the {side} plate", names) for side in ("left", "middle", "right")] == [
        [{"a"}],
        [{"b"}],
        [{"c"}],
    ]


def test_contents_are_identified_by_their_container():
    names = plates(lying={"a": "box"})
    assert meant("Take the plate out of the box", names) == [{"a"}, {"box"}]


def test_an_object_without_a_telling_name_is_called_by_none():
    assert plates().calls(["a"]) == []


def test_all_of_a_kind_have_one_name_and_two_of_three_have_none():
    names = SceneNames(THINGS, PHRASES)
    assert names.calls(["pen_red", "pen_blue"]) == ["the two marker pens", "the marker pens"]
    assert plates(count=3).calls(["a", "b"]) == []
