"""What one arm must reach all of."""

from __future__ import annotations

from tests.example_scenes import thing
from vcage.schema.goals import Goal
from vcage.tasks.one_arm import for_one_arm

BAR, SCALE, SCANNER = thing("chocolate_bar"), thing("electronic_scale"), thing("barcode_scanner")
BLOCK, PLATE, SIGN = thing("block"), thing("plate"), thing("payment_sign")
OBJECTS = [BAR, SCALE, SCANNER, BLOCK, PLATE, SIGN]


def goal(subject: str, relation: str, reference: str | None = None) -> Goal:
    return Goal(subject=subject, relation=relation, reference=reference)  # pyrefly: ignore


def test_what_is_weighed_and_scanned_is_in_one_group_with_scale_and_scanner():
    goals = [goal(BAR.id, "weighed"), goal(BAR.id, "scanned"), goal(SIGN.id, "presented")]
    assert for_one_arm(OBJECTS, goals) == [{BAR.id, SCALE.id, SCANNER.id}]


def test_what_is_put_on_a_plate_may_change_hands():
    assert for_one_arm(OBJECTS, [goal(BLOCK.id, "on", PLATE.id)]) == []


def test_what_is_stacked_may_not():
    other = thing("block", id="block_2")
    assert for_one_arm([*OBJECTS, other], [goal(other.id, "on", BLOCK.id)]) == [{other.id, BLOCK.id}]


def test_things_that_have_nothing_to_do_with_each_other_are_apart():
    other = thing("block", id="block_2")
    goals = [goal(other.id, "on", BLOCK.id), goal(BAR.id, "weighed")]
    assert sorted(map(sorted, for_one_arm([*OBJECTS, other], goals))) == [["block", "block_2"], [BAR.id, SCALE.id]]
