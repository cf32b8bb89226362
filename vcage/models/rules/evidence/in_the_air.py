"""Evidence of an object that hands hold in the air at the moment: one after it was lifted, two at a hand-over."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vcage.models.rules.critic_view import CriticView
from vcage.models.rules.evidence.judgement import LEFT_SHARE, Judged, Judgement, decided, refused, unseen
from vcage.models.rules.evidence.moved import Moved
from vcage.models.rules.pixels import Change, changed_between, share_of
from vcage.models.rules.standing import Standing
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal


@dataclass(frozen=True)
class InTheAir:
    """Measurements of an object that was held up.

    Args:
        left: share of the object's outline before that has changed at the moment.
        to_come: share of its outline afterwards that looks otherwise at the moment.
        arms: share of the strip on the robot's side that changed since before, in its left and right half.
        old, new: where it stood and stands.
    """

    left: float
    to_come: float
    arms: tuple[float, float]
    old: Standing
    new: Standing

    @classmethod
    def gather(cls, view: CriticView, name: str, edge_share: float = 0.35) -> InTheAir | None:
        """Measure an object that is in neither place while arms reach out; None where it is not found.

        Args:
            view, name: of the question, and of the object.
            edge_share: depth of the strip on the robot's side of the picture, as a share of its height.
        """
        moved = Moved.of(view, name)
        if moved.old is None or moved.new is None:
            return None
        before, moment, after = view.before["top"], view.moment["top"], view.after["top"]
        things = Change.between(before, moment).things  # an arm's shadow falls on the other one's side
        edge = things[-round(len(things) * edge_share) :]
        left, right = np.array_split(edge, 2, axis=1)
        return cls(
            left=share_of(changed_between(before, moment), moved.old.covered),
            to_come=share_of(changed_between(after, moment), moved.new.covered),
            arms=(float(left.mean()), float(right.mean())),
            old=moved.old,
            new=moved.new,
        )

    def verdict(self, thing: str, hands: int, when: str, changed_share: float = 0.09) -> Verdict:
        """Judge if it was in the air, with that many arms out, at the moment.

        Args:
            thing, when: words for the object and the moment.
            hands: number of arms.
            changed_share: share of one half of the strip that an arm changes: each reaches in from its own side.
        """
        if self.left < LEFT_SHARE:
            return refused(f"the {thing} lies where it was at the moment of {when}", 1 - self.left, "lost")
        if self.to_come < LEFT_SHARE:
            return refused(f"the {thing} was put down before the moment of {when}", 1 - self.to_come)
        changed = " and ".join(f"{100 * share:.0f} %" for share in self.arms)
        who = "both arms reach" if hands == 2 else "an arm reaches"
        if sum(share >= changed_share for share in self.arms) < hands:
            missing = "not both arms reach" if hands == 2 else "no arm reaches"
            return refused(f"{missing} out at the moment of {when}: {changed} of their sides changed", 0.8)
        return decided(True, f"the {thing} is in the air while {who} out: {changed} of their sides changed", 0.7)


def held_by(hands: int, when: str) -> Judgement:
    """Judge if an object was in that many hands at the moment; ``when`` names the moment in a reason."""

    def judge(view: CriticView, goal: Goal) -> Judged:
        thing = view.phrase(goal.subject)
        if "top" not in view.moment:
            return unseen(view, f"the moment of {when} of the {thing}")
        evidence = InTheAir.gather(view, goal.subject)
        if evidence is None:
            return Judged(refused(f"the {thing} is not found before and after", 0.6), view.nowhere)
        return Judged(evidence.verdict(thing, hands, when), view.around(evidence.old, evidence.new))

    return judge
