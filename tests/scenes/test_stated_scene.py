"""From told goals to objects, goals and a sentence; nothing is placed here."""

from __future__ import annotations

import re
from collections import Counter

import numpy as np
import pytest

from vcage.base.errors import InfeasibleScene, NoFeasibleTask, UnknownName, UsageError
from vcage.runs.context import StageContext
from vcage.scenes.chosen_objects import Chosen
from vcage.scenes.stated_goals import StatedTask
from vcage.scenes.stated_scene import choose_stated
from vcage.sim.robots import load_template


@pytest.fixture(scope="module")
def context() -> StageContext:
    return StageContext("offline")


class Chooser:
    """Chooses for told goals on the plain table."""

    def __init__(self, context: StageContext):
        self.context = context

    def __call__(
        self, *goals: str, starts: tuple[str, ...] = (), objects: str | None = None, text: str | None = None, seed=0
    ) -> tuple[str, Chosen]:
        told = StatedTask.of(goals, starts, objects)
        assert told is not None
        return choose_stated(told, text, load_template("table"), self.context, np.random.default_rng(seed))


@pytest.fixture
def choose(context: StageContext) -> Chooser:
    return Chooser(context)


def roles(chosen: Chosen) -> dict[str, str]:
    return {o.id: o.role for o in chosen.objects}


def test_a_row_is_asked_for_by_a_sentence_of_its_own(choose):
    text, _ = choose("block/red row_left_of block/blue", "block/blue row_left_of block/green")
    assert "row to the left of the blue block" in text


def test_both_arms_are_asked_for_by_a_sentence_of_their_own(choose):
    text, _ = choose("pot/blue held_by_both")
    assert "both arms" in text


# --- the objects of the scene --------------------------------------------------------------------------


def test_without_objects_each_name_is_one_object_with_the_role_that_its_goals_give_it(choose):
    _, chosen = choose("marker/red inside packaging_box/white", "then marker_red left_of plate/blue")
    assert roles(chosen) == {
        "marker_red": "content",
        "packaging_box_white": "receptacle",
        "plate_blue": "receptacle",
    }


def test_a_bare_kind_takes_its_look_from_another_goal(choose):
    _, chosen = choose("marker/red inside packaging_box", "then marker on table")
    assert [o.asset for o in chosen.objects] == ["marker", "packaging_box"]


def test_ids_with_numbers_are_further_objects_of_a_look(choose):
    _, chosen = choose("block_red on block_red_2", text="Stack the red blocks")
    assert list(roles(chosen)) == ["block_red", "block_red_2"]


def test_unrequested_looks_are_drawn_from_the_seed_and_differ(choose):
    drawn = {tuple(o.variant for o in choose("block/red back", objects="4 block", seed=s)[1].objects) for s in range(6)}
    assert len(drawn) > 1
    assert all(len({*looks}) == 4 for looks in drawn)


def test_scanning_weighing_and_hitting_bring_their_tools(choose):
    _, chosen = choose("chocolate_bar scanned", "then chocolate_bar weighed", "then chocolate_bar hit")
    tools = [o.asset for o in chosen.objects if o.role == "tool"]
    assert tools == ["barcode_scanner", "electronic_scale", "hammer"]


@pytest.mark.parametrize("vessel", ["cup/red", "mug/yellow", "small_bowl/white"])
def test_three_balls_of_other_colours_lie_in_a_vessel_where_nothing_is_stated_to(choose, vessel: str):
    text, chosen = choose(f"{vessel} poured bowl/green")
    vessel = vessel.replace("/", "_")
    balls = [o.variant for o in chosen.objects if o.starts_in == vessel and o.asset == "ball"]
    assert len(balls) == 3 and not {"green", vessel.split("_")[-1]} & {*balls} and "pour" in text.lower()


def test_balls_lie_in_each_of_two_vessels_of_a_kind_that_are_poured(choose):
    _, chosen = choose("cup_white poured bowl", "cup_teal poured pot")
    assert Counter(o.starts_in for o in chosen.objects if o.asset == "ball") == {"cup_white": 3, "cup_teal": 3}


def test_no_balls_lie_in_a_vessel_that_is_not_poured_or_has_some_beside_one_that_is(choose):
    _, chosen = choose("cup/red poured bowl", "cup/white on plate")
    assert Counter(o.starts_in for o in chosen.objects if o.asset == "ball") == {"cup_red": 3}
    starts = ("ball_red inside cup_white",)
    _, chosen = choose("cup_white poured bowl", "cup_teal poured pot", starts=starts)
    assert [o.id for o in chosen.objects if o.starts_in == "cup_white"] == ["ball_red"]
    assert len([o for o in chosen.objects if o.starts_in == "cup_teal"]) == 3


def test_only_stated_balls_lie_in_a_vessel_where_some_are(choose):
    _, chosen = choose("cup poured bowl", starts=("ball_red inside cup", "ball_red_2 inside cup"))
    assert {o.id for o in chosen.objects if o.asset == "ball"} == {"ball_red", "ball_red_2"}


