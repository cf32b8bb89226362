"""Goals of sentences, in scenes that are selected for them and in scenes of their own."""

from __future__ import annotations

import pytest

from tests.models.rules.scenes import goals, kinds, read
from vcage.base.errors import NoAssetFits, UnreadInstruction
from vcage.models.rules.readings import read_goals
from vcage.models.selection_check import name_objects
from vcage.objects.names import best_looks
from vcage.schema.asset import CatalogueEntry

TWO_COLOURED = {"white": "white", "yellow_and_white": "yellow and white", "blue": "white and blue"}


def scene(*looks: str) -> dict[str, CatalogueEntry]:
    """Objects called ``kind_variant`` from ``kind/variant``."""
    entries = {entry.name: entry for entry in kinds()}
    found = {}
    for look in looks:
        kind, _, variant = look.partition("/")
        shown = [v for v in entries[kind].variants if v.id == variant]
        found[look.replace("/", "_")] = entries[kind].model_copy(update={"variants": shown, "any_colour": None})
    return found


def in_scene(sentence: str, *looks: str) -> list[str]:
    return [f"{asked.step}: {asked.goal}" for asked in read_goals(sentence, scene(*looks)).goals]


def test_and_makes_no_order_then_does() -> None:
    things = ("apple/red", "bowl/white", "banana/ripe", "plate/white")
    assert in_scene("Put the apple in the bowl and the banana on the plate", *things) == [
        "1: apple_red inside bowl_white",
        "1: banana_ripe on plate_white",
    ]
    assert in_scene("Put the apple in the bowl, then put the banana on the plate", *things)[1][0] == "2"


def test_a_dependent_goal_comes_after_its_requirement() -> None:
    found = goals("Open the top drawer, put the stapler in it and close it")
    assert [goal.split(": ")[0] for goal in found] == ["1", "2", "3"]
    assert found[0].endswith("drawer_top open") and found[2].endswith("drawer_top closed")


def test_a_source_is_a_description_that_must_be_true_at_the_start() -> None:
    _, reading = read("Take the banana out of the pot and put it on the table")
    (found,) = reading.descriptions
    assert found.relation == "inside" and found.reference.startswith("pot")
    assert [asked.goal.reference for asked in reading.goals] == ["table"]


def test_a_drawer_that_a_thing_is_taken_from_is_part_of_the_description() -> None:
    _, reading = read("Pick up the battery pack from the top drawer of the cabinet and put it in the basket")
    assert reading.descriptions[0].part == "drawer_top"


def test_the_left_one_of_two_is_described_against_the_other() -> None:
    chosen, reading = read("Put the red mug on the left plate")
    assert [o.asset for o in chosen.objects].count("plate") == 2
    (found,) = reading.descriptions
    assert (found.relation, found.subject) == ("left_of", reading.goals[0].goal.reference)
    assert found.reference.startswith("plate")


def test_the_left_one_of_one_is_described_against_the_table() -> None:
    reading = read_goals("Put the apple on the left plate", scene("apple/red", "plate/white"))
    assert [str(found) for found in reading.descriptions] == ["plate_white left_of table"]


def test_the_middle_one_of_three_stands_between_the_others() -> None:
    _, reading = read("Put the middle block on the plate")
    assert sorted(found.relation for found in reading.descriptions) == ["left_of", "right_of"]
    assert {found.subject for found in reading.descriptions} == {reading.goals[0].goal.subject}


def test_a_named_arm_is_a_condition_and_any_arm_is_none() -> None:
    assert read("Use the left arm to pick up the apple and put it in the bowl")[1].goals[0].arm == "left"
    assert read("Put the apple in the bowl with the right arm")[1].goals[0].arm == "right"
    assert read("Use one arm to pick up the can and move it to beside the pot")[1].goals[0].arm is None


@pytest.mark.parametrize(
    "sentence",
    [
        "Pour everything in the cup into the bowl with the left arm",
        "Empty the contents of the cup into the bowl using the left arm",
    ],
)
def test_a_pouring_that_is_read_in_two_ways_keeps_its_verb_and_its_arm(sentence: str) -> None:
    (asked,) = read(sentence)[1].goals
    assert (asked.goal.relation, asked.arm, asked.words) == ("poured", "left", sentence)


@pytest.mark.parametrize("sentence", ["Push in the button and the drawer", "Push the button and the drawer in"])
def test_of_several_things_that_are_pushed_in_each_is_pressed_or_closed(sentence: str) -> None:
    pressed, closed = goals(sentence)
    assert pressed.endswith("/button pressed") and closed.endswith("/drawer closed")


@pytest.mark.parametrize("vessel", ["basket", "small bin"])
def test_to_dump_what_may_be_poured_or_put_says_how_to_ask_for_either(vessel: str) -> None:
    with pytest.raises(UnreadInstruction, match=r"two things.* say pour, or put, in place of dump"):
        read(f"Dump everything out of the {vessel} into the box")
    assert " poured " in goals(f"Pour everything out of the {vessel} into the box")[0]
    assert " inside " in goals(f"Put everything out of the {vessel} into the box")[0]


def test_everything_is_all_but_the_place() -> None:
    found = in_scene("Everything goes into the packaging box", "cup/white", "apple/red", "packaging_box/brown")
    assert len(found) == 2 and all(goal.endswith("inside packaging_box_brown") for goal in found)


def test_an_exception_is_left_out_and_stays_untouched() -> None:
    things = scene("marker/red", "marker/blue", "marker/black", "packaging_box/brown")
    reading = read_goals("Put all the pens except the red one into the box", things)
    assert {asked.goal.subject for asked in reading.goals} == {"marker_blue", "marker_black"}
    assert reading.untouched == ["marker_red"]


def test_everything_else_and_all_others_exclude_earlier_objects() -> None:
    things = ("apple/red", "apple/green", "cup/white", "bowl/white", "packaging_box/brown")
    assert len(in_scene("Put the red apple in the bowl and all the other apples in the box", *things)) == 2
    found = in_scene("Put the red apple in the bowl and everything else in the box", *things)
    assert sorted(found)[-2:] == ["1: apple_red inside bowl_white", "1: cup_white inside packaging_box_brown"]
    assert len(found) == 3


def test_but_is_an_exception_before_an_object_and_joins_a_placed_one() -> None:
    things = ("marker/red", "marker/blue", "packaging_box/brown", "plate/white")
    only_blue = ["1: marker_blue inside packaging_box_brown"]
    assert in_scene("Put all the pens but the red one into the box", *things) == only_blue
    both = in_scene("Put the blue pen in the box but the red pen on the plate", *things)
    assert both == [*only_blue, "1: marker_red on plate_white"]


