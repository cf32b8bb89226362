"""What a scene without an instruction holds."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from tests.example_scenes import library
from tests.models.catalogue import CATALOGUE
from vcage.base.errors import NoAssetFits, UnknownName
from vcage.models.occasion import draw_contents
from vcage.schema.plan import Selection
from vcage.schema.scene import Contents, SceneTemplate
from vcage.sim.robots import available, load_template

TABLE = load_template("table")
SCENES = [name for name in available("scenes") if load_template(name).contents]


def with_contents(*contents: Contents) -> SceneTemplate:
    return TABLE.model_copy(update={"contents": list(contents)})


def drawn(*contents: Contents, seed: int = 0) -> Selection:
    return draw_contents(with_contents(*contents), CATALOGUE, np.random.default_rng(seed))


def test_kinds_have_all_tags_and_come_once():
    found = drawn(Contents(assets=["apple"]), Contents(tags=["kitchen", "food"], count=3))
    names = [o.asset for o in found.objects]
    assert names[0] == "apple" and sorted(names[1:]) == ["bagel", "baguette_piece", "croissant"]


def test_how_many_there_are_lies_between_the_numbers():
    counts = {len(drawn(Contents(tags=["food"], count=(1, 3)), seed=seed).objects) for seed in range(20)}
    assert counts == {1, 2, 3}


def test_the_seed_alone_settles_the_draw():
    asked = Contents(tags=["stationery"], count=(1, 3))
    draws = [drawn(asked, seed=seed) for seed in range(10)]
    assert draws == [drawn(asked, seed=seed) for seed in range(10)]
    assert len({tuple(o.asset for o in draw.objects) for draw in draws}) > 2


def test_a_receptacle_takes_things():
    found = drawn(Contents(tags=["stationery"], role="receptacle"))
    assert [(o.asset, o.role) for o in found.objects] == [("book", "receptacle")]


@pytest.mark.parametrize(
    ("asked", "error", "text"),
    [
        (Contents(tags=["food"], count=9), NoAssetFits, "asks for 9 objects tagged food as content, there are 4"),
        (Contents(tags=["fodo"]), UnknownName, "food"),
        (Contents(assets=["aple"]), UnknownName, "apple"),
        (Contents(assets=["stapler"], role="receptacle"), NoAssetFits, "of stapler as receptacle, there are 0"),
    ],
)
def test_unavailable_objects_are_reported(asked, error, text):
    with pytest.raises(error) as caught:
        drawn(asked)
    assert text in f"{caught.value.message} {caught.value.hint}"


@pytest.mark.parametrize("contents", [{}, {"tags": ["food"], "assets": ["apple"]}, {"tags": ["food"], "count": [3, 2]}])
def test_a_record_must_state_kinds_and_counts(contents):
    with pytest.raises(ValueError, match="expected"):
        Contents(**contents)


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("seed", range(3))
def test_every_scene_of_ours_has_something_to_carry_and_somewhere_to_put_it(name, seed):
    found = draw_contents(load_template(name), library().entries(), np.random.default_rng(seed))
    roles = Counter(o.role for o in found.objects)
    assert roles["content"] >= 4 and roles["receptacle"] >= 2


def test_the_five_scenes_of_the_paper_have_contents():
    assert {"bathroom", "cabinet", "cashier_desk", "kitchen", "office_desk"} <= set(SCENES)
