"""Where an object is looked for: where the layout put it, and elsewhere."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from types import SimpleNamespace
from typing import cast

import cv2
import numpy as np
import pytest

from tests.models.tabletop import BLOCKS, BOX, CAMERA, HEIGHT, WHITE_BOX, critic_question, view
from vcage.base.geometry import Pose
from vcage.models.rules import standing
from vcage.models.rules.critic_view import CriticView
from vcage.models.rules.standing import Sought, Standing
from vcage.schema.goals import Goal
from vcage.vision.protocols import Reference, View

PLANNED = Standing(Pose([0, 0, 0]), (0.1, 0.1, 0.1), 10.0, np.ones((1, 1), bool))
OTHER = Standing(Pose([1, 0, 0]), (0.1, 0.1, 0.1), 4.0, np.ones((1, 1), bool))


@pytest.mark.parametrize(("bare", "found"), [([], OTHER), ([OTHER], PLANNED), ([PLANNED], OTHER)])
def test_a_place_that_fits_better_counts_only_where_something_is_seen_there(
    monkeypatch: pytest.MonkeyPatch, bare: list[Standing], found: Standing
):
    monkeypatch.setattr(Sought, "where_planned", lambda *_: PLANNED)
    monkeypatch.setattr(Sought, "standing", lambda *_: OTHER)
    monkeypatch.setattr(Sought, "gone", lambda _, there, __: any(there is one for one in bare))
    sought = Sought(cast(Reference, None), lambda *_: None, None, 0.74)  # pyrefly: ignore
    assert sought.found({"top": cast(View, None)}) is found


def test_nothing_stands_where_no_patch_shows_a_place_for_it(monkeypatch: pytest.MonkeyPatch):
    asked = critic_question([BOX, BLOCKS[0]], [BOX, BLOCKS[0]], Goal(subject=BLOCKS[0].id, relation="back"))
    ring = np.zeros((CAMERA.height, CAMERA.width), np.uint8)
    cv2.circle(ring, (320, 240), 60, (1,), 8)
    monkeypatch.setattr(standing, "components", lambda *_: [ring.astype(bool)])
    monkeypatch.setattr(standing, "_upon", lambda *_: [])
    draw = partial(asked.draw, BLOCKS[0].id)
    sought = Sought(asked.references[BLOCKS[0].id], lambda *seen: draw(*seen, {}), asked.background, HEIGHT)
    monkeypatch.setattr(standing, "places", lambda *_: SimpleNamespace(poses=np.zeros((1, 4))))
    assert sought.standing(asked.after) is None


def test_a_box_of_the_tables_colour_stands_where_its_rims_are_seen():
    sought = white_box()
    with_it, without = ({"top": view(things)} for things in ([WHITE_BOX, BLOCKS[0]], [BLOCKS[0]]))
    there = sought.where_planned(with_it)
    assert there is not None and not sought.gone(there, with_it["top"])
    assert sought.gone(there, without["top"])
    left = np.zeros(there.covered.shape, bool)
    assert (sought.left(there, left, with_it["top"]), sought.left(there, left, without["top"])) == (0.0, 1.0)


def test_a_thing_of_its_shape_that_stands_as_planned_is_not_taken_for_it():
    one = BLOCKS[0]
    rosy = one.moved(id="rosy-block", colour=(215, 70, 60), at=(0.2, 0.1))
    asked = critic_question([one, rosy], [rosy], Goal(subject=one.id, relation="back"))
    sought = CriticView(asked).sought(one.id)
    alone = replace(sought, rivals=()).standing(asked.after)
    assert alone is not None and np.allclose(alone.pose.p[:2], rosy.at, atol=0.01)
    assert sought.standing(asked.after) is None


def test_the_table_is_seen_through_a_thing_that_is_not_there_and_not_through_an_arm_over_it():
    one = BLOCKS[0]
    asked = critic_question([one], [one], Goal(subject=one.id, relation="back"))
    sought = CriticView(asked).sought(one.id)
    there, bare = Standing(Pose([*one.at, HEIGHT]), sought.look.size, 0.0, np.ones((1, 1), bool)), asked.background
    top = asked.after["top"]
    arm = replace(top, picture=np.full_like(bare, 20))
    seen = [sought.seen_through(there, one, bare, 14.0)[0] for one in (replace(top, picture=bare), top, arm)]
    assert seen[0] == 1.0 and max(seen[1:]) < 0.1


def white_box() -> Sought:
    asked = critic_question([WHITE_BOX], [WHITE_BOX], Goal(subject=WHITE_BOX.id, relation="back"))
    at = asked.planned[WHITE_BOX.id]
    draw = partial(asked.draw, WHITE_BOX.id)
    look = asked.references[WHITE_BOX.id]
    return Sought(look, lambda *seen: draw(*seen, {}), asked.background, HEIGHT, planned=at)