def test_beside_a_drawer_is_beside_its_cabinet() -> None:
    found = in_scene("Put the apple next to the drawer", "apple/red", "cabinet_three_drawers/steel")
    assert found == ["1: apple_red beside cabinet_three_drawers_steel"]
    with pytest.raises(UnreadInstruction, match="not on it or beside it"):
        in_scene("Put the apple to the left of the top drawer", "apple/red", "cabinet_three_drawers/steel")


def test_the_drawer_is_the_last_one_named() -> None:
    found = goals("Open the top drawer, put the apple in it and close the drawer")
    assert found[-1] == "3: cabinet_three_drawers_steel/drawer_top closed"


@pytest.mark.parametrize("which", ["the other cabinet", "each cabinet", "both cabinets", "two cabinets"])
def test_the_drawers_of_several_cabinets_are_refused(which: str) -> None:
    with pytest.raises(UnreadInstruction):
        goals(f"Open the top drawer of {which}")


def test_a_thing_is_handed_over_after_a_comma() -> None:
    found = goals("Pick up the hammer with the left arm, hand it to the right arm and put it in the box")
    assert [goal.split(" ", 2)[2] for goal in found] == ["handed right", "inside packaging_box_brown"]


def test_several_objects_stacked_on_a_place_stand_on_each_other() -> None:
    things = ("block/red", "block/blue", "block/green", "plate/white")
    assert in_scene("Stack the red block and the blue block on the plate", *things) == [
        "1: block_red on plate_white",
        "1: block_blue on block_red",
    ]


@pytest.mark.parametrize(
    ("sentence", "goals"),
    [
        ("Lift the red block", ["1: block_red lifted"]),
        ("Lift the red block and put it on the plate", ["1: block_red on plate_white"]),
        ("Give the red block a shake", ["1: block_red shaken"]),
        ("Pick up the red block and hold it", ["1: block_red held_up"]),
        ("Hold up the red block with the left arm", ["1: block_red held_up"]),
        ("Hold up the red block and the cup, one in each hand", ["1: block_red held_up", "1: cup_white held_up"]),
        (
            "Simultaneously pick up the red block and the cup, one with each arm",
            ["1: block_red held_up", "1: cup_white held_up"],
        ),
        (
            "Use one arm to hold up the cup and the other arm to put the red block on the plate",
            ["1: cup_white held_up", "2: block_red on plate_white"],
        ),
        (
            "Swap the red block and the cup",
            ["1: block_red in_place_of cup_white", "1: cup_white in_place_of block_red"],
        ),
        (
            "Swap the red block and the cup with each other",
            ["1: block_red in_place_of cup_white", "1: cup_white in_place_of block_red"],
        ),
        ("Put the red block and the cup next to each other", ["1: block_red beside cup_white"]),
        ("Move the cup and the plate close to one another", ["1: cup_white near plate_white"]),
        ("Put the plate and the red block side by side", ["1: block_red beside plate_white"]),
        ("Lift the cup with both hands", ["1: cup_white held_by_both"]),
        ("Use both arms to grab the cup", ["1: cup_white held_by_both"]),
        ("Hold the cup up in the air using your two hands", ["1: cup_white held_by_both"]),
        ("With both of your arms, pick up the cup", ["1: cup_white held_by_both"]),
        (
            "Put the red block on the plate, then lift the cup with two hands",
            ["1: block_red on plate_white", "2: cup_white held_by_both"],
        ),
        ("Turn the red block to face the robot", ["1: block_red facing_robot"]),
        (
            "Put the red block on the plate and make sure it faces the robot",
            ["1: block_red on plate_white", "1: block_red facing_robot"],
        ),
        ("Pick up the red block and move it slightly away", ["1: block_red moved_away"]),
        ("Turn off the tap", ["1: tap_chrome/lever turned_back"]),
        ("Turn the tap on, then turn it off", ["1: tap_chrome/lever turned", "2: tap_chrome/lever turned_back"]),
        ("Arrange the red block and the plate in a row from right to left", ["1: plate_white row_left_of block_red"]),
    ],
)
def test_verbs_of_the_air_and_of_the_sides_are_read(sentence: str, goals: list[str]) -> None:
    assert in_scene(sentence, "block/red", "plate/white", "tap/chrome", "cup/white") == goals


@pytest.mark.parametrize(
    ("sentence", "why"),
    [
        ("Put the red block on the plate with both arms", "two arms at once cannot be promised"),
        ("Put the red block in both hands", "two arms at once cannot be promised"),
        ("Put the red block in each hand", "two arms at once cannot be promised"),
        ("Simultaneously put the red block and the cup on the plate", "two arms at once cannot be promised"),
        ("Lift the plate with both arms, then put it on the table", "stays in it to the end"),
        ("Lift the plate and the red block with both arms", "of two things say: one in each hand"),
        ("Hold up the red block, the blue block and the cup, one in each hand", "name two things"),
        ("Hold the cup, then put it on the plate", "stays in it to the end"),
        ("Use one arm to hold the cup and the other arm to put the cup on the plate", "stays in it to the end"),
    ],
)
def test_both_arms_only_hold_things_up(sentence: str, why: str) -> None:
    with pytest.raises(UnreadInstruction, match=why):
        in_scene(sentence, "block/red", "block/blue", "plate/white", "cup/white")


@pytest.mark.parametrize(
    "sentence",
    [
        "Pick up the cup head-up",
        "Shake the cup horizontally",
    ],
)
def test_verbs_that_no_goal_states_are_refused_by_name(sentence: str) -> None:
    with pytest.raises(UnreadInstruction, match="no goal says which way up a thing is"):
        in_scene(sentence, "block/red", "plate/white", "cup/white")


@pytest.mark.parametrize(
    "sentence",
    [
        "Stand the bottle up",
        "Stand up the bottle",
        "Stand the bottle upright",
        "Set the lying bottle upright",
        "Stand the fallen bottle up",
        "Stand the bottle that has fallen over up",
        "Stand the bottle up with its head up",
        "Turn the bottle the right way up",
        "Set the bottle on its bottom",
        "Pick up the bottle and stand it up",
        "Could you stand the bottle back up?",
        "Stand bottle up",
        "Stand the tipped over bottle up",
        "Stand the blue fallen bottle up",
        "Stand the bottle that is lying on its side up",
        "The bottle has fallen over. Stand it up",
        "A bottle has fallen over, stand it up",
        "The bottle fell over; set it upright",
        "The bottle has been knocked over so stand it up",
        "A bottle has fallen over. Stand the bottle up",
        "The bottle is lying on its side, so stand the bottle up",
    ],
)
def test_what_lies_is_stood_up(sentence: str) -> None:
    assert in_scene(sentence, "bottle/water", "plate/white", "can/corn") == ["1: bottle_water upright"]


