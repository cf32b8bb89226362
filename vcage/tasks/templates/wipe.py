"""Wipe: the pad of a tool is drawn to and fro over the flat top of an object, and the tool put back."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Pose
from vcage.schema.asset import ContactPoint
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Refusal, Subtask, TemplateName
from vcage.tasks.feasibility import Transfer, examine
from vcage.tasks.findings import Feasibility, best_first, reach_check
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.state import lying_on
from vcage.tasks.templates.proposal import Proposal
from vcage.tasks.wiping import Pad, flat_top, free_wiping_ways, wiping_ways
from vcage.tasks.workplace import Workplace

NAME: TemplateName = "wipe"


class Wipe:
    """The template, on request: an object with every tool that has a pad and can be carried."""

    name = NAME

    def proposals(self, objects: Sequence[SceneObject], asked: Collection[Goal]) -> tuple[list[Wiping], list[Refusal]]:
        """Each object to wipe with each tool; a tool is not wiped with itself.

        What is asked to be moved counts as moved: rehearsing shows whether that comes before.
        """
        tools = [o for o in objects if o.asset.annotation.faces_of("pad") and o.asset.annotation.carrying_points]
        moved = frozenset(goal.subject for goal in asked if goal.kind.moves)
        found, refused = list[Wiping](), list[Refusal]()
        for thing in objects:
            goal = Goal(subject=thing.id, relation="wiped")
            if goal in asked:
                found += [Wiping(NAME, thing, goal, tool, moved) for tool in tools if tool.id != thing.id]
        return found, refused

    def calls(self, subtask: Subtask) -> list[str]:
        """The lines of the script's ``play``; GRASPS is a constant of the script."""
        grasps = "[(contact, arm) for contact, arm, _ in GRASPS]"
        return [f"task.wipe({subtask.tool!r}, {subtask.object!r}, grasps={grasps})", "task.home()"]


@dataclass(frozen=True)
class Wiping(Proposal):
    """An object, and the tool that wipes it.

    Args:
        tool: that has a pad.
        moved: ids of the objects that are asked to be moved.
    """

    tool: SceneObject
    moved: frozenset[str] = frozenset()

    @property
    def candidates(self) -> int:
        """Number of contact points on the tool."""
        return len(self.tool.asset.annotation.carrying_points)

    def offers(self, subtask: Subtask) -> bool:
        """True where a sub-task wipes the object with this tool."""
        return super().offers(subtask) and subtask.tool == self.tool.id

    def impossible(self) -> Refusal | None:
        """The object needs a flat top on which the pad has room."""
        top, pad, thing = flat_top(self.thing), Pad.of(self.tool), self.thing.record.phrase
        if top is None or pad is None:
            return self.refusal(f"{thing} has no flat top to wipe, with a low rim or none")
        if any(wiping_ways(self.tool, self.thing)):
            return None
        sizes = [" × ".join(f"{100 * x:.1f}" for x in size) for size in (2 * pad.half, top.size)]
        tool = self.tool.record.phrase
        return self.refusal(
            f"{tool} ({sizes[0]} cm) cannot be drawn to and fro on the flat top of {thing} ({sizes[1]} cm)"
        )

    def examine(self, workplace: Workplace) -> tuple[Subtask | None, list[Refusal]]:
        """The sub-task if an arm can draw the tool over the object, else a refusal for each contact point."""
        tool, thing = self.tool, self.thing
        beside = [o for o in workplace.others(tool.id) if o.id != thing.id and not self._leaves(o)]
        if lying := lying_on(thing, [*beside, tool]):
            return None, [self.refusal(f"{lying[0].record.phrase} lies on {thing.record.phrase}; take it off before")]
        ways, in_the_way = free_wiping_ways(tool, thing, beside)
        if not ways:
            met = "something" if in_the_way is None else in_the_way.record.phrase
            return None, [self.refusal(f"{tool.record.phrase} would touch {met} over {thing.record.phrase}")]
        contacts = tool.asset.annotation.carrying_points
        found = {c.id: self._examined(c, ways, (*beside, thing), workplace) for c in contacts}
        findings, refused = self.judged(found)
        if not findings:
            return None, refused
        grasps, checks = best_first(findings)
        slots = {"grasps": grasps, "checks": checks, "tool": tool.id, "grasped": tool.id}
        return self.subtask(f"{thing.id}-wiped-with-{tool.id}", workplace.objects, **slots), refused

    def _leaves(self, other: SceneObject) -> bool:
        """True for what lies on the object, and is asked to be moved."""
        return other.id in self.moved and bool(lying_on(self.thing, [other]))

    def _examined(
        self,
        contact: ContactPoint,
        ways: Sequence[Sequence[Pose]],
        others: tuple[SceneObject, ...],
        workplace: Workplace,
    ) -> Feasibility:
        """The findings at a contact point: of the first way that an arm can go, else of the last one."""
        found = None
        for way in ways:
            found = self._along(contact, way, others, workplace)
            if found.feasible:
                return found
        assert found is not None, "there is a way"
        return found

    def _along(
        self, contact: ContactPoint, way: Sequence[Pose], others: tuple[SceneObject, ...], workplace: Workplace
    ) -> Feasibility:
        """The findings of a way: an arm must bring the tool to each of its ends."""
        where = f"its place over {self.thing.record.phrase}"
        first, *rest = _ends(way)
        found = examine(Transfer(self.tool, contact, where, [first], [], (), others), workplace)
        for end in rest:
            if not found.feasible:
                break
            one = examine(Transfer(self.tool, contact, where, [end], [], (), others), workplace)
            grasps = [grasp for grasp in found.grasps if grasp.arm in {other.arm for other in one.grasps}]
            if one.feasible and not grasps:  # by another arm than the ends before
                short = reach_check("reach_place", f"all of {where}", False, found.grasps[0].arm)
                one = Feasibility([*found.checks, short], [])
            found = Feasibility(found.checks, grasps) if grasps else one
        return found


def _ends(way: Sequence[Pose]) -> list[Pose]:
    """The four outermost poses of a way, the first of them where it begins."""
    places = np.array([pose.p[:2] for pose in way])
    middle = places.mean(axis=0)
    far = sorted(range(len(way)), key=lambda number: -float(np.linalg.norm(places[number] - middle)))
    return [way[number] for number in sorted({0, *far[:4]})]
