"""Filling the slots of sub-tasks by a model: its input, and the complaint about an unknown name."""

from __future__ import annotations

import json
from typing import Any

import pytest

from vcage.base.errors import ModelRefused
from vcage.models.exchange import Question, Reply
from vcage.models.llm_reasoner import LlmReasoner
from vcage.schema.subtasks import GraspOption, PlaceOption, Preference, SlotQuestion, Statement

MUG_UNMOVED = Statement(subject="mug", word="unmoved")
TOP_CLOSED = Statement(subject="cabinet", word="closed", part="drawer_top")


def option(contact: int, arm: str) -> GraspOption:
    return GraspOption(contact=contact, name=f"side {contact}", arm=arm)


BOTH = [option(0, "left"), option(1, "right")]


COIN = SlotQuestion(
    subtask="coin-into-tray-0",
    text="Put the coin into the tray.",
    held="gold coin",
    grasps=BOTH,
    places=[
        PlaceOption(point=0, name="left cup", subtask="coin-into-tray-0", grasps=BOTH),
        PlaceOption(point=2, name="right cup", subtask="coin-into-tray-2", grasps=[option(1, "right")]),
    ],
    statements=[MUG_UNMOVED, TOP_CLOSED],
)
OPEN = SlotQuestion(
    subtask="open-cabinet-drawer_low",
    text="Open the low drawer of the cabinet.",
    held="white cabinet",
    grasps=[option(4, "right")],
    statements=[TOP_CLOSED],
)


class Scripted:
    """Answers with the given entries, one list per round, and keeps what it was sent."""

    provider = "script"

    def __init__(self, *answers: list[dict[str, Any]]):
        self.answers, self.asked = list(answers), list[Question]()

    def answer(self, question: Question) -> Reply:
        self.asked.append(question)
        return Reply(json.dumps({"steps": self.answers.pop(0)}))

    @property
    def complaint(self) -> str:
        return self.asked[-1].messages[-1].text


def step(question: SlotQuestion, **says: Any) -> dict[str, Any]:
    nothing = {"grasp": "none", "place": "none", "statements": [], "reason": "so"}
    return {"subtask": question.subtask, **nothing, **says}


def test_the_prompt_names_every_grasp_place_and_statement():
    who = Scripted([step(COIN), step(OPEN)])
    LlmReasoner(who).fill_slots("Put the coin into the tray", [COIN, OPEN])
    text = who.asked[0].messages[0].text
    for line in (
        "## 1. `coin-into-tray-0`: Put the coin into the tray.",
        "- `1 right`: at its side 1, with the right arm",
        "- `2`: right cup; grasps for it: 1 right",
        "- `mug unmoved`",
        "## 2. `open-cabinet-drawer_low`: Open the low drawer of the cabinet.",
        "- `cabinet/drawer_top closed`",
    ):
        assert line in text.splitlines(), line


def test_no_opinion_leaves_everything_to_the_ranking():
    coin, drawer = LlmReasoner(Scripted([step(COIN), step(OPEN)])).fill_slots("…", [COIN, OPEN])
    assert (coin.subtask, drawer.subtask) == (COIN.subtask, OPEN.subtask)
    assert (coin.grasp, coin.point, coin.statements) == (None, None, [])


def test_choices_come_back_as_records():
    says = {"grasp": "1 right", "place": "2", "statements": ["cabinet/drawer_top closed"]}
    coin, _ = LlmReasoner(Scripted([step(COIN, **says), step(OPEN)])).fill_slots("…", [COIN, OPEN])
    assert coin.grasp == Preference(contact=1, arm="right")
    assert (coin.point, coin.statements) == (2, [TOP_CLOSED])


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ({"grasp": "7 left"}, "steps.0.grasp: Input should be 'none', '0 left', '1 right' or '4 right'"),
        ({"place": "9"}, "steps.0.place: Input should be 'none', '0' or '2'"),
        ({"statements": ["spoon unmoved"]}, "steps.0.statements.0: Input should be 'none', 'mug unmoved'"),
        ({"grasp": "4 right"}, "4 right is no grasp of coin-into-tray-0: it has 0 left, 1 right"),
        ({"grasp": "0 left", "place": "2"}, "0 left is no grasp at place 2 of coin-into-tray-0: it has 1 right"),
    ],
)
def test_unknown_objects_are_complained_about_by_name(wrong: dict[str, Any], told: str):
    who = Scripted([step(COIN, **wrong), step(OPEN)], [step(COIN), step(OPEN)])
    LlmReasoner(who).fill_slots("…", [COIN, OPEN])
    assert told in who.complaint


def test_a_place_or_statement_of_another_step_is_complained_about():
    who = Scripted([step(COIN), step(OPEN, place="2", statements=["mug unmoved"])], [step(COIN), step(OPEN)])
    LlmReasoner(who).fill_slots("…", [COIN, OPEN])
    assert "steps.1.place: 2 is no place of open-cabinet-drawer_low: it has none" in who.complaint


def test_every_step_must_be_answered_in_order():
    who = Scripted([step(OPEN), step(COIN)], [step(COIN)], [step(COIN), step(OPEN)])
    assert len(LlmReasoner(who).fill_slots("…", [COIN, OPEN])) == 2
    assert "one entry each for coin-into-tray-0, open-cabinet-drawer_low" in who.complaint


def test_three_wrong_answers_are_a_refusal_that_names_them():
    who = Scripted(*[[step(COIN, grasp="4 right"), step(OPEN)]] * 3)
    with pytest.raises(ModelRefused, match="4 right is no grasp of coin-into-tray-0"):
        LlmReasoner(who).fill_slots("…", [COIN, OPEN])


def test_a_chain_is_asked_about_in_one_exchange_and_a_long_list_in_batches():
    many = [COIN.model_copy(update={"subtask": f"coin-{i}"}) for i in range(21)]
    who = Scripted([step(q) for q in many[:-1]], [step(many[-1])])
    assert [a.subtask for a in LlmReasoner(who).fill_slots(None, many)] == [q.subtask for q in many]
    assert len(who.asked) == 2