@pytest.mark.parametrize(
    ("sentence", "goals"),
    [
        ("Put the fallen bottle upright on the plate", ["1: bottle_water on plate_white", "1: bottle_water upright"]),
        ("Place the bottle upright on the table", ["1: bottle_water on table", "1: bottle_water upright"]),
        ("Put the bottle upright next to the plate", ["1: bottle_water beside plate_white", "1: bottle_water upright"]),
        ("Stand the bottle and the can upright", ["1: bottle_water upright", "1: can_corn upright"]),
        ("Stand the bottle up on the plate", ["1: bottle_water on plate_white", "1: bottle_water upright"]),
        ("Stand up the can next to the plate", ["1: can_corn beside plate_white", "1: can_corn upright"]),
        ("Stand the bottle on the plate", ["1: bottle_water on plate_white"]),
        (
            "Stand the bottle up, then put the fallen bottle on the plate",
            ["1: bottle_water upright", "2: bottle_water on plate_white"],
        ),
    ],
)
def test_things_are_stood_up_where_they_are_to_stand(sentence: str, goals: list[str]) -> None:
    assert in_scene(sentence, "bottle/water", "plate/white", "can/corn") == goals


def test_that_a_thing_has_fallen_over_is_in_the_words_of_what_is_asked_next() -> None:
    sentence = "The bottle has fallen over. Stand it up, then put the can on the plate"
    found = read_goals(sentence, scene("bottle/water", "plate/white", "can/corn")).goals
    assert [asked.words for asked in found] == ["The bottle has fallen over. Stand it up", "put the can on the plate"]
    assert [asked.step for asked in found] == [1, 2]


def test_an_exception_is_not_stood_up() -> None:
    things = scene("bottle/water", "can/corn", "can/tomato", "plate/white")
    found = read_goals("Stand every can up except the red one", things)
    assert [str(asked.goal) for asked in found.goals] == ["can_corn upright"]
    assert found.untouched == ["can_tomato"]


@pytest.mark.parametrize(
    "sentence",
    [
        "Put the lying bottle on the plate",
        "Lift the fallen bottle",
        "Put the bottle that has fallen over on the plate",
        "Put the can next to the tipped over bottle",
        "Stand the can up, then put the plate next to the fallen bottle",
        "The bottle has fallen over. Put it on the plate",
        "The bottle has fallen over. Stand the can up",
    ],
)
def test_only_what_is_stood_up_is_called_lying(sentence: str) -> None:
    with pytest.raises(UnreadInstruction, match=r"bottle.* lies on its side at the start; say so, as in: stand it up"):
        in_scene(sentence, "bottle/water", "plate/white", "can/corn")


@pytest.mark.parametrize(
    "sentence",
    [
        "Hit the red block with the hammer",
        "Tap the red block with the hammer",
        "Use the hammer to strike the red block",
        "With the hammer, hit the red block",
        "Use the arm to grab the hammer and beat the red block",
        "Pick up the hammer and hit the red block with it",
        "Lift the hammer and hit the red block with it",
    ],
)
def test_a_tool_with_a_head_hits_a_thing(sentence: str) -> None:
    assert in_scene(sentence, "block/red", "hammer/red", "cup/white") == ["1: block_red hit"]


@pytest.mark.parametrize(
    "sentence",
    [
        "Wipe the tray with the sponge",
        "Wipe off the tray with the sponge",
        "Clean the tray with the sponge",
        "Use the sponge to wipe the tray",
        "With the sponge, wipe the tray",
        "Take the sponge and clean the tray with it",
        "Give the tray a wipe with the sponge",
    ],
)
def test_a_tool_with_a_pad_wipes_a_thing(sentence: str) -> None:
    assert in_scene(sentence, "tray/wood", "sponge/yellow", "cup/white") == ["1: tray_wood wiped"]


@pytest.mark.parametrize(
    ("sentence", "why"),
    [
        ("Wipe the tray with the cup", "cup_white is nothing to wipe with"),
        ("Wipe the tray", "say what to wipe it with, one tool such as the sponge"),
        ("Hold up the cup and wipe it with the sponge", "cup_white is held up, and only what stands there is wiped"),
        ("Wipe the table with the sponge", "'the table' .* as in: wipe the mat with the sponge"),
        ("Wipe the table", "'the table' .* as in: wipe the mat with the sponge"),
    ],
)
def test_what_is_not_wiped_is_refused_by_name(sentence: str, why: str) -> None:
    with pytest.raises(UnreadInstruction, match=why):
        in_scene(sentence, "tray/wood", "sponge/yellow", "cup/white")


@pytest.mark.parametrize("then", ["put it in the bowl", "shake it"])
def test_it_may_be_a_tool_or_what_was_wiped_also_where_no_hand_lifts_that(then: str) -> None:
    with pytest.raises(UnreadInstruction, match="it may be the plate or the sponge; name the one that is meant"):
        in_scene(f"Wipe the plate with the sponge and {then}", "plate/white", "sponge/yellow", "bowl/white")


def test_things_are_put_on_what_was_wiped_not_on_the_tool() -> None:
    things = ("plate/white", "sponge/yellow", "apple/red")
    assert in_scene("Wipe the plate with the sponge and put the apple on it", *things) == [
        "1: plate_white wiped",
        "1: apple_red on plate_white",
    ]


@pytest.mark.parametrize(
    "sentence",
    [
        "Pour the balls from the cup into the bowl",
        "Pour the balls out of the cup into the bowl",
        "Pour the balls into the bowl from the cup",
        "Pour the balls in the cup into the bowl",
        "Pick up the cup and pour the balls into the bowl",
    ],
)
def test_balls_are_poured_out_of_what_they_lie_in_at_the_start(sentence: str) -> None:
    reading = read_goals(sentence, scene("ball/red", "ball/blue", "cup/white", "bowl/green"))
    assert [str(asked.goal) for asked in reading.goals] == ["cup_white poured bowl_green"]
    assert [str(one) for one in reading.descriptions] == ["ball_red inside cup_white", "ball_blue inside cup_white"]


@pytest.mark.parametrize(
    "sentence",
    [
        "Pour the cup into the bowl",
        "Empty the cup into the bowl",
        "Tip the cup over into the bowl",
        "Dump the cup into the bowl",
        "Pour the contents of the cup into the bowl",
        "Pour what is in the cup into the bowl",
        "Pour everything in the cup into the bowl",
        "Pour everything out of the cup into the bowl",
        "Take the cup and pour everything in it into the bowl",
        "Take the cup and pour it into the bowl",
        "Pour the balls into the bowl",
    ],
)
def test_a_vessel_is_poured_with_all_that_lies_in_it(sentence: str) -> None:
    things, lying = scene("ball/red", "cup/white", "bowl/green"), {"ball_red": "cup_white"}
    reading = read_goals(sentence.replace("balls", "ball"), things, lying)
    assert [str(asked.goal) for asked in reading.goals] == ["cup_white poured bowl_green"]


