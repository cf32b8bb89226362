"""Hit: the head of a tool is brought down on an object, and the tool put back."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.schema.goals import Goal
from vcage.schema.subtasks import Refusal, Subtask, TemplateName
from vcage.tasks.feasibility import Transfer, examine
from vcage.tasks.findings import Feasibility, best_first
from vcage.tasks.hitting import free_hitting_poses
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.templates.proposal import Proposal
from vcage.tasks.workplace import Workplace

NAME: TemplateName = "hit"


class Hit:
    """The template, on request: an object with every tool that has a head and can be carried."""

    name = NAME

    def proposals(self, objects: Sequence[SceneObject], asked: Collection[Goal]) -> tuple[list[Hitting], list[Refusal]]:
        """Each object to hit with each tool; a tool is not hit with itself."""
        tools = [o for o in objects if o.asset.annotation.faces_of("head") and o.asset.annotation.carrying_points]
        found, refused = list[Hitting](), list[Refusal]()
        for thing in objects:
            goal = Goal(subject=thing.id, relation="hit")
            if goal in asked:
                found += [Hitting(NAME, thing, goal, tool) for tool in tools if tool.id != thing.id]
        return found, refused

    def calls(self, subtask: Subtask) -> list[str]:
        """The lines of the script's ``play``; GRASPS is a constant of the script."""
        grasps = "[(contact, arm) for contact, arm, _ in GRASPS]"
        return [f"task.hit({subtask.tool!r}, {subtask.object!r}, grasps={grasps})", "task.home()"]


@dataclass(frozen=True)
class Hitting(Proposal):
    """An object, and the tool that hits it."""

    tool: SceneObject

    @property
    def candidates(self) -> int:
        """Number of contact points on the tool."""
        return len(self.tool.asset.annotation.carrying_points)

    def offers(self, subtask: Subtask) -> bool:
        """True where a sub-task hits the object with this tool."""
        return super().offers(subtask) and subtask.tool == self.tool.id

    def examine(self, workplace: Workplace) -> tuple[Subtask | None, list[Refusal]]:
        """The sub-task if an arm can hold the tool over the object, else a refusal for each contact point."""
        tool, thing = self.tool, self.thing
        others = tuple(workplace.others(tool.id))
        poses, in_the_way = free_hitting_poses(tool, thing, [o for o in others if o.id != thing.id])
        if in_the_way is not None:
            met = in_the_way.record.phrase
            return None, [self.refusal(f"{tool.record.phrase} would touch {met} over {thing.record.phrase}")]
        where, contacts = f"its place over {thing.record.phrase}", tool.asset.annotation.carrying_points
        transfers = {c.id: Transfer(tool, c, where, poses, [], (), others) for c in contacts}
        findings, refused = self.judged({c: examine(t, workplace) for c, t in transfers.items()})
        if not findings:
            return None, refused
        ordered = [best_first([finding]) for finding in sorted(findings, key=self._from_head)]
        grasps = [grasp for some, _ in ordered for grasp in some]
        slots = {"grasps": grasps, "checks": ordered[0][1], "tool": tool.id, "grasped": tool.id}
        return self.subtask(f"{thing.id}-hit-with-{tool.id}", workplace.objects, **slots), refused

    def _from_head(self, finding: Feasibility) -> float:
        """Distance of a grasp from the head, metres: held nearer to it, a tool turns less between the fingers."""
        annotation = self.tool.asset.annotation
        held = np.array(annotation.contact_point(finding.grasps[0].contact).position)
        return min(float(np.linalg.norm(held - head.position)) for head in annotation.faces_of("head"))
