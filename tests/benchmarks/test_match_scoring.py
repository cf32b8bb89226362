"""The score of matches against the truth, and the figures of a row."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks._match.scoring import Score, row, score
from benchmarks._match.truth import Stranger, TrueObject, Truth
from tests.example_scenes import scene_of, thing
from vcage.schema.matches import Match
from vcage.schema.scene import Scene


@pytest.fixture
def scene() -> Scene:
    return scene_of([thing("block", (-0.2, 0.0)), thing("plate", (0.2, 0.0)), thing("block", (0, 0), id="twin")])


def truth(**changes: object) -> Truth:
    objects = [
        TrueObject(id="block", present=True, position=(0.0, 0.0), yaw=0.2, symmetry=4),
        TrueObject(id="plate", present=True, position=(0.3, 0.0), yaw=0.0, symmetry=0),
        TrueObject(id="twin", present=False),
    ]
    return Truth(**{"level": "moved", "objects": objects, **changes})


def match(name: str, x: float, y: float = 0.0, yaw: float = 0.0, confidence: float = 0.9, method="feature") -> Match:
    return Match(
        object=name,
        method=method,
        similarity=None,
        confidence=confidence,
        box=None,
        position=(x, y),
        yaw=yaw,
        turned=0.0,
        ncc=None,
    )


def test_a_match_on_its_object_is_right_and_its_errors_are_measured(scene: Scene):
    one = score(scene, truth(), [match("block", 0.003, 0.004, yaw=0.2 + np.pi / 2 + 0.1)])
    (right,) = one.right
    assert right.position_error == pytest.approx(0.005)
    assert right.yaw_error == pytest.approx(0.1)


def test_a_round_object_has_no_yaw_error(scene: Scene):
    assert score(scene, truth(), [match("plate", 0.3, yaw=2.0)]).right[0].yaw_error == 0


def test_kept_matches_are_neither_right_nor_wrong(scene: Scene):
    one = score(scene, truth(), [match("block", 0.0, method="kept")])
    assert (one.right, one.wrong, one.present) == ([], [], 2)


@pytest.mark.parametrize(
    ("made", "why"),
    [
        (match("block", 0.29), "other"),
        (match("block", 0.05), "astray"),
        (match("twin", 0.0), "missing"),
        (match("block", -0.3), "stranger"),
    ],
)
def test_a_wrong_match_says_why(scene: Scene, made: Match, why: str):
    known = truth(strangers=[Stranger(name="a lemon", position=(-0.3, 0.0))])
    one = score(scene, known, [made])
    assert ([wrong.why for wrong in one.wrong], one.right) == ([why], [])


def test_of_two_matches_on_one_thing_the_closer_is_right(scene: Scene):
    objects = [
        TrueObject(id="block", present=True, position=(0.0, 0.0), yaw=0.0),
        TrueObject(id="plate", present=False),
        TrueObject(id="twin", present=True, position=(0.3, 0.0), yaw=0.0),
    ]
    one = score(scene, truth(objects=objects), [match("block", 0.01), match("twin", 0.0)])
    assert [wrong.object for wrong in one.wrong] == ["block"]
    assert one.wrong[0].why == "twice"


def test_objects_of_the_same_look_may_change_places(scene: Scene):
    objects = [
        TrueObject(id="block", present=True, position=(0.0, 0.0), yaw=0.0),
        TrueObject(id="plate", present=False),
        TrueObject(id="twin", present=True, position=(0.3, 0.0), yaw=0.0),
    ]
    assert len(score(scene, truth(objects=objects), [match("block", 0.3), match("twin", 0.0)]).right) == 2


def test_nothing_is_right_in_a_picture_that_shows_nothing(scene: Scene):
    objects = [TrueObject(id=o.id, present=False) for o in scene.objects]
    one = score(scene, truth(objects=objects), [match("block", 0.0)])
    assert [wrong.why for wrong in one.wrong] == ["missing"]


def test_a_row_counts_shares_over_all_pictures(scene: Scene):
    good = score(scene, truth(), [match("block", 0.0), match("plate", 0.3)], seconds=1.0)
    bad = score(scene, truth(), [match("block", 0.3, confidence=0.2), match("twin", 0.3, confidence=0.95)], seconds=3.0)
    figures = row("moved", "ours", [good, bad])
    assert (figures["identity"], figures["recall"], figures["false_matches"]) == (0.5, 0.5, 0.5)
    assert (figures["matches"], figures["seconds"], figures["pictures"]) == (4, 2.0, 2)
    assert (figures["wrong_below_median"], figures["wrong_below_median_share"]) == (False, 0.5)


def test_shares_add_up_to_one(scene: Scene):
    one = score(scene, truth(), [match("block", 0.05), match("plate", 0.3), match("twin", 0.0)])
    figures = row("moved", "ours", [one])
    assert figures["identity"] + figures["false_matches"] + figures["astray"] == pytest.approx(1, abs=1e-3)


def test_a_row_without_matches_has_no_shares():
    figures = row("moved", "ours", [Score("moved", 4, 4)])
    assert figures["identity"] is None
    assert figures["recall"] == 0