@pytest.mark.parametrize(
    ("sentence", "why"),
    [
        ("Pour the cup into the bowl", "nothing is said to lie in cup_white; say what is poured out of it"),
        ("Pour the ball into the bowl", "say what they are poured out of, as in: from the cup"),
        ("Pour the apple from the cup into the bowl", "apple_red does not roll: only balls are poured"),
        ("Pour the plate into the bowl", "plate_white is no vessel that a hand takes and tips"),
        ("Pour the ball from the cup onto the plate", "things are poured into what is open at the top"),
        ("Pour everything into the bowl", "name it, as in: everything in the cup"),
        ("Pour everything on the plate into the bowl", "name it, as in: everything in the cup"),
        ("Put the ball in the bowl", "ball_red cannot be lifted"),
    ],
)
def test_what_is_not_poured_is_refused_by_name(sentence: str, why: str) -> None:
    with pytest.raises(UnreadInstruction, match=why):
        in_scene(sentence, "ball/red", "cup/white", "bowl/green", "apple/red", "plate/white")


@pytest.mark.parametrize(
    "sentence",
    [
        "Hang the mug on the mug rack",
        "Hang up the mug on the mug rack",
        "Hang the mug up on the rack",
        "Hang the mug onto the mug tree",
        "Hook the mug on the rack",
        "Take the mug and hang it on the mug rack",
        "Please hang the mug on the cup holder",
        "Hang up the mug",
        "Hang the mug up with the left arm",
    ],
)
def test_a_mug_is_hung_on_a_rack(sentence: str) -> None:
    assert in_scene(sentence, "mug/red", "mug_rack/wood", "apple/red") == ["1: mug_red hung_on mug_rack_wood"]


@pytest.mark.parametrize(
    ("sentence", "why"),
    [
        ("Hang the apple on the mug rack", "apple_red has no closed handle to hang it by"),
        ("Hang the cup on the mug rack", "cup_white has no closed handle to hang it by"),
        ("Hang the mug on the plate", "plate_white has no peg to hang something on"),
        ("Hang the mug on the top peg", "no goal says on which peg it hangs; .* as in: hang the mug on the mug rack"),
        ("Hang the mug on the pegs", "no goal says on which peg it hangs"),
        (
            "Put the mug on the mug rack",
            "nothing is put on a mug rack or hangs there at the start; a mug is hung on it: say hang",
        ),
        ("Put the mug on the plate, then hang it on the mug rack", "only what stands on the table is hung"),
        ("Hang the mug on the mug rack, then put it on the plate", "nothing more is done with what is hung"),
        ("Hang the mug on the mug rack and shake it", "nothing more is done with what is hung"),
        ("Hang the red, the blue and the white mug on the mug rack", "mug_rack_wood has 2 pegs"),
    ],
)
def test_what_does_not_hang_is_refused_by_name(sentence: str, why: str) -> None:
    mugs = "mug/red" if "blue" not in sentence else "mug/red mug/blue mug/white"
    with pytest.raises(UnreadInstruction, match=why):
        in_scene(sentence, *mugs.split(), "mug_rack/wood", "apple/red", "cup/white", "plate/white")


@pytest.mark.parametrize(
    "sentence",
    [
        "Insert the peg into the hole of the block",
        "Insert the peg into the hole in the block",
        "Put the peg in the peg block",
        "Put the red peg in the hole of the green peg block",
        "Push the peg into the hole",
        "Stick the peg in its hole",
        "Slide the peg into the hole of the peg block",
        "Plug the peg into the square hole",
        "Take the peg and insert it into the peg block",
    ],
)
def test_a_peg_is_inserted_in_a_hole(sentence: str) -> None:
    read = in_scene(sentence, "peg/red", "peg_block/green", "apple/red")
    assert read == ["1: peg_red inserted_in peg_block_green"]


@pytest.mark.parametrize(
    ("sentence", "why"),
    [
        ("Insert the mug into the hole", "mug_red is no peg that goes into a hole"),
        ("Insert the red and the blue peg into the hole", "peg_block_green has 1 hole to insert something in"),
        ("Insert the red and the blue peg", "name a peg block for each, as in: the red peg into the red peg block and"),
        (
            "Take the peg out of the peg block and insert it again",
            "nothing is in a hole at the start; leave out where",
        ),
        ("Take the peg from the hole and put it on the table", "nothing is in a hole at the start; leave out where"),
        ("Put the peg that is inside of the black peg block on the table", "nothing is in a hole at the start"),
        ("Put the peg that is in the peg block on the table", "nothing is in a hole at the start; leave out where"),
        ("Put the peg on the peg block", "nothing can be put on it"),
        ("Insert the peg into the apple", "nothing can be put in it"),
    ],
)
def test_what_is_not_inserted_is_refused_by_name(sentence: str, why: str) -> None:
    pegs = ["peg/red"] if "blue" not in sentence else ["peg/red", "peg/blue"]
    with pytest.raises(UnreadInstruction, match=why):
        in_scene(sentence, *pegs, "peg_block/green", "apple/red", "mug/red")


def test_the_way_that_is_named_where_a_peg_block_has_too_few_holes_is_read() -> None:
    with pytest.raises(
        UnreadInstruction, match="say which peg goes in which of them, as in: the red peg into"
    ) as caught:
        goals("Insert two pegs into two peg blocks")
    _, example = caught.value.message.split("as in: ")
    found = goals(f"Insert {example}")
    assert found == ["1: peg_red inserted_in peg_block_red", "1: peg_blue inserted_in peg_block_blue"]


def test_a_mug_beside_a_cup_is_no_cup_where_balls_are_poured() -> None:
    (found,) = goals("Pour the balls from the cup into the mug")
    assert found.startswith("1: cup_") and " poured mug_" in found


def test_the_block_that_a_peg_is_inserted_in_is_a_peg_block() -> None:
    assert goals("Put the red peg in the green block") == ["1: peg_red inserted_in peg_block_green"]
    assert goals("Take the peg and insert it in the block, then put the apple next to the block")[0].endswith(
        "inserted_in peg_block_black"
    )


@pytest.mark.parametrize("more", ["and put the red block on the plate", "then stack the three blocks"])
def test_the_block_is_no_peg_block_where_another_block_is_named(more: str) -> None:
    with pytest.raises(UnreadInstruction, match="it has no hole; say it by its full name, as in: in the peg block"):
        goals(f"Insert the peg in the block, {more}")


@pytest.mark.parametrize("verb", ["Push", "Press"])
@pytest.mark.parametrize(
    ("thing", "done"), [("the top drawer", "closed"), ("the button", "pressed"), ("the peg", "inserted_in")]
)
def test_what_is_pushed_in_is_closed_or_pressed_or_inserted(verb: str, thing: str, done: str) -> None:
    (found,) = goals(f"{verb} {thing} in")
    assert done in found and goals(f"{verb} in {thing}") == [found]


