from __future__ import annotations

import pytest

from tests.layout.items import capacity
from vcage.models.selection_check import (
    NamedObject,
    name_objects,
    room_complaints,
    starting_as_described,
    validate_selection,
)
from vcage.schema.asset import CatalogueEntry, FunctionalPoint, Variant, Words
from vcage.schema.goals import Description
from vcage.schema.plan import SelectedAsset, Selection


def entry(name: str, words: str, **colours: str) -> CatalogueEntry:
    return CatalogueEntry(
        name=name,
        words=Words(name=words, plural=f"{words}s", description=words, category="stationery"),
        variants=[Variant(id=variant, colour=colour) for variant, colour in colours.items()],
        size=(0.1, 0.1, 0.1),
    )


ENTRIES = [
    entry("marker", "marker pen", black="black", red="red"),
    entry("stapler", "stapler", plain="blue"),
    entry("bread", "bread", loaf="brown", roll="brown"),
]


def selection(*chosen: tuple[str, str]) -> Selection:
    return Selection(objects=[SelectedAsset(asset=a, variant=v, role="content") for a, v in chosen])


def test_a_known_selection_has_no_complaints():
    assert validate_selection(selection(("marker", "red"), ("stapler", "plain")), ENTRIES) == []


def test_an_unknown_asset_is_complained_about_with_the_nearest_name():
    assert validate_selection(selection(("markers", "red")), ENTRIES) == [
        "there is no asset 'markers'; did you mean marker?"
    ]


def test_an_unknown_variant_is_complained_about_with_the_known_ones():
    assert validate_selection(selection(("marker", "pink")), ENTRIES) == [
        "marker has no variant 'pink'; it has black, red"
    ]


@pytest.mark.parametrize(
    ("chosen", "name", "phrase"),
    [
        (("marker", "black"), "marker_black", "black marker pen"),
        (("stapler", "plain"), "stapler", "stapler"),
        (("bread", "roll"), "bread_roll", "bread"),
    ],
)
def test_ids_have_the_variant_and_phrases_the_colour_where_there_are_several(chosen, name, phrase):
    (named,) = name_objects(selection(chosen), ENTRIES)
    assert (named.id, named.phrase) == (name, phrase)


def test_duplicates_get_numbers():
    named = name_objects(selection(*[("marker", "red")] * 3), ENTRIES)
    assert [n.id for n in named] == ["marker_red", "marker_red_2", "marker_red_3"]


def holding(name: str, link: str | None = None) -> CatalogueEntry:
    point = FunctionalPoint(id=0, name="inside", holds="in", position=(0, 0, 0.01), link=link)
    return entry(name, name, plain="grey").model_copy(update={"functional_points": [point]})


def starting_in(container: str) -> Selection:
    return Selection(
        objects=[
            SelectedAsset(asset="stapler", variant="plain", role="content", starts_in=container),
            SelectedAsset(asset=container, variant="plain", role="context"),
        ]
    )


def test_an_object_starting_in_a_container_names_that_object_of_the_scene():
    named = name_objects(starting_in("tray"), [*ENTRIES, holding("tray")])
    assert [o.starts_in for o in named] == ["tray", None]


def test_a_start_in_something_without_room_is_complained_about():
    entries = [*ENTRIES, entry("plank", "plank", plain="brown")]
    assert validate_selection(starting_in("plank"), entries) == [
        "stapler cannot start in or on plank, which has no room for things"
    ]


def test_nothing_starts_in_a_drawer_because_drawers_are_closed():
    entries = [*ENTRIES, holding("cabinet", link="drawer")]
    assert len(validate_selection(starting_in("cabinet"), entries)) == 1


def test_starts_that_run_in_a_circle_are_no_selection():
    ring = [("a", "b"), ("b", "c"), ("c", "a")]
    with pytest.raises(ValueError, match="a starts in b starts in c starts in a: that is a circle"):
        Selection(objects=[SelectedAsset(asset=a, variant="x", role="content", starts_in=b) for a, b in ring])


def test_a_second_cup_may_start_in_the_container_of_the_first():
    chosen = [("cup", None), ("bowl", "cup"), ("cup", "bowl")]
    objects = [SelectedAsset(asset=a, variant="x", role="content", starts_in=b) for a, b in chosen]
    named = name_objects(Selection(objects=objects), [entry("cup", "cup", x="red"), entry("bowl", "bowl", x="red")])
    assert [(o.id, o.starts_in) for o in named] == [("cup", None), ("bowl", "cup"), ("cup_2", "bowl")]


def test_a_start_without_room_is_complained_about():
    objects = [NamedObject(i, i, "x", i, "content", "box") for i in ("pen", "book", "brick", "other_brick")]
    objects.append(NamedObject("box", "box", "x", "box", "context"))
    rooms = {
        "box": capacity((0.22, 0.17, 0.1), "in", (0.2, 0.15)),
        "pen": capacity((0.14, 0.01, 0.01)),
        "book": capacity((0.3, 0.2, 0.02)),
        "brick": capacity((0.13, 0.1, 0.05)),
        "other_brick": capacity((0.13, 0.1, 0.05)),
    }
    book, brick = room_complaints(objects, rooms)
    assert "book has no room where it starts" in book and "too large for box" in book
    assert "other_brick has no room where it starts" in brick


def test_at_the_start_nothing_sticks_out_of_a_bare_top():
    objects = [NamedObject(i, i, "x", i, "content", start) for i, start in (("book", "tin"), ("tin", None))]
    rooms = {"book": capacity((0.2, 0.14, 0.03)), "tin": capacity((0.1, 0.1, 0.1), "on", (0.09, 0.09), bare=True)}
    (complaint,) = room_complaints(objects, rooms)
    assert "too large for tin" in complaint


def described(subject: str, relation: str, reference: str, part: str | None = None) -> Description:
    return Description(subject=subject, relation=relation, reference=reference, part=part, words="so")


def test_an_object_described_in_a_drawer_starts_there():
    objects = [NamedObject("pen", "pen", "x", "pen", "content"), NamedObject("desk", "desk", "x", "desk", "context")]
    (pen, desk), wrong = starting_as_described(objects, [described("pen", "inside", "desk", "drawer_top")])
    assert (pen.starts_in, pen.starts_in_part, desk, wrong) == ("desk", "drawer_top", objects[1], [])


@pytest.mark.parametrize("said", [described("pen", "inside", "cup"), described("pen", "on", "table")])
def test_an_object_starting_against_its_description_is_complained_about(said):
    objects = [
        NamedObject(i, i, "x", i, "content", start) for i, start in (("pen", "box"), ("box", None), ("cup", None))
    ]
    _, (complaint,) = starting_as_described(objects, [said])
    assert "pen starts in or on box, not" in complaint and "'so'" in complaint
