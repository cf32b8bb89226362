"""A whole task in words: sentences from the templates of its goals, with names that are clear in the scene."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from itertools import groupby, zip_longest

from vcage.base.text import listed
from vcage.models.wordings import TaskToWord
from vcage.schema.goals import AskedGoal, Description, Goal, part_words
from vcage.schema.plan import TABLE
from vcage.tasks.wording import Source, by_arm, in_one_sentence, worded


def template_wordings(task: TaskToWord, pushed: Collection[Goal] = ()) -> list[str]:
    """Sentences that ask for the goals of a task and for nothing else, the plainest first; none where an object that
    must be named has no name that is clear.

    Args:
        task: what is asked for, in its scene.
        pushed: goals that a push brings about.
    """
    steps = [[*group] for _, group in groupby(sorted(task.goals, key=lambda a: a.step), key=lambda a: a.step)]
    found = list[Sequence[str]]()
    for short in (False, True):
        parts = [[_part_wordings(task, part, short, pushed) for part in _together(task, step)] for step in steps]
        if all(texts for step in parts for texts in step):
            found.append(in_one_sentence(parts))
    return task.reviewed([text for pair in zip_longest(*found) for text in pair if text is not None])


def _together(task: TaskToWord, step: Sequence[AskedGoal]) -> Iterator[list[AskedGoal]]:
    """Goals that one command asks for: several objects that go from one place to one place."""
    places: dict[object, list[AskedGoal]] = {}
    for number, asked in enumerate(step):
        goal, told = asked.goal, task.sources.get(asked.goal)
        alone = number if goal.kind.refers_to != "object" else None
        source = told and (told.relation, told.reference, told.part)
        places.setdefault((goal.relation, goal.reference, goal.part, asked.arm, source, alone), []).append(asked)
    yield from places.values()


def _part_wordings(task: TaskToWord, part: Sequence[AskedGoal], short: bool, pushed: Collection[Goal]) -> list[str]:
    """Wordings of goals that one command asks for; none where their objects have no clear name."""
    goal, arm = part[0].goal, part[0].arm
    thing = _thing(task, [asked.goal.subject for asked in part], short)
    place = _place(task, goal, short)
    told = task.sources.get(goal)
    holder = _holder(task, told, short) if told else ""
    if thing is None or place is None or holder is None:
        return []
    by_push = all(asked.goal in pushed for asked in part)
    source = Source("out of" if told.relation == "inside" else "off", holder) if told else None
    texts = worded(goal, thing, place, several=len(part) > 1, pushed=by_push, source=source)
    return by_arm(texts, arm) if arm is not None else texts


def _thing(task: TaskToWord, ids: Sequence[str], short: bool) -> str | None:
    """Name one or several objects, with articles; None where one has no clear name."""
    told = [*_names(task, ids, short)]
    if None in told:
        return None
    named = [name for name in told if name is not None]
    return named[0] if len(named) == 1 else f"{listed(named[:-1], most=len(named))} and {named[-1]}"


def _names(task: TaskToWord, ids: Sequence[str], short: bool) -> Iterator[str | None]:
    """Names of objects, those of one kind (or in full: of one phrase) together where a name means just them."""
    alike: dict[str, list[str]] = {}
    by_kind = short or bool(task.quantified)
    for name in ids:
        alike.setdefault(task.things[name].name if by_kind else task.phrases[name], []).append(name)
    for group in alike.values():
        names = task.names.calls(group, every=bool(task.quantified))
        if names:
            yield min(names, key=len) if short else names[0]
        elif short and len(group) > 1:
            yield from _names(task, group, short=False)
        else:
            yield None


def _holder(task: TaskToWord, told: Description, short: bool) -> str | None:
    """Name what something is taken from; None where that has no clear name."""
    name = _thing(task, [told.reference], short)
    return name if name is None or told.part is None else f"the {part_words(told.part)} of {name}"


def _place(task: TaskToWord, goal: Goal, short: bool) -> str | None:
    if goal.reference is None or goal.reference not in task.things:
        return f"the {TABLE}" if goal.reference == TABLE else str(goal.reference)
    return _thing(task, [goal.reference], short)
