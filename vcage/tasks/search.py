"""Template-based sub-task search (paper, section III-B): every ordered pair, every contact and functional point.

A pair is kept when a reasoner finds it sensible and at least one of its candidates passes every feasibility
check; everything else is a refusal with a reason.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np

from vcage.base.errors import InfeasibleScene, ModelRefused, NoFeasibleTask
from vcage.base.geometry import Pose
from vcage.schema.asset import FunctionalPoint
from vcage.schema.subtasks import (
    ChainOption,
    Check,
    Goal,
    Grasp,
    PairAnswer,
    PairQuestion,
    Refusal,
    Subtask,
)
from vcage.sim.kinematics import ArmKinematics
from vcage.tasks.access import access, carrying_points
from vcage.tasks.feasibility import Candidate, Finding, examine, fits
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import GAP, allocate

TEMPLATE = "pick_and_place"

Judge = Callable[[Sequence[PairQuestion]], list[PairAnswer]]


@dataclass(frozen=True)
class SearchResult:
    """What was kept and what was refused, out of how many candidates."""

    kept: list[Subtask]
    refused: list[Refusal]
    candidates: int


@dataclass(frozen=True)
class _Pair:
    """An ordered pair with one functional point: all contact points of ``target`` are candidates."""

    target: SceneObject
    receptacle: SceneObject
    point: FunctionalPoint

    def refusal(self, reason: str, contact: int | None = None, checks: Sequence[Check] = ()) -> Refusal:
        return Refusal(
            template=TEMPLATE,
            object=self.target.id,
            contact=contact,
            receptacle=self.receptacle.id,
            functional_point=self.point.id,
            reason=reason,
            checks=list(checks),
        )


def search(
    objects: Sequence[SceneObject],
    kinematics: Mapping[str, ArmKinematics],
    judge: Judge,
    table_height: float,
    rng: np.random.Generator,
) -> SearchResult:
    """Find the sub-tasks that are sensible and feasible in a scene.

    Args:
        kinematics: by arm.
        judge: the reasoner's filter, asked once about all pairs that fit.
        table_height: z of the table top, metres.
    """
    refused = list(_without_points(objects))
    pairs = list(_pairs(objects))
    candidates = sum(len(carrying_points(pair.target.asset.annotation)) for pair in pairs)

    fitting = []
    for pair in pairs:
        check = access(pair.receptacle, pair.point)
        if check.passed:
            check = fits(pair.target, pair.receptacle, pair.point)
        if check.passed:
            fitting.append(pair)
        else:
            refused.append(pair.refusal(check.message, checks=[check]))

    kept = []
    for pair, answer in zip(fitting, judge([_question(pair) for pair in fitting]) if fitting else [], strict=True):
        if not answer.sensible:
            refused.append(pair.refusal(f"not sensible: {answer.reason}"))
            continue
        subtask, complaints = _examine_pair(pair, answer, objects, kinematics, table_height, rng)
        refused += complaints
        if subtask is not None:
            kept.append(subtask)
    return SearchResult(kept, refused, candidates)


def _without_points(objects: Sequence[SceneObject]) -> Iterator[Refusal]:
    """Pairs that the template's preconditions exclude before any candidate exists."""
    for target, receptacle in permutations(objects, 2):
        if not carrying_points(target.asset.annotation):
            reason = f"{target.record.phrase} has no contact point to carry it by"
        elif not receptacle.asset.annotation.functional_points:
            reason = f"{receptacle.record.phrase} has no functional point"
        else:
            continue
        yield Refusal(template=TEMPLATE, object=target.id, receptacle=receptacle.id, reason=reason)


def _pairs(objects: Sequence[SceneObject]) -> Iterator[_Pair]:
    for target, receptacle in permutations(objects, 2):
        if carrying_points(target.asset.annotation):
            for point in receptacle.asset.annotation.functional_points:
                yield _Pair(target, receptacle, point)


def _question(pair: _Pair) -> PairQuestion:
    opening = pair.receptacle.asset.opening(pair.point)
    return PairQuestion(
        object=pair.target.id,
        object_words=f"{pair.target.record.phrase}: {pair.target.asset.annotation.words.description}",
        receptacle=pair.receptacle.id,
        receptacle_words=f"{pair.receptacle.record.phrase}: {pair.receptacle.asset.annotation.words.description}",
        holds=pair.point.holds,
        object_size=tuple(float(x) for x in pair.target.asset.size),
        opening_size=(float(opening.size[0]), float(opening.size[1]), float(opening.depth)),
    )


