from __future__ import annotations

import pytest

from vcage.igsc.select import name_objects, validate_selection
from vcage.schema.asset import CatalogueEntry, Variant, Words
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


def test_an_unknown_variant_is_complained_about_with_what_there_is():
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
