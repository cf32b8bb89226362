"""The prompt of a sub-task for a model with vision."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import get_args

import numpy as np
import pytest

from tests.models.tabletop import BOX, MARKERS, critic_question
from vcage.goals import KINDS
from vcage.goals.thresholds import THRESHOLDS
from vcage.models import llm_critic
from vcage.models.exchange import Question, Reply
from vcage.models.llm_critic import Judgement, LlmCritic, _still, _verdict
from vcage.models.structured import flat_schema
from vcage.schema.episodes import Failure, Verdict
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Statement

PHRASES = {"box": "red box", "cabinet": "white cabinet"}


def test_the_answer_may_name_every_failure_that_a_retry_heeds() -> None:
    allowed = flat_schema(Judgement)["properties"]["failure"]["enum"]
    assert {*allowed, "disturbed"} == {"none", "other", *get_args(Failure)}, "also_moved tells what was disturbed"


@pytest.mark.parametrize(
    ("accepted", "failure", "told"),
    [(False, "astray", "astray"), (False, "other", None), (False, "none", None), (True, "none", None)],
)
def test_only_a_no_has_a_failure_reason(accepted: bool, failure: str, told: Failure | None) -> None:
    verdict = _verdict([judgement("yes" if accepted else "no", failure)], "test", PHRASES)
    assert verdict == Verdict(accepted=accepted, reason="seen", confidence=0.9, provider="test", failure=told)


def judgement(done: str, failure: str = "none", also_moved: Sequence[str] = ()) -> Judgement:
    said = {"observations": "", "done": done, "failure": failure, "reason": "seen", "confidence": 0.9}
    return Judgement.model_validate({**said, "also_moved": list(also_moved)})


@pytest.mark.parametrize(
    ("done", "failure", "told"), [("yes", "none", "disturbed"), ("no", "lost", "lost"), ("no", "other", "disturbed")]
)
def test_another_moved_object_makes_it_a_no(done: str, failure: str, told: Failure) -> None:
    verdict = _verdict([judgement(done, failure, ["cabinet"])], "test", PHRASES)
    assert (verdict.accepted, verdict.failure) == (False, told)
    assert verdict.reason == "seen (also moved: the white cabinet)"


def test_one_vote_that_saw_something_else_move_is_no_yes() -> None:
    said = [judgement("yes"), judgement("yes", also_moved=["cabinet"]), judgement("yes")]
    verdict = _verdict(said, "test", PHRASES)
    assert verdict.accepted and verdict.reason.startswith("2 of 3 votes are a yes")


class Says:
    """Gives the same answers to each question, one after the other."""

    provider = "test"

    def __init__(self, *said: Judgement):
        self.said = list(said)
        self.asked: list[Question] = []

    def answer(self, question: Question) -> Reply:
        self.asked.append(question)
        return Reply(self.said[len(self.asked) - 1].model_dump_json())


def asked_about(*goals: Goal) -> str:
    """The prompt about some goals of a box and a marker."""
    who, things = Says(judgement("yes")), [BOX, MARKERS[0]]
    LlmCritic(who).judge(replace(critic_question(things, things, goals[0]), goals=goals))
    return who.asked[0].messages[0].text


def test_an_object_of_the_step_cannot_be_moved_besides() -> None:
    goal, things = Goal(subject="black-marker", relation="inside", reference="box"), [BOX, MARKERS[0]]
    who = Says(judgement("yes", also_moved=["black-marker"]), judgement("yes", also_moved=["box"]))
    verdict = LlmCritic(who).judge(critic_question(things, things, goal))
    assert not verdict.accepted and verdict.failure == "disturbed"
    assert "also_moved: black-marker is what the step moves" in who.asked[1].messages[-1].text


DEFINED = {
    "inside": "Inside or on an object", "on": "Inside or on an object", "left_of": "Left of, ", "right_of": "Left of, ",
    "in_front_of": "Left of, ", "behind": "Left of, ", "beside": "Beside", "near": "Near", "open": "Open, turned",
    "turned": "Open, turned", "closed": "Closed", "pressed": "Pressed", "weighed": "Weighed", "scanned": "Scanned",
    "presented": "Presented", "handed": "Handed", "back": "Back", "centred": "Centred",
    "facing_robot": "Facing the robot", "held_by_both": "Held by both", "held_up": "Held up", "lifted": "Lifted",
    "moved_away": "Moved away",
    "row_left_of": "Left of in a row", "in_place_of": "In place of", "shaken": "Shaken", "turned_back": "Turned back",
    "hit": "Hit: ", "wiped": "Wiped: ", "poured": "Poured: ", "upright": "Upright: ", "hung_on": "Hung on: ",
    "inserted_in": "Inserted in: ",
}  # fmt: skip
"""How the definition of a word begins."""


@pytest.mark.parametrize("word", sorted(KINDS))
def test_only_the_words_in_question_are_defined(word: str) -> None:
    of_part = {"part": "lid"} if KINDS[word].acts_on else {}
    of_two = {"reference": "left" if word == "handed" else "black-marker"} if KINDS[word].refers_to else {}
    prompt = asked_about(Goal(subject="box", relation=word, **of_part, **of_two))
    begun = {start for start in {*DEFINED.values(), "On the table"} if f"\n- {start}" in prompt}
    assert begun == {DEFINED[word]} and "\n- Also moved: " in prompt


def test_on_the_table_has_a_meaning_of_its_own() -> None:
    prompt = asked_about(Goal(subject="box", relation="on", reference="table"))
    assert "touches no object but what lies in or on it" in prompt and "Inside or on an object" not in prompt


def test_the_limits_match_the_judge_of_the_simulator_state(monkeypatch: pytest.MonkeyPatch) -> None:
    scanned = Goal(subject="box", relation="scanned")
    assert "more than 5 cm or tipped by\n  more than 30°" in asked_about(scanned)
    limits = replace(THRESHOLDS, disturbed_m=0.123, scanned_s=0.75, code_slant_rad=np.radians(41))
    monkeypatch.setattr(llm_critic, "THRESHOLDS", limits)
    prompt = asked_about(scanned)
    assert all(told in prompt for told in ("more than 12.3 cm", "for 0.75 s", "within 41°"))


def test_unsure_is_a_no_and_says_so():
    verdict = _verdict([judgement("unsure")], "test", PHRASES)
    assert (verdict.accepted, verdict.reason) == (False, "unsure, which is a no: seen")


class Votes:
    """Gives each vote its own answer."""

    provider = "test"

    def __init__(self, *said: str):
        self.said = said
        self.asked: list[Question] = []

    def answer(self, question: Question) -> Reply:
        self.asked.append(question)
        return Reply(judgement(self.said[question.vote - 1]).model_dump_json())


@pytest.mark.parametrize(
    ("said", "accepted", "asked"),
    [
        (("yes", "yes", "no"), True, 2),
        (("no", "yes", "yes"), True, 3),
        (("yes", "unsure", "no"), False, 3),
        (("no", "unsure", "yes"), False, 2),
        (("yes", "no"), False, 2),
        (("yes", "yes", "no", "no"), False, 4),
    ],
)
def test_more_than_half_of_the_votes_must_be_a_yes_and_no_more_are_asked_than_decide(said, accepted, asked):
    who = Votes(*said)
    things, goal = [BOX, MARKERS[0]], Goal(subject="black-marker", relation="inside", reference="box")
    verdict = LlmCritic(who, len(said)).judge(critic_question(things, things, goal))
    assert verdict.accepted is accepted
    assert len({question.hash for question in who.asked}) == len(who.asked) == asked
    assert f"of {asked} votes" in verdict.reason and verdict.provider == f"test, {len(said)} votes"


@pytest.mark.parametrize(
    ("statement", "words"),
    [
        (Statement(subject="box", word="unmoved"), "the red box has not moved"),
        (
            Statement(subject="cabinet", word="closed", part="drawer_top"),
            "the top drawer of the white cabinet is still closed",
        ),
        (
            Statement(subject="box", word="inside", reference="cabinet"),
            "the red box is still inside the white cabinet",
        ),
    ],
)
def test_unchanged_facts_are_put_into_words(statement: Statement, words: str) -> None:
    assert _still(statement, PHRASES) == words


def test_unchanged_facts_have_a_section_of_their_own() -> None:
    goal = Goal(subject="black-marker", relation="inside", reference="box")
    question = critic_question([BOX, *MARKERS], [BOX, *MARKERS], goal)
    prompts = []
    for statements in ([], [Statement(subject="box", word="unmoved")]):
        who = Recorder()
        LlmCritic(who).judge(replace(question, statements=statements))
        prompts.append(who.prompt)
    without, told = prompts
    assert "must have stayed as it was" not in without
    assert "must have stayed as it was" in told and "- the box has not moved" in told.splitlines()


class Recorder:
    """Says no, and keeps the prompt."""

    provider, prompt = "test", ""

    def answer(self, question: Question) -> Reply:
        self.prompt = question.messages[0].text
        return Reply(judgement("no", "lost").model_dump_json())
