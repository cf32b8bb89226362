"""The library as text for a prompt."""

from __future__ import annotations

from vcage.assets.catalogue import catalogue_text, size_class


def test_each_kind_is_one_line_with_its_name(library) -> None:
    entries = library.entries()
    lines = catalogue_text(entries).splitlines()
    assert [line.split(":")[0] for line in lines] == [f"- {entry.name}" for entry in entries]


def test_the_line_says_what_the_object_can_do(library) -> None:
    line = catalogue_text([library.entry("packaging_box")])
    assert "holds things in it" in line and "can be grasped" in line and "brown, white" in line
    assert "cannot be grasped" in catalogue_text([library.entry("book")])


def test_size_classes_follow_the_longest_edge(library) -> None:
    classes = {name: size_class(library.entry(name)) for name in ("block", "toy_car", "marker", "tray")}
    assert classes == {"block": "tiny", "toy_car": "small", "marker": "medium", "tray": "large"}