def test_it_that_is_pushed_in_may_be_what_was_opened() -> None:
    assert [goal.split()[-1] for goal in goals("Open the top drawer, then push it in")] == ["open", "closed"]
    assert goals("Open the top drawer and push the stapler in")[1].startswith("2: stapler_black inside")


def test_a_peg_is_still_put_in_a_bowl() -> None:
    assert in_scene("Insert the peg into the bowl", "peg/red", "bowl/green") == ["1: peg_red inside bowl_green"]


def test_a_cup_is_not_poured_out_in_part() -> None:
    things = scene("ball/red", "ball/blue", "cup/white", "bowl/green")
    lying = {"ball_red": "cup_white", "ball_blue": "cup_white"}
    with pytest.raises(UnreadInstruction, match="all that lies in cup_white is poured out of it, ball_blue too"):
        read_goals("Pour the red ball from the cup into the bowl", things, lying)


def test_what_is_no_vessel_is_dumped_where_it_should_go() -> None:
    assert in_scene("Dump the apple in the bowl", "apple/red", "bowl/white") == ["1: apple_red inside bowl_white"]


def test_the_arm_that_takes_the_tool_is_the_arm_of_the_hit() -> None:
    sentence = "Use the left arm to grab the hammer and beat the red block"
    reading = read_goals(sentence, scene("block/red", "hammer/red"))
    assert [(str(asked.goal), asked.arm) for asked in reading.goals] == [("block_red hit", "left")]


@pytest.mark.parametrize("then", ["turn it to face the robot", "hit the red block with it"])
def test_what_one_arm_has_put_down_is_used_by_the_same_unless_another_is_named(then: str) -> None:
    sentence = f"Pick up the hammer with the left arm, put it on the plate and {then}"
    reading = read_goals(sentence, scene("block/red", "hammer/red", "plate/white"))
    assert {asked.arm for asked in reading.goals} == {"left"}


def test_another_arm_may_take_again_what_one_has_put_down() -> None:
    sentence = (
        "Put the hammer on the plate with the left arm, then hit the red block with the hammer with the right arm"
    )
    reading = read_goals(sentence, scene("block/red", "hammer/red", "plate/white"))
    assert [(str(asked.goal), asked.arm) for asked in reading.goals] == [
        ("hammer_red on plate_white", "left"),
        ("block_red hit", "right"),
    ]


@pytest.mark.parametrize(("holder", "giver"), [("left", "right"), ("right", "left")])
def test_what_one_arm_picked_up_no_other_arm_hands_over(holder: str, giver: str) -> None:
    with pytest.raises(UnreadInstruction, match=f"the {holder} arm has apple_red; hand it to the {giver} arm before"):
        in_scene(
            f"Pick up the apple with the {holder} arm and hand it from the {giver} arm to the {holder} arm", "apple/red"
        )


def test_what_one_arm_picked_up_no_other_arm_puts_down() -> None:
    things = ("apple/red", "bowl/white")
    with pytest.raises(UnreadInstruction, match="the left arm has apple_red; hand it to the right arm before"):
        in_scene("Pick up the apple with the left arm and put it in the bowl with the right arm", *things)
    sentence = "Pick up the apple with the left arm and put it in the bowl"
    reading = read_goals(sentence, scene(*things))
    assert [asked.arm for asked in reading.goals] == ["left"]
    with pytest.raises(UnreadInstruction, match="the right arm has apple_red"):
        in_scene(
            "Hand the apple to the right arm with the left arm, then put it in the bowl with the left arm", *things
        )


@pytest.mark.parametrize(
    ("sentence", "why"),
    [
        ("Hit the red block with the cup", "cup_white has no head to hit with"),
        ("Pick up the cup and hit the red block", "cup_white has no head to hit with"),
        ("Hit the red block", "say what to hit it with"),
        ("Tap the red block", "say what to hit it with"),
        ("Hit the red block with the hammer and the cup", "it does not fit any form"),
        ("Hit the red block on the hammer", "it does not fit any form"),
        ("Pick up the hammer and put it in the cup, then hit the red block", "say what to hit it with"),
        ("Hold up the hammer and hit the red block with it", "leave out that it is held"),
        ("Hold up the red block and hit it with the hammer", "block_red is held up, and only what stands there is hit"),
        (
            "Use the left arm to grab the hammer and use the right arm to hit the red block",
            "the left arm has hammer_red",
        ),
    ],
)
def test_what_has_no_head_hits_nothing(sentence: str, why: str) -> None:
    with pytest.raises(UnreadInstruction, match=why):
        in_scene(sentence, "block/red", "hammer/red", "cup/white")


def test_one_tool_hits_and_which_of_several_is_not_said() -> None:
    for tools, why in {"two hammers": "one tool such as", "the left hammer": "which of hammer_1, hammer_2"}.items():
        things = scene("block/red", "hammer/red")
        two = {"block_red": things["block_red"], **dict.fromkeys(("hammer_1", "hammer_2"), things["hammer_red"])}
        with pytest.raises(UnreadInstruction, match=why):
            read_goals(f"Hit the red block with {tools}", two)


def test_a_tool_of_another_kind_than_the_named_one_may_not_do_it_instead() -> None:
    things = scene("block/red", "hammer/red")
    words = things["hammer_red"].words.model_copy(update={"name": "mallet", "plural": "mallets", "synonyms": []})
    mallet = things["hammer_red"].model_copy(update={"name": "mallet", "words": words})
    for sentence in ("Hit the red block with a hammer", "Pick up a hammer and hit the red block with it"):
        assert read_goals(sentence, things)
        with pytest.raises(UnreadInstruction, match="which of hammer_red, mallet_red it is hit with"):
            read_goals(sentence, {**things, "mallet_red": mallet})


@pytest.mark.parametrize(("verb", "done", "tool"), [("Hit", "hit", "hammer"), ("Wipe", "wiped", "sponge")])
def test_neither_a_part_nor_the_table_is_hit_or_wiped(verb: str, done: str, tool: str) -> None:
    with pytest.raises(UnreadInstruction, match=f"a part of a thing is {done}"):
        in_scene(f"{verb} the door of the microwave with the {tool}", "microwave/red", f"{tool}/red")
    with pytest.raises(UnreadInstruction, match="the table itself stays as it is"):
        read(f"{verb} the table with the {tool}")


def test_it_after_a_hit_may_be_the_tool_in_the_hand() -> None:
    things = ("block/red", "hammer/red", "packaging_box/brown")
    with pytest.raises(UnreadInstruction, match="it can mean two things"):
        in_scene("Take the hammer, hit the red block with it and put it in the box", *things)
    with pytest.raises(UnreadInstruction, match="it can mean two things"):
        in_scene("Hit the red block with the hammer and put it in the box", *things)


def test_a_hit_and_what_else_is_done_with_its_tool_are_done_as_said() -> None:
    things = ("block/red", "hammer/red", "packaging_box/brown")
    found = in_scene("Hit the red block with the hammer and put the hammer in the box", *things)
    assert [goal[:2] for goal in found] == ["1:", "2:"]


