"""Kinds of goals hold together: with each other, with the critic, and with what people are told."""

from __future__ import annotations

import pytest

from vcage.goals import KINDS, PROMPT_WIDTH, forms, kind_of, meanings, words, written_forms
from vcage.goals.kind import GoalKind
from vcage.goals.thresholds import THRESHOLDS
from vcage.models.rules.evidence import EVIDENCE
from vcage.schema.goals import Goal
from vcage.tasks.wording import worded


def goal_of_kind(kind: GoalKind, reference: str = "box") -> Goal:
    """A goal of a kind about a pen or a drawer."""
    part = "drawer_top" if kind.part_of == "subject" else None
    names = {None: None, "object": reference, "arm": "left"}
    return Goal(subject="pen", relation=kind.word, reference=names[kind.refers_to], part=part)


@pytest.mark.parametrize("kind", KINDS.values(), ids=list(KINDS))
def test_the_offline_critic_has_the_evidence_that_a_kind_names(kind: GoalKind) -> None:
    assert kind.evidence in EVIDENCE


@pytest.mark.parametrize("kind", KINDS.values(), ids=list(KINDS))
def test_every_kind_has_ten_wordings_that_pass_the_review(kind: GoalKind) -> None:
    texts = worded(goal_of_kind(kind), "the pen", "the box")
    assert len(set(texts)) >= 10
    recognised = [text for text in texts if {*kind.says.split()} & {*text.lower().rstrip(".?").split()}]
    assert len(recognised) >= 5


@pytest.mark.parametrize("kind", KINDS.values(), ids=list(KINDS))
def test_words_that_only_one_kind_may_use_say_it(kind: GoalKind) -> None:
    assert {*kind.claims.split()} <= {*kind.says.split()} | {"returned", "rotated"}


@pytest.mark.parametrize("kind", [kind for kind in KINDS.values() if kind.opposite], ids=lambda kind: kind.word)
def test_opposites_are_mutual(kind: GoalKind) -> None:
    assert KINDS[str(kind.opposite)].opposite == kind.word


@pytest.mark.parametrize("kind", [kind for kind in KINDS.values() if kind.happens], ids=lambda kind: kind.word)
def test_goals_that_happen_once_are_events(kind: GoalKind) -> None:
    assert kind.event


def test_on_the_table_is_judged_unlike_on_an_object() -> None:
    on = KINDS["on"]
    assert kind_of(goal_of_kind(on)) is on
    assert kind_of(goal_of_kind(on, "table")).evidence == "moved"


def test_words_of_states_come_before_those_of_events() -> None:
    events = [KINDS[word].event for word in words()]
    assert events == sorted(events)


def test_lines_of_prompts_fit_their_width() -> None:
    goals = [goal_of_kind(kind) for kind in KINDS.values()]
    lines = [line for lines in (*forms(), *meanings(goals, THRESHOLDS)) for line in lines]
    assert max(map(len, lines)) <= PROMPT_WIDTH + 2


def test_a_meaning_shared_by_two_kinds_is_given_once() -> None:
    goals = [goal_of_kind(KINDS[word]) for word in ("left_of", "right_of", "inside", "on")]
    assert [lines[0].split(":")[0] for lines in meanings(goals, THRESHOLDS)] == [
        "Inside or on an object", "Left of, right of, in front of, behind",
    ]  # fmt: skip


def test_every_word_stands_in_one_form_for_people() -> None:
    found = [word for form in written_forms().split("; ") for word in form.split(" ")[1].split("|")]
    assert sorted(found) == sorted(KINDS)
    assert "SUBJECT inside|on REFERENCE[/PART]" in written_forms()
