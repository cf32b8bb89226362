from __future__ import annotations

from vcage.plans.actions import Action, lasting, overrides
from vcage.schema.goals import Goal

PEN, CUP = Goal(subject="pen", relation="on", reference="table"), Goal(subject="cup", relation="on", reference="table")
IN_CUP = Goal(subject="pen", relation="inside", reference="cup")
OPEN, CLOSED = (Goal(subject="box", relation=word, part="lid") for word in ("open", "closed"))
PUT = Action("put", frozenset(), frozenset([IN_CUP]), moves="pen")


def test_a_thing_is_in_one_place_at_a_time() -> None:
    assert PUT.after(frozenset([PEN, CUP])) == {IN_CUP, CUP}


def test_a_part_is_open_or_closed() -> None:
    shut = Action("close", frozenset([OPEN]), frozenset([CLOSED]))
    assert shut.after(frozenset([OPEN, PEN])) == {CLOSED, PEN}
    assert shut.obstacle(frozenset([CLOSED])) == "box/lid open must be true first"


def test_a_support_in_use_is_not_carried_away() -> None:
    move = Action("move", frozenset(), frozenset([Goal(subject="cup", relation="on", reference="tray")]), moves="cup")
    assert move.obstacle(frozenset([IN_CUP, CUP])) == "pen must be taken off cup first"
    assert move.obstacle(frozenset([PEN, CUP])) == ""


def test_finished_goals_stay_finished() -> None:
    scanned = Goal(subject="pen", relation="scanned")
    assert scanned in PUT.after(frozenset([PEN, CUP, scanned]))


def test_two_drawers_do_not_exclude_each_other() -> None:
    top, bottom = (Goal(subject="cabinet", relation=w, part=p) for w, p in (("open", "top"), ("closed", "bottom")))
    assert not overrides(top, bottom)
    assert overrides(top, top.model_copy(update={"relation": "closed"}))


def test_the_last_of_two_successive_places_is_final() -> None:
    on_tray = Goal(subject="pen", relation="on", reference="tray")
    assert lasting([[IN_CUP, OPEN], [on_tray], [CLOSED]]) == [on_tray, CLOSED]


def test_contents_move_along_where_they_may() -> None:
    on_tray = Goal(subject="cup", relation="on", reference="tray")
    beside = Goal(subject="pen", relation="left_of", reference="plate")
    move = Action("move", frozenset(), frozenset([on_tray]), moves="cup", along=True)
    assert move.obstacle(frozenset([IN_CUP, CUP])) == ""
    assert move.after(frozenset([IN_CUP, CUP, beside])) == {IN_CUP, on_tray}


def test_objects_on_contents_move_along_and_objects_on_the_container_do_not() -> None:
    on_tray = Goal(subject="cup", relation="on", reference="tray")
    cap, lid = (Goal(subject=name, relation="on", reference=on) for name, on in (("cap", "pen"), ("lid", "cup")))
    move = Action("move", frozenset(), frozenset([on_tray]), moves="cup", along=True)
    assert move.after(frozenset([IN_CUP, CUP, cap])) == {IN_CUP, cap, on_tray}
    assert move.obstacle(frozenset([IN_CUP, CUP, lid])) == "lid must be taken off cup first"


HELD, MUG_HELD = (Goal(subject=name, relation="held_up") for name in ("cup", "mug"))


def test_the_other_hand_acts_while_one_holds_something_up() -> None:
    put = Action("put", frozenset(), frozenset([IN_CUP]), moves="pen", object="pen", spare=1)
    assert put.obstacle(frozenset([PEN, HELD])) == ""
    assert put.after(frozenset([PEN, HELD])) == {IN_CUP, HELD}


def test_no_hand_is_left_where_each_holds_something_up() -> None:
    put = Action("put", frozenset(), frozenset([IN_CUP]), moves="pen", object="pen", spare=1)
    assert put.obstacle(frozenset([PEN, HELD, MUG_HELD])) == "it takes the hand that holds cup or mug"
    assert PUT.obstacle(frozenset([PEN, HELD])) == "it takes the hand that holds cup"


def test_what_is_held_up_is_not_taken_again() -> None:
    move = Action("move", frozenset(), frozenset([CUP]), moves="cup", object="cup", spare=1)
    assert move.obstacle(frozenset([HELD])) == "cup is in a hand"


def test_a_place_is_taken_only_when_it_is_left() -> None:
    swap = Goal(subject="pen", relation="in_place_of", reference="cup")
    put = Action("put", frozenset(), frozenset([swap]), moves="pen", vacant="cup")
    stands = Goal(subject="cup", relation="back")
    assert put.obstacle(frozenset([stands])) == "cup must leave its place first"
    assert put.obstacle(frozenset([PEN])) == ""
    move = Action("move", frozenset(), frozenset([CUP]), moves="cup")
    assert move.after(frozenset([swap, stands])) == {swap, CUP}


def test_what_is_poured_out_of_a_vessel_lies_in_the_other_then() -> None:
    poured = Goal(subject="cup", relation="poured", reference="bowl")
    pour = Action("pour", frozenset(), frozenset([poured]), pours=("cup", "bowl"))
    here = Goal(subject="pen", relation="back")
    in_bowl = Goal(subject="pen", relation="inside", reference="bowl")
    assert pour.after(frozenset([IN_CUP, CUP, here])) == {poured, in_bowl, CUP}