def test_counted_things_are_put_in_a_row_without_an_order() -> None:
    things = ("block/red", "block/green", "block/blue")
    assert len(in_scene("Line up the three blocks from left to right", *things)) == 2


def test_what_is_hung_beside_a_rack_is_refused() -> None:
    with pytest.raises(UnreadInstruction, match="hung on something, not beside"):
        in_scene("Hang the mug next to the mug rack", "mug/red", "mug_rack/wood")


def test_two_things_change_places_and_not_three() -> None:
    with pytest.raises(UnreadInstruction, match="two things change places"):
        in_scene("Swap the red block, the blue block and the plate", "block/red", "block/blue", "plate/white")


@pytest.mark.parametrize(
    "sentence",
    [
        "Swap the red block and the cup, then swap the cup and the apple",
        "Swap the red block and the cup, then swap the red block and the cup",
        "Put the red block on the plate, then swap the red block and the cup",
        "Put the red block on the plate and swap the cup with it",
    ],
)
def test_what_was_moved_before_is_not_swapped(sentence: str) -> None:
    with pytest.raises(UnreadInstruction, match="is moved before, and things change"):
        in_scene(sentence, "block/red", "apple/red", "plate/white", "cup/white")


def test_of_two_things_beside_each_other_the_one_that_can_be_carried_is_brought() -> None:
    things = ("microwave/red", "mug/red")
    assert in_scene("Put the microwave and the mug next to each other", *things) == ["1: mug_red beside microwave_red"]


@pytest.mark.parametrize("things", ["the red block, the cup and the plate", "the cup", "all the blocks"])
def test_only_two_things_are_put_beside_each_other(things: str) -> None:
    with pytest.raises(UnreadInstruction, match="of more say what goes beside which"):
        in_scene(f"Put {things} next to each other", "block/red", "cup/white", "plate/white")


@pytest.mark.parametrize(
    ("sentence", "goal"),
    [
        ("Put the small block on the block", "1: small_block_green on block_green"),
        ("Put the small blue block next to the blue block", "1: small_block_blue beside block_blue"),
        ("Put the electric stapler next to the stapler", "1: stapler_electric_black beside stapler_black"),
    ],
)
def test_a_thing_is_not_its_own_place(sentence: str, goal: str) -> None:
    kinds_named = [[name.rpartition("_")[0] for name in text.split()[1::2]] for text in (*goals(sentence), goal)]
    assert kinds_named[0] == kinds_named[1]


@pytest.mark.parametrize(
    ("sentence", "goals"),
    [
        (
            "Put the small block in the bowl and the big one on the plate",
            ["small_block inside bowl", "large_block on plate"],
        ),
        ("Put the block in the bowl and the smaller one on the plate", ["block inside bowl", "small_block on plate"]),
        ("Put the little cube on the large block", ["small_block on large_block"]),
        ("Put the apple in the big bowl", ["apple inside bowl"]),
        (
            "Put the block in the bowl and the small block on the tray, then put the bigger one on the plate",
            ["block inside bowl", "small_block on tray", "block on plate"],
        ),
    ],
)
def test_a_size_says_which_one(sentence: str, goals: list[str]) -> None:
    assert kinds_meant(sentence) == goals


@pytest.mark.parametrize(
    ("sentence", "why", "way"),
    [
        ("Put the apple in the huge bowl", "there is no 'huge bowl'", "sizes of the bowl: small, large"),
        ("Put the tiny apple in the bowl", "there is no 'tiny apple'", "one size"),
    ],
)
def test_a_size_that_no_thing_has_is_named_with_those_that_are(sentence: str, why: str, way: str) -> None:
    with pytest.raises(NoAssetFits, match=why) as refused:
        goals(sentence)
    assert way in refused.value.hint


@pytest.mark.parametrize(
    "sentence",
    [
        "Put the small one in the bowl",
        "Put the blocks on the tray, then put the small one in the bowl",
        "Put the block on the tray and the small block on the plate, then move the huge one away",
    ],
)
def test_the_small_one_of_unknown_things_is_refused(sentence: str) -> None:
    with pytest.raises(UnreadInstruction, match=r"one' in .* name the thing"):
        goals(sentence)


def test_what_was_swapped_may_be_put_elsewhere_then() -> None:
    things = ("block/red", "plate/white", "cup/white")
    goals = in_scene("Swap the red block and the cup, then put the red block on the plate", *things)
    assert goals[-1] == "2: block_red on plate_white"


@pytest.mark.parametrize("verb", ["Lift", "Shake", "Hold up", "Use both arms to lift"])
def test_what_no_hand_carries_is_not_lifted(verb: str) -> None:
    with pytest.raises(UnreadInstruction, match="cannot be lifted"):
        in_scene(f"{verb} the tap", "tap/chrome")


@pytest.mark.parametrize(
    "sentence",
    ["Keep the red block", "Hold the red block down", "Lift the red block down", "Put the red block away"],
)
def test_a_verb_of_the_air_with_another_meaning_is_refused(sentence: str) -> None:
    with pytest.raises(UnreadInstruction):
        in_scene(sentence, "block/red")


def test_between_after_put_is_a_place_and_no_goal() -> None:
    things = ("bowl/white", "plate/white", "mug/red", "tray/wood")
    with pytest.raises(UnreadInstruction, match="between"):
        in_scene("Put the bowl between the plate and the mug on the tray", *things)
    told = in_scene("Put the bowl that is between the plate and the mug on the tray", *things)
    assert told == ["1: bowl_white on tray_wood"]


def test_several_kinds_are_sorted_to_several_places() -> None:
    things = ("apple/red", "apple/green", "block/red", "packaging_box/brown", "plate/white")
    assert in_scene("Sort the apples into the box and the blocks onto the plate", *things) == [
        "1: apple_red inside packaging_box_brown",
        "1: apple_green inside packaging_box_brown",
        "1: block_red on plate_white",
    ]


def test_a_scale_is_not_everything_else() -> None:
    things = ("apple/red", "cup/white", "packaging_box/brown", "electronic_scale/blue")
    found = in_scene("Weigh the apple and put everything else in the box", *things)
    assert found == ["1: apple_red weighed", "1: cup_white inside packaging_box_brown"]


def test_a_thing_goes_to_the_left_plate() -> None:
    assert read("Move the apple to the left plate")[1].descriptions[0].relation == "left_of"


def test_an_exception_after_the_place_may_be_one_of_the_places() -> None:
    things = ("apple/red", "plate/white", "plate/blue")
    assert in_scene("Put the apple on a plate, not the white one", *things) == ["1: apple_red on plate_blue"]


