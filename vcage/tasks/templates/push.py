"""Push: an object that cannot be carried is pushed along the table until it stands as is asked."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from vcage.schema.goals import Goal
from vcage.schema.plan import TABLE
from vcage.schema.subtasks import Refusal, Subtask, TemplateName
from vcage.tasks.feasibility import opens_wide_enough
from vcage.tasks.pushing import Push, examine_pushes, headings
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.templates.proposal import Proposal
from vcage.tasks.wording import push_wordings
from vcage.tasks.workplace import Workplace

NAME: TemplateName = "push"


@dataclass(frozen=True)
class PushableSettings:
    """Limits of what can be pushed.

    Args:
        flattest_m: what is lower slips under the finger tips.
        gravity_m_per_s2: acceleration.
        strongest_n: friction on the table against which an arm still pushes exactly.
    """

    flattest_m: float = 0.012
    gravity_m_per_s2: float = 9.81
    strongest_n: float = 24.0


SETTINGS = PushableSettings()


_RELATIONS = ("left_of", "right_of", "in_front_of", "behind", "beside", "near")


class Pushing:
    """The template: every object that shall stand in a relation to another."""

    name = NAME

    def proposals(self, objects: Sequence[SceneObject], asked: Collection[Goal]) -> tuple[list[Shove], list[Refusal]]:
        """Every object with each relation that is asked for of it."""
        by_id = {o.id: o for o in objects}
        goals = [g for g in asked if g.relation in _RELATIONS and g.subject in by_id and g.reference in by_id]
        return [Shove(NAME, by_id[goal.subject], goal) for goal in goals], []

    def calls(self, subtask: Subtask) -> list[str]:
        """The lines of the script's ``play``; GRASPS is a constant of the script."""
        return [f"task.push({subtask.object!r}, arms=[arm for _, arm, _ in GRASPS])", "task.home()"]


@dataclass(frozen=True)
class Shove(Proposal):
    """An object and the relation that it shall stand in: it may be pushed against its faces."""

    @property
    def goals(self) -> list[Goal]:
        """Its goal: it stands on the table as before."""
        return [self.goal, Goal(subject=self.thing.id, relation="on", reference=TABLE)]

    @property
    def candidates(self) -> int:
        """Number of directions, though none is tried for an object that a hand can carry."""
        return len(headings(self.thing))

    def impossible(self) -> Refusal | None:
        """Refuse an object that stands in or on another, or is flat or heavy."""
        phrase, model = self.thing.record.phrase, self.thing.asset.model
        if self.thing.record.container is not None:
            return self.refusal(f"{phrase} does not stand on the table")
        height, force = float(self.thing.asset.size[2]), model.total_mass * model.friction * SETTINGS.gravity_m_per_s2
        if height < SETTINGS.flattest_m:
            return self.refusal(f"{phrase} is {height * 1000:.0f} mm high, too flat for finger tips to push it")
        if force > SETTINGS.strongest_n:
            return self.refusal(f"{phrase} resists a push with {force:.0f} N, more than {SETTINGS.strongest_n:.0f} N")
        return None

    def examine(self, workplace: Workplace) -> tuple[Subtask | None, list[Refusal]]:
        """The sub-task if an arm can push the object so; a refusal for each direction; nothing for what is carried."""
        points = self.thing.asset.annotation.carrying_points
        if any(opens_wide_enough(self.thing, point, workplace.kinematics).passed for point in points):
            return None, []
        others = workplace.others(self.thing.id)
        found, refused = examine_pushes(self.thing, self.goal, others, workplace.kinematics, workplace.ground)
        refusals = [self.refusal(reason, heading) for heading, reason in refused.items()]
        return (self._subtask(workplace.objects, found) if found else None), refusals

    def _subtask(self, objects: Sequence[SceneObject], found: Sequence[Push]) -> Subtask:
        text, *others = push_wordings(self.goal, {o.id: o.record.phrase for o in objects})
        return self.subtask(
            f"{self.thing.id}-pushed-{self.goal.relation}-{self.goal.reference}",
            objects,
            text=text,
            texts=others,
            receptacle=TABLE,
            grasps=[grasp for push in found for grasp in push.finding.grasps],
            goals=self.goals,
            checks=found[0].finding.checks,
        )


PUSH = Pushing()
