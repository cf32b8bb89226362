"""Goals that nothing brings about wherever the objects stand."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from tests.example_scenes import thing, with_fingers
from vcage.base.errors import NoFeasibleTask
from vcage.schema.goals import AskedGoal, Goal, goal_of
from vcage.tasks.ruled_out import require_level, require_way
from vcage.tasks.scene_objects import SceneObject

ARMS = with_fingers(None).arms


def wanting(goal: Goal, objects: Sequence[SceneObject]) -> None:
    require_way([AskedGoal(goal=goal, step=0, words="the words")], objects, ARMS)


def test_an_object_ruled_out_by_size_is_refused_at_any_layout_with_words_and_reason():
    objects = [thing("ruler", (-0.2, 0.0), role="content"), thing("mug", (0.2, 0.0), role="receptacle")]
    with pytest.raises(NoFeasibleTask, match=r"ruler inside mug \('the words'\): .*does not fit in") as caught:
        wanting(Goal(subject="ruler", relation="inside", reference="mug"), objects)
    assert "another --seed does not help" in caught.value.hint


def test_an_object_no_arm_reaches_here_may_be_reached_elsewhere():
    far = [thing("marker", (0.0, 3.0)), thing("packaging_box", (0.4, 3.0))]
    wanting(Goal(subject="marker", relation="inside", reference="packaging_box"), far)


@pytest.mark.parametrize(
    ("name", "relation", "other", "why"),
    [
        ("mug", "hung_on", "plate", "plate has no peg to hang something on"),
        ("cup", "hung_on", "mug_rack", "cup has no closed handle to hang it by"),
        ("mug", "inserted_in", "peg_block", "mug is no peg that goes into a hole"),
        ("peg", "inserted_in", "bowl", "bowl has no hole to insert something in"),
        ("block", "poured", "bowl", "block is no vessel"),
        ("cup", "poured", "mug", r"mug is too narrow to pour into: 4\.\d × 4\.\d cm, and 7 cm are needed"),
        ("cup", "poured", "plate", "plate is not open at the top"),
    ],
)
def test_two_that_do_not_suit_each_other_are_refused_for_that_alone(name: str, relation: str, other: str, why: str):
    goal = Goal(subject=name, relation=relation, reference=other)
    with pytest.raises(NoFeasibleTask, match=why) as caught:
        wanting(goal, [thing(name, role="content"), thing(other, (0.2, 0.0), role="receptacle")])
    assert "functional point" not in caught.value.message


@pytest.mark.parametrize(
    ("event", "tool"),
    [
        ("scanned", "scanner"),
        ("weighed", "scale"),
        ("hit", "tool with a head to hit with"),
        ("wiped", "tool with a pad to wipe with"),
    ],
)
def test_without_its_tool_an_event_is_ruled_out(event: str, tool: str):
    with pytest.raises(NoFeasibleTask, match=f"no {tool} stands there"):
        wanting(goal_of(["chocolate_bar", event]), [thing("chocolate_bar")])


@pytest.mark.parametrize(("kind", "why"), [("mug", "no flat top to wipe"), ("block", "cannot be drawn to and fro")])
def test_what_has_no_flat_top_for_a_sponge_is_not_wiped(kind: str, why: str):
    with pytest.raises(NoFeasibleTask, match=why):
        wanting(goal_of([kind, "wiped"]), [thing(kind), thing("sponge", (0.3, 0.0))])


@pytest.mark.parametrize("kind", ["bowl", "block"])
def test_what_has_no_front_is_not_turned_to_the_robot(kind: str):
    with pytest.raises(NoFeasibleTask, match=rf"{kind} has no front that could face the robot \('the words'\)"):
        wanting(goal_of([kind, "facing_robot"]), [thing(kind)])


@pytest.mark.parametrize("kind", ["block", "can"])
def test_what_two_hands_have_no_room_on_is_not_handed_over(kind: str):
    with pytest.raises(NoFeasibleTask, match=rf"no room side by side on .*{kind}: .* \('the words'\)"):
        wanting(goal_of([kind, "handed", "right"]), [thing(kind)])


@pytest.mark.parametrize("kind", ["block", "bottle", "cutting_board"])
def test_what_has_no_places_for_two_hands_is_not_held_by_both(kind: str):
    with pytest.raises(NoFeasibleTask, match=r"no two places at which two hands can hold it \('the words'\)"):
        wanting(goal_of([kind, "held_by_both"]), [thing(kind)])


@pytest.mark.parametrize("kind", ["pot", "rolling_pin", "hammer"])
def test_what_is_wide_enough_for_two_hands_is_held_by_both(kind: str):
    wanting(goal_of([kind, "held_by_both"]), [thing(kind)])


@pytest.mark.parametrize("kind", ["long_block", "hammer", "bottle"])
def test_what_is_long_enough_for_two_hands_is_handed_over(kind: str):
    wanting(goal_of([kind, "handed", "right"]), [thing(kind)])


def test_what_has_a_front_is_turned_to_the_robot():
    wanting(goal_of(["cereal_box", "facing_robot"]), [thing("cereal_box")])


def test_one_reason_for_many_objects_of_a_kind_is_reported_once_with_their_number():
    blocks = [thing("block", id=f"block_{number}") for number in range(12)]
    asked = [
        AskedGoal(goal=Goal(subject=o.id, relation="inside", reference="mug"), step=0, words="12 blocks")
        for o in blocks
    ]
    objects = [*blocks, thing("mug", (0.2, 0.0))]
    with pytest.raises(NoFeasibleTask, match=r"block_0 inside mug and 11 more like it \('12 blocks'\)") as caught:
        require_way(asked, objects, ARMS)
    assert caught.value.message.count("6 mm") == 1
    assert len(caught.value.details["missing"]) == 12


BOWL = [thing("apple"), thing("bowl", (-0.2, 0.0)), thing("tray", (0.2, 0.0))]


def asked(*goals: tuple[str, str, str]) -> list[AskedGoal]:
    """Goals that come one after the other."""
    return [
        AskedGoal(goal=Goal(subject=a, relation=word, reference=b), step=step, words=f"step {step}")
        for step, (a, word, b) in enumerate(goals)
    ]


def test_a_filled_bowl_is_not_carried_and_the_error_offers_alternatives():
    goals = asked(("apple", "inside", "bowl"), ("bowl", "on", "tray"))
    with pytest.raises(NoFeasibleTask, match=r"bowl cannot be carried with the .* apple in it \('step 1'\)") as caught:
        require_level(goals, BOWL, ARMS.values())
    assert "move the white bowl first" in caught.value.hint


@pytest.mark.parametrize(
    "goals",
    [
        [("bowl", "on", "tray"), ("apple", "inside", "bowl")],
        [("apple", "inside", "bowl"), ("apple", "on", "tray"), ("bowl", "on", "table")],
    ],
)
def test_a_bowl_emptied_before_its_move_is_not_refused(goals: list[tuple[str, str, str]]):
    require_level(asked(*goals), BOWL, ARMS.values())


def test_a_cup_held_by_its_middle_is_carried_with_its_contents():
    objects = [thing("lipstick"), thing("cup", (-0.2, 0.0)), thing("plate", (0.2, 0.0))]
    require_level(asked(("lipstick", "inside", "cup"), ("cup", "on", "plate")), objects, ARMS.values())


def test_nothing_is_put_into_what_tips_in_the_hand_that_holds_it_up():
    held = AskedGoal(goal=Goal(subject="bowl", relation="held_up"), step=1, words="hold up the bowl")
    (put,) = asked(("apple", "inside", "bowl"))
    with pytest.raises(NoFeasibleTask, match="apple cannot be put into the white bowl while that is held up"):
        require_level([held, put.model_copy(update={"step": 2})], BOWL, ARMS.values())


def test_a_filled_bowl_that_is_hit_stays_where_it_is():
    hit = AskedGoal(goal=Goal(subject="bowl", relation="hit"), step=2, words="hit the bowl")
    require_level([*asked(("apple", "inside", "bowl")), hit], BOWL, ARMS.values())