@pytest.mark.parametrize(
    ("sentence", "why"),
    [
        ("Put the block on the plate", "nobody can tell which"),
        ("Put two of the three blocks on the plate", "nobody can tell which .* and how many"),
        ("Put the lemon on the plate", "nothing that is there is called so"),
        ("Put the red block on the plate and stir the soup", "'stir'"),
        ("Pick up the red block", "no goal by itself"),
        ("Put the red block in the corner of the table", "none that a goal can name"),
        ("Put the red block between the plate and the blue block", "between"),
        ("Use both arms to put the red block on the plate", "both arms"),
        ("Put the red block on the plate with the other arm", "say which arm"),
        ("Put the other one on the plate", "nothing that is there is called so"),
        ("Put the red block on the plate, no, sorry, the blue one", "correction"),
        ("Where is the red block?", "no plain statement"),
        ("Put the red block on the plate and leave the red block alone", "'leave'"),
        ("Put it on the plate", "what 'it' or 'them' means is open"),
        ("Before you put the red block on the plate, put it on the blue block", "what 'it' or 'them' means is open"),
        ("Put everything else on the plate", "nobody can tell which of block_red, block_blue is meant"),
        ("Use the left arm to put the red block on the plate and put the blue block on the plate", "which arm"),
    ],
)
def test_doubtful_or_unknown_wording_is_refused_with_a_reason(sentence: str, why: str) -> None:
    with pytest.raises(UnreadInstruction, match=why) as refused:
        read_goals(sentence, scene("block/red", "block/blue", "plate/white"))
    assert "--models agent" in refused.value.hint and "docs/instructions.md" in refused.value.hint


@pytest.mark.parametrize("after", ["then take it out", "take the apple out", "pick it up again", "then grab the apple"])
def test_a_thing_picked_up_after_it_was_placed_must_go_somewhere(after: str) -> None:
    things = scene("apple/red", "bowl/white")
    with pytest.raises(UnreadInstruction, match="picking up is no goal by itself"):
        read_goals(f"Put the apple in the bowl, {after}", things)


@pytest.mark.parametrize("where", ["off the cabinet", "from on top of the cabinet", "from the top of the cabinet"])
def test_what_is_taken_off_a_thing_lies_on_its_top(where: str) -> None:
    found = read_goals(f"Take the mug {where} and put it on the table", scene("mug/red", "cabinet_one_drawer/blue"))
    assert [str(one) for one in found.descriptions] == ["mug_red on cabinet_one_drawer_blue"]


@pytest.mark.parametrize(
    ("sentence", "words"),
    [
        ("Pick up the apple, then put it on the plate", "Pick up the apple, then put it on the plate"),
        ("Pick up the apple and the mug, put the mug on the plate, put the apple on the plate",
         "Pick up the apple and the mug and put the apple on the plate"),
    ],
    ids=["side by side", "with another between"],
)  # fmt: skip
def test_the_words_of_a_goal_begin_where_its_thing_is_taken(sentence: str, words: str) -> None:
    found = read_goals(sentence, scene("apple/red", "mug/red", "plate/white"))
    assert words in [asked.words for asked in found.goals]


def test_a_sentence_that_can_mean_two_things_is_refused_with_both() -> None:
    with pytest.raises(UnreadInstruction) as refused:
        read_goals("Put the apple in the bowl on the plate", scene("apple/red", "bowl/white", "plate/white"))
    assert "apple_red on plate_white, apple_red inside bowl_white at the start" in refused.value.message
    assert "apple_red inside bowl_white, bowl_white on plate_white at the start" in refused.value.message


def test_everything_in_a_bowl_is_not_the_bowl() -> None:
    things = scene("apple/red", "bowl/white", "plate/white")
    with pytest.raises(UnreadInstruction, match="two things"):
        read_goals("Put everything in the bowl on the plate", things)


def test_an_exception_among_the_parts_of_a_thing_is_refused() -> None:
    with pytest.raises(UnreadInstruction, match="name each part that is meant"):
        read_goals("Open all drawers except the top one", scene("cabinet_three_drawers/steel"))


def test_a_pronoun_that_may_be_either_is_refused() -> None:
    things = scene("mug/red", "bowl/white", "apple/red")
    with pytest.raises(UnreadInstruction, match="two things"):
        read_goals("Put the mug in the bowl, then move it next to the apple", things)


def test_several_places_take_one_thing_each() -> None:
    with pytest.raises(UnreadInstruction, match="takes 2"):
        in_scene("Put the padlock in the drawers of the cabinet", "padlock/brass", "cabinet_two_drawers/white")


@pytest.mark.parametrize(
    "sentence",
    [
        "Put the red and blue blocks in the bowl",
        "Put the apple in the bowl and put it on the plate",
        "Put the apple in the bowl and the block on the plate with the right arm",
    ],
)
def test_an_ambiguous_instruction_is_refused(sentence):
    with pytest.raises(UnreadInstruction):
        read_goals(sentence, scene("block/red", "block/blue", "apple/red", "bowl/white", "plate/white"))


@pytest.mark.parametrize("side", ["on the left", "on the right", "in the middle", "at the front", "at the back"])
def test_a_side_after_a_noun_says_which_one_is_picked_up(side: str) -> None:
    chosen, reading = read(f"Pick up the white bowl {side} and put it in the tray")
    assert [o.asset for o in chosen.objects].count("bowl") == (3 if "middle" in side else 2)
    (asked,) = reading.goals
    assert {found.subject for found in reading.descriptions} == {asked.goal.subject}


def relations(sentence: str) -> list[str]:
    """Descriptions of a sentence with kinds in place of ids."""
    chosen, reading = read(sentence)
    named = {o.id: o.asset for o in name_objects(chosen, kinds())} | {"table": "table"}
    return [f"{named[d.subject]} {d.relation} {named[d.reference]}" for d in reading.descriptions]


def kinds_meant(sentence: str) -> list[str]:
    """The goals of a sentence with kinds in place of ids."""
    chosen, reading = read(sentence)
    named = {o.id: o.asset for o in name_objects(chosen, kinds())} | {"table": "table"}
    return [f"{named[a.goal.subject]} {a.goal.relation} {named[str(a.goal.reference)]}" for a in reading.goals]


def test_both_of_two_things_are_one_of_each() -> None:
    assert kinds_meant("Put both the lemon and the apple in the basket") == [
        "lemon inside basket",
        "apple inside basket",
    ]
    assert len(goals("Put both mugs in the basket")) == 2
    assert len(goals("Put both the red and the blue block in the basket")) == 2
    assert len(goals("Put both the two blocks in the basket")) == 2


@pytest.mark.parametrize("things", ["the blocks", "three blocks", "the red block, the green block and the blue block"])
def test_a_row_is_in_the_order_that_is_said(things: str) -> None:
    found = goals(f"Arrange {things} in the order of green, red and blue from left to right")
    assert found == ["1: block_green row_left_of block_red", "1: block_red row_left_of block_blue"]