def test_listed_objects_that_no_goal_names_are_context(choose):
    _, chosen = choose("marker inside packaging_box", objects="packaging_box, marker, apple")
    assert {o.asset: o.role for o in chosen.objects} == {
        "packaging_box": "receptacle",
        "marker": "content",
        "apple": "context",
    }


def test_a_cabinet_is_a_receptacle_filled_or_only_opened(choose):
    _, opened = choose("cabinet_one_drawer/oak/drawer open")
    assert roles(opened) == {"cabinet_one_drawer_oak": "receptacle"}
    _, filled = choose("cabinet_one_drawer/oak/drawer open", "then stapler/red inside cabinet_one_drawer/drawer")
    assert roles(filled)["cabinet_one_drawer_oak"] == "receptacle"
    assert [str(one.goal) for one in filled.reading.goals] == [
        "cabinet_one_drawer_oak/drawer open",
        "stapler_red inside cabinet_one_drawer_oak/drawer",
    ]


def test_a_thing_starts_where_a_start_condition_says(choose):
    _, chosen = choose("lemon on table", starts=("lemon inside basket",))
    held = {o.asset: (o.starts_in, o.role) for o in chosen.objects}
    basket = next(o.id for o in chosen.objects if o.asset == "basket")
    assert held == {"lemon": (basket, "content"), "basket": (None, "context")}
    assert [str(one).split(" ", 1)[1] for one in chosen.reading.descriptions] == [f"inside {basket}"]


# --- the sentence --------------------------------------------------------------------------------------


def test_the_sentence_says_all_goals_in_order(choose):
    text, chosen = choose(
        "marker/red inside packaging_box/brown",
        "stapler/black inside packaging_box with the left arm",
        "then apple/green back",
    )
    assert text == (
        "Put the red marker pen into the brown packaging box and put the black stapler into the brown packaging box "
        "with the left arm, then put the green apple back."
    )
    assert [(one.step, one.arm) for one in chosen.reading.goals] == [(1, None), (1, "left"), (2, None)]
    assert {one.words for one in chosen.reading.goals} == {text}


def test_a_given_instruction_is_the_text(choose):
    text, chosen = choose("marker inside packaging_box", text="Tidy up")
    assert text == "Tidy up"
    assert [one.words for one in chosen.reading.goals] == ["Tidy up"]


def test_an_instruction_that_says_everything_is_refused_where_a_goal_is_missing(choose):
    with pytest.raises(UsageError, match=r"says 'everything', but no goal speaks of apple_\w+"):
        choose("marker inside packaging_box", objects="marker, packaging_box, apple", text="Put everything in the box")


def test_an_instruction_with_unknown_objects_is_refused(choose):
    with pytest.raises(UsageError, match=r"names 'apple', but nothing is chosen that is called so"):
        choose("marker inside packaging_box", text="Put the apple in the box")


@pytest.mark.parametrize(
    "text, goals",
    [
        (
            "Put the red block in the box, then put the blue block in it",
            ("block/blue inside packaging_box", "then block/red inside packaging_box"),
        ),
        ("Put the apple to the left of the bowl", ("apple right_of bowl",)),
        ("Put the apple in the bowl with the left arm", ("apple inside bowl with the right arm",)),
        ("Put the apple in the bowl", ("apple inside bowl with the right arm",)),
        ("Stack the red block on the blue block", ("block/blue on block/red",)),
    ],
)
def test_goals_that_contradict_the_instruction_are_refused(choose, text: str, goals: tuple[str, ...]):
    with pytest.raises(UsageError, match="the goals do not match the instruction"):
        choose(*goals, text=text)


def test_an_unnamed_source_is_refused_with_the_option_for_it(choose):
    text = "Take the lemon out of the basket and put it on the table"
    with pytest.raises(UsageError, match="basket") as caught:
        choose("lemon on table", text=text)
    assert "--start" in caught.value.hint
    _, chosen = choose("lemon on table", starts=("lemon inside basket",), text=text)
    assert len(chosen.reading.descriptions) == 1


def test_an_object_left_alone_needs_no_goal(choose):
    choose("apple inside bowl", objects="apple, bowl, lemon", text="Put all the fruit except the lemon in the bowl")