def _examine_pair(
    pair: _Pair,
    answer: PairAnswer,
    objects: Sequence[SceneObject],
    kinematics: Mapping[str, ArmKinematics],
    table_height: float,
    rng: np.random.Generator,
) -> tuple[Subtask | None, list[Refusal]]:
    """The sub-task of a sensible pair, and a refusal for each contact point that no arm can use."""
    others = [o for o in objects if o.id not in (pair.target.id, pair.receptacle.id)]
    present = _inside(pair.receptacle, others)
    try:
        slot = allocate(pair.receptacle, pair.point.id, [pair.target], rng, present)[pair.target.id]
    except InfeasibleScene as error:
        return None, [pair.refusal(_no_room(pair, present, error))]
    findings: list[Finding] = []
    refused = []
    for contact in carrying_points(pair.target.asset.annotation):
        candidate = Candidate(pair.target, contact, pair.receptacle, pair.point, others)
        finding = examine(candidate, kinematics, slot, table_height)
        if finding.feasible:
            findings.append(finding)
        else:
            refused.append(pair.refusal(finding.reason, contact.id, finding.checks))
    return (_subtask(pair, answer, findings) if findings else None), refused


def _no_room(pair: _Pair, present: Sequence[SceneObject], error: InfeasibleScene) -> str:
    """Why the object, which fits by its size alone, gets no place."""
    if present:
        return error.message
    fit = fits(pair.target, pair.receptacle, pair.point)
    return f"{fit.message}, but with less than the {GAP * 1000:.0f} mm on each side that the robot needs"


def _subtask(pair: _Pair, answer: PairAnswer, findings: Sequence[Finding]) -> Subtask:
    grasps: list[Grasp] = [grasp for finding in findings for grasp in finding.grasps]
    grasps.sort(key=lambda grasp: (-grasp.score, grasp.contact, grasp.arm))
    best = next(f for f in findings if grasps[0] in f.grasps)
    word = "into" if pair.point.holds == "in" else "onto"
    suffix = f"-{pair.point.id}" if len(pair.receptacle.asset.annotation.functional_points) > 1 else ""
    identifier = f"{pair.target.id}-{word}-{pair.receptacle.id}{suffix}"
    return Subtask(
        id=identifier,
        template=TEMPLATE,
        text=answer.text,
        object=pair.target.id,
        receptacle=pair.receptacle.id,
        functional_point=pair.point.id,
        grasps=grasps,
        goals=[Goal(subject=pair.target.id, relation=answer.relation, reference=pair.receptacle.id)],
        script=f"subtasks/{identifier}.py",
        checks=best.checks,
    )


def compose(
    instruction: str,
    kept: Sequence[Subtask],
    refused: Sequence[Refusal],
    objects: Sequence[SceneObject],
    choose: Callable[[str, Sequence[ChainOption]], list[str]],
) -> list[str]:
    """The chain T₁…T_k for the instruction: ids of kept sub-tasks, in order.

    Args:
        choose: the reasoner's :meth:`~vcage.models.protocols.Reasoner.compose_chain`.

    Raises:
        ModelRefused: the reasoner names a sub-task that was not offered.
        NoFeasibleTask: none fulfils it, or a content has no feasible sub-task, or the contents do not fit
            together; says why.
    """
    kinds = {o.id: o.kind() for o in objects}
    options = [ChainOption.of(s, kinds[s.object], kinds[s.receptacle]) for s in kept]
    chain = choose(instruction, options) if options else []
    by_id = {s.id: s for s in kept}
    strangers = [i for i in chain if i not in by_id]
    if strangers:
        raise ModelRefused(
            f"the reasoner chained sub-tasks that do not exist: {', '.join(strangers)}", hint="run it again"
        )
    moved = {by_id[i].object for i in chain}
    goals = {o.id for o in objects if o.record.role == "receptacle"}
    missing = [o for o in objects if o.record.role == "content" and o.id not in moved]
    if not chain or missing:
        reasons = [r.reason for o in missing for r in refused if r.object == o.id and r.receptacle in goals]
        named = ", ".join(o.record.phrase for o in missing) or "any object"
        why = "; ".join(reasons[:3]) or ("none was kept" if goals else "it names no place that holds things")
        raise NoFeasibleTask(
            f"no feasible sub-task moves {named} as {instruction!r} asks: {why}",
            hint="another --seed gives another layout; another instruction other objects",
            details={"missing": [o.id for o in missing], "reasons": reasons},
        )
    return chain


def slots_for_chain(
    chain: Sequence[Subtask], objects: Sequence[SceneObject], rng: np.random.Generator
) -> dict[str, Pose]:
    """A slot for each object that the chain moves, in its receptacle's frame, so that all fit together.

    Raises:
        InfeasibleScene: the contents of one receptacle do not fit together.
    """
    by_id = {o.id: o for o in objects}
    groups: dict[tuple[str, int], list[SceneObject]] = {}
    for subtask in chain:
        groups.setdefault((subtask.receptacle, subtask.functional_point), []).append(by_id[subtask.object])
    slots: dict[str, Pose] = {}
    for (receptacle, point), contents in groups.items():
        moved = {o.id for o in contents}
        present = _inside(by_id[receptacle], [o for o in objects if o.id not in moved])
        slots |= allocate(by_id[receptacle], point, contents, rng, present)
    return slots


def _inside(receptacle: SceneObject, objects: Sequence[SceneObject]) -> list[SceneObject]:
    """What lies in or on the receptacle from the start."""
    return [o for o in objects if o.record.container == receptacle.id]