def test_an_order_of_other_things_than_those_named_is_refused() -> None:
    with pytest.raises(UnreadInstruction, match="not one of the things that are named"):
        goals("Arrange the two blocks in the order of green, red and blue from left to right")


def test_where_a_thing_stands_says_which_one_and_is_no_step() -> None:
    sentence = "Pick the white mug {} and place it on the tray"
    assert relations(sentence.format("on the cabinet"))[0].startswith("mug on cabinet")
    assert relations(sentence.format("next to the cookie box")) == ["mug beside cookie_box"]
    assert relations(sentence.format("that is behind the plate")) == ["mug behind plate"]
    assert all(len(goals(sentence.format(where))) == 1 for where in ("on the cabinet", "next to the cookie box"))


@pytest.mark.parametrize(
    ("sentence", "goals"),
    [
        ("Grab the stamp and stamp onto the red mat", ["stamp on coloured_mat"]),
        (
            "Build a two-block stack at the center by placing the red block first and the green block on red",
            ["block centred None", "block on block"],
        ),
        ("Put the bottle into the dustbin on the left of the table", ["bottle inside dustbin"]),
        ("Pick up two different bottles, one in each hand", ["bottle held_up None", "bottle held_up None"]),
        (
            "Use one arm to hold the cup while the other arm puts the apple on the plate",
            ["cup held_up None", "apple on plate"],
        ),
    ],
)
def test_other_ways_to_say_it_are_read(sentence: str, goals: list[str]) -> None:
    chosen, reading = read(sentence)
    named = {o.id: o.asset for o in name_objects(chosen, kinds())} | {"table": "table"}
    found = [(named[a.goal.subject], a.goal.relation, named.get(str(a.goal.reference))) for a in reading.goals]
    assert [" ".join(map(str, one)) for one in found] == goals


def test_a_stack_of_more_things_than_are_named_is_refused() -> None:
    with pytest.raises(UnreadInstruction, match="not one of the things that are named"):
        goals("Build a three-block stack by placing the red block first and the green block on red")


def test_only_a_stamp_stamps() -> None:
    with pytest.raises(UnreadInstruction, match="is no stamp"):
        goals("Grab the apple and stamp onto the red mat")


def test_between_two_things_is_right_of_the_first_and_left_of_the_other() -> None:
    found = relations("Take the lemon between the plate and the mug and put it in the bowl")
    assert found == ["lemon right_of plate", "lemon left_of mug"]


@pytest.mark.parametrize(
    ("where", "word"),
    [
        ("from the center of the table", "center"),
        ("from table centre", "center"),
        ("on the left side of the table", "left_of"),
        ("at the back of the table", "behind"),
    ],
)
def test_a_third_of_the_table_says_where_a_thing_stands(where: str, word: str) -> None:
    assert relations(f"Pick up the mug {where} and put it on the tray") == [f"mug {word} table"]


def test_the_middle_one_goes_on_the_back_one() -> None:
    sentence = "Stack the middle white bowl on the back white bowl"
    assert sorted(relations(sentence)) == ["bowl behind bowl"] * 3 + ["bowl in_front_of bowl"]
    assert kinds_meant(sentence) == ["bowl inside bowl"]


def test_a_stack_goes_where_its_lowest_thing_goes() -> None:
    _, reading = read("Stack the left bowl on the right bowl and place them in the tray")
    stacked, placed = (asked.goal for asked in reading.goals)
    assert (stacked.relation, placed.relation) == ("inside", "on") and placed.subject == stacked.reference


def test_on_top_of_it_is_on_what_the_drawer_belongs_to() -> None:
    _, reading = read("Close the top drawer of the cabinet and put the white bowl on top of it")
    closed, placed = (asked.goal for asked in reading.goals)
    assert (placed.relation, placed.reference, placed.part) == ("on", closed.subject, None)


def test_two_colours_of_one_thing_are_not_two_things() -> None:
    with pytest.raises(NoAssetFits, match="purple and white mug"):
        read("Put the purple and white mug on the plate")


def test_a_look_with_two_colours_in_its_name_is_meant_by_both_only() -> None:
    (mug,) = [entry for entry in kinds() if entry.name == "mug"]
    looks = [mug.variants[0].model_copy(update={"id": name, "colour": c}) for name, c in TWO_COLOURED.items()]
    entry = mug.model_copy(update={"variants": looks})
    assert [v.id for v in best_looks(["mug"], "white", entry)[1]] == ["white", "blue"]
    assert [v.id for v in best_looks(["mug"], "white and yellow", entry)[1]] == ["yellow_and_white"]
    assert all(look.painted for look in best_looks(["mug"], "yellow", entry)[1])


def test_the_other_arm_is_the_one_that_was_not_named() -> None:
    _, handed = read("Use one arm to grasp the hammer and hand it over to the other arm")
    assert [(asked.goal.reference, asked.arm) for asked in handed.goals] == [("right", None)]
    _, each = read("Use the left arm to put the apple in the bowl and the other arm to put the lemon on the plate")
    assert [asked.arm for asked in each.goals] == ["left", "right"]


def test_an_empty_thing_is_one_that_nothing_lies_in() -> None:
    assert kinds_meant("Place the empty cup on the plate") == ["cup on plate"]


def test_a_wooden_look_is_one_of_a_wood() -> None:
    chosen, _ = read("Open the top drawer of the wooden cabinet")
    assert {o.variant for o in chosen.objects if o.asset.startswith("cabinet")} <= {"oak", "walnut"}


def test_the_centre_of_the_table_is_a_place_and_says_where_a_thing_stands() -> None:
    assert goals("Put the red block in the middle of the table") == ["1: block_red centred"]
    assert relations("Pick up the red block from the middle of the table and put it on the tray") == [
        "block center table"
    ]


def test_things_that_are_all_named_by_their_colours_are_no_others() -> None:
    sentence = "Move the blocks to the center of the table, and stack the green block on the red block"
    assert sorted(goals(sentence)) == ["1: block_green centred", "1: block_red centred", "2: block_green on block_red"]


@pytest.mark.parametrize(
    "sentence", ["Two cans have fallen over. Stand the cans up", "The cans have fallen over. Stand them up"]
)
def test_things_told_as_fallen_are_those_that_are_stood_up(sentence: str) -> None:
    assert len(goals(sentence)) == 2


def test_several_things_that_are_named_again_are_the_same() -> None:
    assert goals("Take two apples and put the apples in the basket") == [
        "1: apple_red inside basket_natural", "1: apple_green inside basket_natural"
    ]  # fmt: skip


@pytest.mark.parametrize("what", ["everything in the cup", "the contents of the cup", "the balls from the cup"])
def test_an_exception_of_what_is_poured_is_refused(what: str) -> None:
    with pytest.raises(UnreadInstruction, match="all that lies in a vessel is poured; leave the exception out"):
        goals(f"Pour {what} into the bowl except the red ball")