# --- bad input -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "goals, more, error, complaint",
    [
        (["submarine inside bowl"], {}, UnknownName, "unknown object in 'submarine inside bowl': 'submarine'"),
        (["marker/mauve inside pot"], {}, UnknownName, "look of marker in .*: 'mauve'; available: beige, black"),
        (["apple inside bowl"], {"objects": "apple"}, UnknownName, r"'bowl'; available: apple_(red|green)$"),
        (["block back"], {"objects": "2 block/red"}, UsageError, "may mean block_red or block_red_2"),
        (["apple inside bowl"], {"objects": "apple, bowl, pony"}, UnknownName, "in --objects: 'pony'"),
        (["block/red on block/red"], {}, UsageError, "block_red cannot be on itself"),
        (["lidded_box/door open"], {}, UnknownName, r"unknown part of lidded_box_\w+ .*'door'; available: lid"),
        (["service_bell pressed"], {}, UsageError, "'pressed' needs a moving part"),
        (["service_bell/button open"], {}, NoFeasibleTask, r"service_bell_\w+ has no part that can be open"),
        (["apple/red/lid open"], {}, NoFeasibleTask, "apple_red has no part that can be open"),
        (["plate inside pot"], {}, NoFeasibleTask, "plate has no contact point to carry it by"),
        (["marker on pot/red"], {}, NoFeasibleTask, "nothing is put on the red cooking pot: they go in it"),
        (["marker inside cabinet_one_drawer/oak"], {}, NoFeasibleTask, "they go in its drawer .*, on it"),
        (["marker inside apple"], {}, NoFeasibleTask, "apple has no place to put something in or on"),
        (["plate handed left"], {}, NoFeasibleTask, "plate has no contact point"),
        (["plate presented"], {}, NoFeasibleTask, "plate has no contact point"),
        (["plate back"], {}, NoFeasibleTask, "plate has no contact point"),
        (["apple scanned"], {}, NoFeasibleTask, "apple has no bar code"),
        (["chocolate_bar scanned"], {"objects": "chocolate_bar"}, NoFeasibleTask, "no scanner stands there"),
        (["apple weighed"], {"objects": "apple"}, NoFeasibleTask, "no scale stands there"),
        (
            ["cup poured bowl"],
            {"objects": "cup, bowl"},
            NoFeasibleTask,
            r"nothing lies in cup_\w+ that could be poured",
        ),
        (["apple poured bowl"], {}, NoFeasibleTask, "apple is no vessel"),
        (
            ["cup poured bowl"],
            {"starts": ("ball inside cup", "ball inside cup")},
            UsageError,
            "'ball inside cup' is said before",
        ),
        (["apple left_of table"], {}, UsageError, "of the table only 'on' can be a goal"),
        (["hammer handed middle"], {}, UnknownName, "unknown arm in .*'middle'; available: left, right"),
        (["apple inside bowl with the third arm"], {}, UnknownName, "unknown arm in .*'third'"),
        (["apple inside bowl", "apple inside bowl"], {}, UsageError, "'apple inside bowl' is said before"),
        (["apple inside bowl", "then apple inside bowl"], {}, UsageError, "'then apple inside bowl' is said before"),
        (["lemon inside bowl"], {"starts": ("lemon inside bowl",)}, UsageError, "is at the start already"),
        (
            ["apple inside bowl", "apple inside pot"],
            {},
            UsageError,
            "the goals of one step contradict each other: apple",
        ),
        (["lidded_box/lid open", "lidded_box/lid closed"], {}, UsageError, "the goals of one step contradict"),
        (["block/red on block/blue", "then block/blue on block/red"], {}, UsageError, "goals contradict .*a circle"),
        (
            ["apple inside bowl"],
            {"starts": ("apple left_of bowl", "bowl left_of apple")},
            UsageError,
            "the start conditions contradict each other",
        ),
        (
            ["apple inside bowl"],
            {"starts": ("apple left_of table", "apple right_of table")},
            UsageError,
            r"apple_\w+ cannot be both left_of and right_of the table",
        ),
        (["banana on table"], {"starts": ("banana inside mug",)}, InfeasibleScene, "too large for mug"),
        (["banana on table"], {"starts": ("banana on pot",)}, NoFeasibleTask, "nothing can be on pot"),
    ],
)
def test_impossible_goals_are_named(choose, goals: list[str], more: dict, error: type[Exception], complaint: str):
    with pytest.raises(error, match=complaint):
        choose(*goals, **more)


@pytest.mark.parametrize(
    ("goals", "more", "way_out"),
    [
        (["apple inside bowl"], {"objects": "bowl"}, "add it to --objects"),
        (["apple inside apple"], {}, "name another object"),
        (["apple inside bowl", "apple inside pot"], {}, "leave one out, or let a later goal begin with 'then'"),
        (["apple inside bowl"], {"starts": ("apple left_of bowl", "bowl left_of apple")}, "leave one out$"),
    ],
)
def test_an_error_says_the_way_out(choose, goals: list[str], more: dict, way_out: str):
    with pytest.raises(UsageError) as caught:
        choose(*goals, **more)
    assert re.match(way_out, caught.value.hint)


def test_a_goal_may_come_again_once_another_has_undone_it(choose):
    _, chosen = choose("apple inside bowl", "then apple on table", "then apple inside bowl")
    assert [one.step for one in chosen.reading.goals] == [1, 2, 3]


def test_a_bell_may_be_pressed_twice(choose):
    text, _ = choose("service_bell/silver/button pressed", "then service_bell/button pressed")
    assert text == "Press the button of the silver service bell, then press the button of the silver service bell."
