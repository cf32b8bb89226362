"""Template-based sub-task search (paper, section III-B): every template is tried on every object of a scene.

A sub-task is kept when a reasoner finds it sensible and at least one of its candidates passes every feasibility
check; everything else is a refusal with a reason.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

from vcage.base.errors import InputFileError, NoFeasibleTask
from vcage.plans.actions import AT_START, HOLDING, Action
from vcage.plans.planner import Task, complaints, find_chain
from vcage.schema.goals import AskedGoal, Goal, in_steps, part_that
from vcage.schema.plan import TABLE
from vcage.schema.robot import Arm
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Chain, PairAnswer, PairQuestion, Refusal, Subtask, TemplateName
from vcage.sim.joints import joint_positions
from vcage.sim.robots import load_robot
from vcage.tasks.asked_arms import ANY_ARM
from vcage.tasks.primitives.grip import stays_level
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.state import resting_point
from vcage.tasks.stowing import point_in
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.templates.proposal import Proposal, stands_up_elsewhere
from vcage.tasks.workplace import Workplace

Judge = Callable[[Sequence[PairQuestion]], list[PairAnswer]]


def judging(sensible: bool) -> Judge:
    """A judge that finds all pairs sensible, or none. Requested pairs are not judged at all."""
    return lambda questions: [
        PairAnswer(object=q.object, receptacle=q.receptacle, sensible=sensible, reason="not asked") for q in questions
    ]


@dataclass(frozen=True)
class FoundSubtasks:
    """The sub-tasks that were kept, the refusals, and the number of candidates."""

    kept: list[Subtask]
    refused: list[Refusal]
    candidates: int


def find_subtasks(
    workplace: Workplace,
    judge: Judge,
    asked: Collection[Goal] = (),
    arms: Mapping[Goal, str] = MappingProxyType({}),
) -> FoundSubtasks:
    """Find the sub-tasks that are sensible and feasible in a scene.

    Args:
        workplace: the objects where they stand, and the arms.
        judge: the reasoner's filter, asked once about all possible pairs.
        asked: the requested goals: the judge has no say in them.
        arms: the required arm of a goal, if there is one.
    """
    kept: list[Subtask] = []
    proposals, refused, candidates = sensible(workplace.objects, judge, asked)
    for proposal in proposals:
        subtask, refusals = proposal.examine_for(arms, workplace)
        refused += refusals
        kept += [subtask] if subtask is not None else []
    return FoundSubtasks(kept, refused, candidates)


def sensible(
    objects: Sequence[SceneObject], judge: Judge, asked: Collection[Goal] = ()
) -> tuple[list[Proposal], list[Refusal], int]:
    """Return the proposals that make sense and fit by size, the refusals of the rest, and the number of candidates.

    Where the objects stand does not matter.

    Args:
        objects: of the scene.
        judge, asked: see :func:`find_subtasks`.
    """
    proposals: list[Proposal] = []
    refused: list[Refusal] = []
    for template in TEMPLATES.values():
        found, excluded = template.proposals(objects, asked)
        proposals += found
        refused += excluded
    refusals = [proposal.impossible() for proposal in proposals]
    refused += [refusal for refusal in refusals if refusal is not None]
    possible = [proposal for proposal, refusal in zip(proposals, refusals, strict=True) if refusal is None]
    questions = {
        number: question
        for number, proposal in enumerate(possible)
        if proposal.goal not in asked and (question := proposal.question()) is not None
    }
    answers = zip(questions, judge(list(questions.values())) if questions else [], strict=True)
    absurd = {number: answer for number, answer in answers if not answer.sensible}
    refused += [possible[number].refusal(f"not sensible: {answer.reason}") for number, answer in absurd.items()]
    accepted = [proposal for number, proposal in enumerate(possible) if number not in absurd]
    return accepted, refused, sum(proposal.candidates for proposal in proposals)


def compose(
    scene: Scene, objects: Sequence[SceneObject], kept: Sequence[Subtask], refused: Sequence[Refusal]
) -> list[Chain]:
    """The chain T₁…T_k for the scene's instruction, proven to bring about every goal; without one, each kept sub-task.

    Args:
        scene: with its goals.
        objects: of the scene.
        kept, refused: results of the search.

    Raises:
        NoFeasibleTask: no chain achieves the request, or nothing was kept; says why.
    """
    if scene.instruction is not None:
        return [Chain(text=scene.instruction, subtasks=_fulfilling(scene, objects, kept, refused))]
    if not kept:
        reasons = Counter(refusal.reason for refusal in refused)
        raise NoFeasibleTask(
            f"no sub-task is feasible in this scene: {'; '.join(list(reasons)[:3])}",
            hint=_way_out([refused]),
            details={"reasons": dict(reasons)},
        )
    return [Chain(text=subtask.text, subtasks=[subtask.id]) for subtask in kept]


def _fulfilling(
    scene: Scene, objects: Sequence[SceneObject], kept: Sequence[Subtask], refused: Sequence[Refusal]
) -> list[str]:
    """Ids of the sub-tasks that achieve all goals, in order."""
    if not scene.goals:
        raise InputFileError(
            "the scene has an instruction but no goals for it",
            hint="let the instruction be read",
            maker="select_place",
        )
    task = Task(initial_state(objects), in_steps(scene.goals))
    asked = {one.goal for one in scene.goals}
    able = [s for s in kept if s.object not in scene.untouched and not stands_up_elsewhere(s, asked)]
    by_name = actions_of(able, objects, scene)
    chain = _shortest(task, list(by_name.values()))
    if not chain:
        raise _unfulfilled(scene, kept, refused)
    unproven = complaints(task, [by_name[name] for name in chain])
    if unproven:
        raise RuntimeError(f"the planner's own chain does not achieve the request: {'; '.join(unproven)}")
    return chain


def _shortest(task: Task, actions: Sequence[Action]) -> list[str] | None:
    """A shortest chain; objects are moved with their contents only where that makes it shorter."""
    emptied = find_chain(task, [replace(action, along=False) for action in actions])
    filled = find_chain(task, actions)
    shorter = filled and (not emptied or len(filled) < len(emptied))
    return filled if shorter else emptied


ENDS_IN_HAND: tuple[TemplateName, ...] = ("hold_up", "hold_with_both")
"""Sub-tasks after which the object is in a hand."""

TAKES: tuple[TemplateName, ...] = (*ENDS_IN_HAND, "hang", "insert")
"""Sub-tasks that take the object from its place, and have no slot for it."""

POURS: TemplateName = "pour"
"""The sub-task that brings the contents of its object into another one."""

FILLED: tuple[TemplateName, ...] = ("place", "set_down", "lift", *ENDS_IN_HAND)
"""Sub-tasks that may carry an object with its contents."""


def actions_of(subtasks: Iterable[Subtask], objects: Sequence[SceneObject], scene: Scene) -> dict[str, Action]:
    """Sub-tasks as the planner sees them, by id.

    Args:
        subtasks: of the scene.
        objects: of the scene.
        scene: with its robot.
    """
    by_id, arms = {o.id: o for o in objects}, load_robot(scene.robot).arms
    return {subtask.id: _action_of(subtask, by_id[subtask.object], arms) for subtask in subtasks}


def _action_of(subtask: Subtask, thing: SceneObject, arms: Mapping[str, Arm]) -> Action:
    """A sub-task as the planner sees it.

    Args:
        subtask: which.
        thing: its object.
        arms: of the robot; those that it does not take may hold something up.
    """
    moves = subtask.object if subtask.receptacle is not None or subtask.template in TAKES else None
    target = subtask.goals[0].reference if subtask.template == POURS else None
    alone = subtask.receptacle if subtask.template == "weigh" else None
    takes = max(1 + (subtask.hand_to is not None), *(goal.kind.arms for goal in subtask.goals))
    along = subtask.template in FILLED and (takes > 1 or stays_level(thing, arms.values()))
    return Action(
        subtask.id,
        frozenset(subtask.requires),
        frozenset(subtask.goals),
        moves,
        alone,
        along,
        subtask.object,
        vacant=next((goal.reference for goal in subtask.goals if goal.relation == "in_place_of"), None),
        spare=len(arms) - takes,
        pours=None if target is None else (subtask.object, target),
    )


def initial_state(objects: Sequence[SceneObject]) -> frozenset[Goal]:
    """The places of all objects at the start, and the positions of the parts."""
    by_id = {o.id: o for o in objects}
    there = frozenset(Goal(subject=o.id, relation=AT_START) for o in objects)
    return there.union(goal for o in objects for goal in (_place_of(o, by_id), *_positions_of(o)))


def _place_of(o: SceneObject, objects: Mapping[str, SceneObject]) -> Goal:
    """The goal that an object is where it is at the start."""
    holder, part = o.record.container, o.record.container_part
    if holder is None:
        return Goal(subject=o.id, relation="on", reference=TABLE)
    point = resting_point(o, objects[holder]) if part is None else point_in(objects[holder].asset, part)
    if point is None:
        return Goal(subject=o.id, relation="on", reference=holder)
    return Goal(subject=o.id, relation="inside" if point.holds == "in" else "on", reference=holder, part=point.link)


def _positions_of(o: SceneObject) -> Iterator[Goal]:
    """The goals that the parts of an object are open or closed, turned or turned back."""
    for link, position in zip(o.asset.model.links, joint_positions(o.asset.model, o.joints), strict=True):
        far = bool(abs(position) > abs(link.joint.far_end) / 2)
        for action, words in (("open", ("closed", "open")), ("turn", ("turned_back", "turned"))):
            if part_that(action, link.name):
                yield Goal(subject=o.id, relation=words[far], part=link.name)


def is_about(refusal: Refusal, goal: Goal) -> bool:
    """True if a refusal concerns the way to bring about a goal; without one, it is about putting things on or in."""
    if refusal.goal is None:
        return goal.relation in HOLDING and (refusal.object, refusal.receptacle) == (goal.subject, goal.reference)
    return refusal.goal == goal


SIZES = ("fits", "opening")
"""Checks that compare sizes: their refusals hold in any layout."""

SMALLER = "ask for a smaller thing, or for a place with more room"


def _way_out(refusals: Sequence[Sequence[Refusal]], asked: Sequence[AskedGoal] = ()) -> str:
    """Return the hint for refusals; another seed helps only where places matter.

    Args:
        refusals: in groups, each of them required.
        asked: the requested goals, perhaps with an arm.
    """
    if any(group and all(_by_size(refusal) for refusal in group) for group in refusals):
        return f"{SMALLER}; another --seed does not help"
    if any(one.arm is not None for one in asked):
        return f"{ANY_ARM}; or another --seed gives another layout"
    return "another --seed gives another layout; another instruction other objects"


def _by_size(refusal: Refusal) -> bool:
    return any(check.name in SIZES and not check.passed for check in refusal.checks)


def _named(asked: AskedGoal) -> str:
    """A goal with its words, and the arm that it is asked of."""
    return f"{asked.goal} ({asked.words!r}){'' if asked.arm is None else f' with the {asked.arm} arm'}"


def _unfulfilled(scene: Scene, kept: Sequence[Subtask], refused: Sequence[Refusal]) -> NoFeasibleTask:
    """The error for an instruction without a chain: the goals nothing achieves, and the reasons."""
    missing = _missing(scene, kept)
    about = [[refusal for refusal in refused if is_about(refusal, asked.goal)] for asked in missing]
    left = sorted({asked.goal.subject for asked in missing}.intersection(scene.untouched))
    reasons = [refusal.reason for refusal in itertools.chain(*about)]
    reasons += [f"{name} is to be left alone" for name in left]
    return NoFeasibleTask(
        f"no chain of feasible sub-tasks achieves {_why(missing or scene.goals, reasons, bool(missing))}",
        hint="name movable objects, or leave fewer alone" if left else _way_out(about, missing or scene.goals),
        details={"missing": [str(asked.goal) for asked in missing], "reasons": reasons},
    )


def _missing(scene: Scene, kept: Sequence[Subtask]) -> list[AskedGoal]:
    """The goals of a scene that no kept sub-task achieves."""
    able = {goal for subtask in kept if subtask.object not in scene.untouched for goal in subtask.goals}
    return [asked for asked in scene.goals if asked.goal not in able]


def _why(goals: Sequence[AskedGoal], reasons: Sequence[str], missing: bool) -> str:
    """Goals with the first three reasons why no chain brings them about; ``missing`` if no sub-task does."""
    unsaid = "no sub-task of this scene does that"
    if not missing:
        unsaid = "each can be brought about, but in no order all of them"
    return f"{'; '.join(dict.fromkeys(map(_named, goals)))}: {'; '.join([*dict.fromkeys(reasons)][:3]) or unsaid}"
