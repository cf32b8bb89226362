from __future__ import annotations

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from tests.layout.items import capacity
from vcage.layout.capacities import capacity_of, opening_for, size_complaints
from vcage.objects.library import Library
from vcage.schema.plan import Relation
from vcage.schema.scene import Workspace

ROOMS = {
    "box": capacity((0.25, 0.18, 0.08), "in", (0.23, 0.16)),
    "plate": capacity((0.2, 0.2, 0.02), "on", (0.14, 0.14)),
    "oven": capacity((0.4, 0.3, 0.3), "in", (0.3, 0.2), ceiling=0.1),
    "book": capacity((0.2, 0.14, 0.03)),
    "bottle": capacity((0.07, 0.07, 0.2)),
    "brick": capacity((0.15, 0.14, 0.05)),
    "a": capacity((0.1, 0.1, 0.1)),
    "b": capacity((0.12, 0.09, 0.1)),
    "c": capacity((0.02, 0.02, 0.02)),
    "pen": capacity((0.16, 0.01, 0.01)),
    "rod": capacity((0.2, 0.01, 0.01)),
    "block": capacity((0.04, 0.04, 0.04), "on", (0.03, 0.03), bare=True),
}


def plan(*triples: tuple[str, str, str]) -> list[Relation]:
    return [Relation(subject=s, relation=r, reference=o) for s, r, o in triples]


@pytest.fixture(scope="module")
def library() -> Library:
    return Library.load()


def test_a_box_has_an_opening_smaller_than_itself(library):
    room = capacity_of("box", library.asset("packaging_box"))
    assert room.holds == "in" and room.ceiling is None
    assert all(a < b for a, b in zip(sorted(room.opening.size), sorted(room.size[:2]), strict=True))


def test_a_plate_takes_things_on_it_and_an_apple_takes_nothing(library):
    assert capacity_of("plate", library.asset("plate")).holds == "on"
    assert capacity_of("apple", library.asset("apple")).holds is None


def test_of_a_cabinet_with_closed_drawers_the_top_takes_things(library):
    cabinet = library.asset("cabinet_one_drawer")
    assert cabinet.annotation.functional_points[0].link is not None
    assert capacity_of("cabinet", cabinet).holds == "on"
    opening = opening_for(cabinet)
    assert opening is not None and opening.floor == pytest.approx(cabinet.size[2], abs=0.002)


@pytest.mark.parametrize(
    ("triple", "words"),
    [
        (("book", "inside", "bottle"), "which has no opening"),
        (("a", "inside", "plate"), "which has no opening"),
        (("a", "on", "book"), "no surface"),
        (("box", "inside", "oven"), None),
        (("bottle", "inside", "oven"), "20 cm high, oven takes 10 cm"),
        (("book", "on", "plate"), "too large for plate, which has room for 14.0 x 14.0 cm"),
        (("book", "inside", "box"), None),
        (("a", "on", "plate"), None),
        (("a", "on", "box"), None),
        (("pen", "on", "plate"), None),
        (("rod", "on", "plate"), "rod (20.0 x 1.0 cm) is too large for plate, which has room for 14.0 x 14.0 cm"),
        (("brick", "on", "book"), "no surface"),
        (("book", "on", "block"), None),
    ],
)
def test_sizes_and_openings_decide_the_containers(triple, words):
    found = size_complaints(plan(triple), ROOMS)
    assert found == [] if words is None else len(found) == 1 and words in found[0]


def test_contents_that_do_not_fit_together_are_named():
    area = size_complaints(plan(("brick", "inside", "box"), ("book", "inside", "box")), ROOMS)
    assert "brick, book do not fit into box together: they cover 490 cm²" in area[0]
    pair = size_complaints(plan(("a", "inside", "box"), ("brick", "inside", "box")), ROOMS)
    assert "a and brick do not fit into box beside each other" in pair[0]
    assert size_complaints(plan(("a", "inside", "box"), ("b", "inside", "box")), ROOMS) == []


def test_no_room_is_left_beside_an_overhanging_object_on_a_bare_top():
    assert "book, c do not fit into block together" in size_complaints(
        plan(("book", "on", "block"), ("c", "on", "block")), ROOMS
    )[0]  # fmt: skip


SIDES = st.floats(0.005, 0.3)


@given(size=st.tuples(SIDES, SIDES), angle=st.floats(0, 3.2), spare=st.tuples(SIDES, SIDES))
def test_an_object_that_fits_at_some_angle_is_not_called_too_large(size, angle, spare):
    c, s = abs(math.cos(angle)), abs(math.sin(angle))
    box = (c * size[0] + s * size[1] + 1e-6, s * size[0] + c * size[1] + 1e-6)
    rooms = {"x": capacity((*size, 0.1)), "y": capacity((*spare, 0.1))}
    rooms["alone"] = capacity((1, 1, 0.1), "in", box)
    assert not size_complaints(plan(("x", "inside", "alone")), rooms)
    rooms["both"] = capacity((1, 1, 0.1), "in", (box[0] + spare[0], max(box[1], spare[1])))
    found = size_complaints(plan(("x", "inside", "both"), ("y", "inside", "both")), rooms)
    assert not any("beside each other" in text or "too large" in text for text in found)


@given(size=st.tuples(SIDES, SIDES), opening=st.tuples(SIDES, SIDES))
def test_an_object_that_fits_at_no_angle_is_called_too_large(size, opening):
    angles = [math.pi * k / 720 for k in range(361)]
    boxes = [(math.cos(t) * size[0] + math.sin(t) * size[1], math.sin(t) * size[0] + math.cos(t) * size[1])
             for t in angles]  # fmt: skip
    over = min(max(w - opening[0], d - opening[1]) for w, d in boxes)
    assume(over > 0.002)
    rooms = {"x": capacity((*size, 0.1)), "y": capacity((1, 1, 0.1), "in", opening)}
    assert "too large" in size_complaints(plan(("x", "inside", "y")), rooms)[0]


def test_a_row_longer_than_the_workspace_is_refused():
    rooms = {name: capacity((0.3, 0.2, 0.1)) for name in "abcd"}
    row = plan(("a", "left_of", "b"), ("b", "left_of", "c"), ("d", "right_of", "c"))
    wide, narrow = (Workspace(lower=(0, 0), upper=(x, 0.4)) for x in (0.6, 0.49))
    assert size_complaints(row, rooms, wide) == []
    assert "this row needs at least 0.50 m, 0.49 m may be covered" in size_complaints(row, rooms, narrow)[0]
