"""Template-based sub-task search (paper, section III-B): everything in a scene that a template can be tried on.

A sub-task is kept when a reasoner finds it sensible and at least one of its candidates passes every feasibility
check; everything else is a refusal with a reason.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.errors import ModelRefused, NoFeasibleTask
from vcage.schema.subtasks import ChainOption, PairAnswer, PairQuestion, Refusal, Subtask
from vcage.sim.kinematics import ArmKinematics
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.templates import TEMPLATES, Proposal

Judge = Callable[[Sequence[PairQuestion]], list[PairAnswer]]


@dataclass(frozen=True)
class FoundSubtasks:
    """What was kept and what was refused, out of how many candidates."""

    kept: list[Subtask]
    refused: list[Refusal]
    candidates: int


def find_subtasks(
    objects: Sequence[SceneObject],
    kinematics: Mapping[str, ArmKinematics],
    judge: Judge,
    table_height: float,
    rng: np.random.Generator,
) -> FoundSubtasks:
    """Find the sub-tasks that are sensible and feasible in a scene.

    Args:
        objects: of the scene, where they stand.
        kinematics: by arm.
        judge: the reasoner's filter, asked once about all pairs that are possible.
        table_height: z of the table top, metres.
        rng: of all choices.
    """
    proposals: list[Proposal] = []
    kept: list[Subtask] = []
    refused: list[Refusal] = []
    for template in TEMPLATES.values():
        found, excluded = template.proposals(objects)
        proposals += found
        refused += excluded
    possible = []
    for proposal in proposals:
        refusal = proposal.impossible()
        if refusal is None:
            possible.append(proposal)
        else:
            refused.append(refusal)
    answers = judge([proposal.question() for proposal in possible]) if possible else []
    for proposal, answer in zip(possible, answers, strict=True):
        if not answer.sensible:
            refused.append(proposal.senseless(answer.reason))
            continue
        subtask, complaints = proposal.examine(answer, objects, kinematics, table_height, rng)
        refused += complaints
        kept += [subtask] if subtask is not None else []
    return FoundSubtasks(kept, refused, sum(proposal.candidates for proposal in proposals))


def compose(
    instruction: str,
    kept: Sequence[Subtask],
    refused: Sequence[Refusal],
    objects: Sequence[SceneObject],
    choose: Callable[[str, Sequence[ChainOption]], list[str]],
) -> list[str]:
    """The chain T₁…T_k for the instruction: ids of kept sub-tasks, in order.

    Args:
        instruction: of the user.
        kept, refused: what the search found.
        objects: of the scene.
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
    missing = [o for o in objects if o.record.role == "content" and o.id not in moved]
    if not chain or missing:
        raise _unfulfilled(instruction, missing, refused, objects)
    return chain


def _unfulfilled(
    instruction: str, missing: Sequence[SceneObject], refused: Sequence[Refusal], objects: Sequence[SceneObject]
) -> NoFeasibleTask:
    """Why no chain does what the instruction asks for.

    Args:
        missing: the contents that no sub-task of the chain moves.
    """
    goals = {o.id for o in objects if o.record.role == "receptacle"}
    reasons = [r.reason for o in missing for r in refused if r.object == o.id and r.receptacle in goals]
    named = ", ".join(o.record.phrase for o in missing) or "any object"
    why = "; ".join(reasons[:3]) or ("none was kept" if goals else "it names no place that holds things")
    return NoFeasibleTask(
        f"no feasible sub-task moves {named} as {instruction!r} asks: {why}",
        hint="another --seed gives another layout; another instruction other objects",
        details={"missing": [o.id for o in missing], "reasons": reasons},
    )
