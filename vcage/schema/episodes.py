"""Verdicts of the critic, attempts, the episodes that were accepted, and their renders under other looks."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import Field

from vcage.base.proportions import wilson
from vcage.schema.base import (
    Document,
    Finite,
    Identifier,
    NearPath,
    Point2,
    PoseRecord,
    Record,
    RunPath,
    StageDocument,
)
from vcage.schema.randomisation import Drawn
from vcage.schema.scene import ObjectRecord, Scene
from vcage.schema.subtasks import Chain

BY_HAND = "by hand"
"""Provider of a verdict that a person changed."""

AttemptStage = Literal["plan", "grasp", "place", "verify", "done"]
"""Stage that an attempt at a sub-task reached; ``done`` means accepted."""

Failure = Literal["lost", "astray", "disturbed"]
"""Kinds of failure that another attempt can avoid: an object was not taken, or lost on the way; it was brought to an
unstable place (a rim, beside its place, a receptacle knocked over); something else was moved."""


Accept = Literal["both", "critic", "state"]
"""Who must call a sub-task done for it to be accepted: the critic and the simulator's state, or one of them alone."""


class Verdict(Record):
    """φ(I, T) ∈ {0, 1} of the paper, with the reason and the pictures behind it."""

    accepted: bool
    reason: str = Field(min_length=1)
    confidence: Finite = Field(ge=0, le=1)
    provider: str
    failure: Failure | None = Field(default=None, description="what went wrong, where it is a no and that can be told")
    pictures: list[NearPath] = Field(default=[], description="paths of the pictures, relative to the verdict's file")
    question: str = Field(default="", description="SHA-256 of what was asked: text, goals, and the pictures' pixels")


class Truth(Record):
    """Judgement by the simulator's state; it judges the critic and is never shown to it."""

    success: bool
    reason: str


def accepts(accept: Accept, verdict: Verdict, truth: Truth) -> bool:
    """Check if a sub-task with this verdict and this truth is accepted."""
    judges = {"critic": [verdict.accepted], "state": [truth.success], "both": [verdict.accepted, truth.success]}
    return all(judges[accept])


class Attempt(Record):
    """One line of ``episodes/log.jsonl``: one try at one sub-task."""

    episode: int = Field(ge=0)
    step: int = Field(ge=0, description="index in the chain")
    attempt: int = Field(ge=0)
    subtask: Identifier
    object: Identifier
    asset: Identifier
    variant: Identifier
    arm: str | None
    contact: int | None
    changes: list[str] = Field(default=[], description="what was done otherwise: grasp, arm, slot, way to operate")
    stage: AttemptStage
    reason: str
    accepted: bool
    verdict: Verdict | None = None
    truth: Truth | None = None
    steps: int = Field(ge=0, description="physics steps taken")

    @property
    def disputed(self) -> bool:
        """True if critic and simulator state disagree."""
        return self.verdict is not None and self.truth is not None and self.verdict.accepted != self.truth.success


class Episode(Record):
    """One episode that ran to its end: accepted, or aborted and kept under ``rejected/``."""

    index: int = Field(ge=0, description="the n-th episode of chain c has the number n · chains + c, from 0 on")
    chain: int = Field(default=0, ge=0, description="which of the chains was carried out")
    seed: int = Field(ge=0)
    accepted: bool
    reason: str
    file: RunPath | None = Field(default=None, description="HDF5 in the run folder; none when nothing was recorded")
    frames: int = Field(default=0, ge=0)
    fps: Finite
    layout: Literal["varied", "fixed"] | None = Field(default=None, description="own, or the run's; None: never begun")
    layouts_refused: dict[str, int] = Field(default={}, description="reason to refuse a layout → count")
    objects: list[ObjectRecord] = Field(default=[], description="those of its scene, where and as it started")
    randomisation: Drawn | None = Field(default=None, description="what was drawn for it; none where it never began")
    subtasks: list[Identifier] = []
    verdicts: list[Verdict] = []
    attempts: int = Field(default=0, ge=0)
    goals_hold: Truth | None = Field(default=None, description="do all goals of the chain hold at the end?")

    @property
    def poses(self) -> dict[str, PoseRecord]:
        """Starting pose by object."""
        return {o.id: o.pose for o in self.objects}

    def scene(self, scene: Scene) -> Scene:
        """A scene of the run as it was when the episode started: its objects, its table's height and top."""
        if not self.objects or self.randomisation is None:
            return scene
        height = scene.table.height + self.randomisation.world.table_height
        table = scene.table.model_copy(update={"height": height}).topped(self.randomisation.look.table_top)
        return scene.model_copy(update={"objects": self.objects, "table": table})


class CountedShare(Record):
    """A share of a few, with its Wilson interval at 95 %."""

    some: int = Field(ge=0)
    of: int = Field(ge=0)
    share: Finite | None = Field(description="none where there was nothing to count")
    low: Finite = Field(ge=0, le=1)
    high: Finite = Field(ge=0, le=1)

    @classmethod
    def counted(cls, some: int, of: int) -> Self:
        """The share of two counts."""
        low, high = wilson(some, of)
        return cls(some=some, of=of, share=round(some / of, 4) if of else None, low=round(low, 4), high=round(high, 4))

    def __str__(self) -> str:
        return f"{self.some} of {self.of} ({100 * self.low:.0f}-{100 * self.high:.0f} %)"


class CriticCounts(Record):
    """A critic against the simulator's truth, over the attempts that were judged."""

    judged: int = Field(ge=0)
    true_accepted: int = Field(ge=0)
    false_accepted: int = Field(ge=0)
    false_refused: int = Field(ge=0)
    true_refused: int = Field(ge=0)
    precision: CountedShare = Field(description="successes among what was accepted")
    recall: CountedShare = Field(description="what was accepted among the successes")

    @classmethod
    def of(cls, pairs: Iterable[tuple[bool, bool]]) -> Self:
        """Of pairs: the critic's acceptance, and the truth."""
        judged = list(pairs)
        true, false_no = judged.count((True, True)), judged.count((False, True))
        return cls(
            judged=len(judged),
            true_accepted=true,
            false_accepted=judged.count((True, False)),
            false_refused=false_no,
            true_refused=judged.count((False, False)),
            precision=CountedShare.counted(true, sum(said for said, _ in judged)),
            recall=CountedShare.counted(true, true + false_no),
        )


class Episodes(StageDocument):
    """``episodes/episodes.json``.

    Example:
        >>> Episodes.read(RunFolder("runs/blocks").episodes).episodes[0].task
    """

    SCHEMA: ClassVar[str] = "vcage.episodes/4"

    instruction: str | None
    chains: list[Chain]
    episodes: list[Episode] = Field(description="by number; a number that is missing was not needed")
    accept: Accept = Field(default="critic", description="judges of a sub-task; earlier runs had the critic alone")
    attempts: int = Field(ge=0, description="lines of log.jsonl")
    acceptance: dict[str, dict[str, int]] = Field(description="asset/variant → {accepted, attempts}")
    critic: CriticCounts

    def spread(self) -> dict[str, Spread]:
        """By object of the run's scene, over the accepted episodes; nothing where there are none."""
        found, accepted = {}, [episode for episode in self.episodes if episode.accepted]
        started = [episode.poses for episode in accepted]
        clutter = {name for e in accepted if e.randomisation for name in e.randomisation.world.clutter}
        for name in [name for name in (started[0] if started else ()) if name not in clutter]:
            at = np.array([poses[name].position[:2] for poses in started if name in poses])
            lower, upper, deviation = (tuple(v.round(4).tolist()) for v in (at.min(0), at.max(0), at.std(0)))
            found[name] = Spread(lower=lower, upper=upper, deviation=deviation)
        return found

    def layouts(self) -> dict[str, int]:
        """Number of layouts drawn for the episodes, and of the refused ones."""
        refused = sum(sum(episode.layouts_refused.values()) for episode in self.episodes)
        return {"drawn": refused + sum(e.layout == "varied" for e in self.episodes), "refused": refused}


class Spread(Record):
    """Range of one object's starting positions over the episodes of a run, metres."""

    lower: Point2
    upper: Point2
    deviation: Point2 = Field(description="standard deviation along x and y")


class Difference(Record):
    """An attempt on which a second critic contradicts the first one."""

    episode: int = Field(ge=0)
    step: int = Field(ge=0, description="index in the chain")
    attempt: int = Field(ge=0)
    subtask: Identifier
    text: str = Field(description="the sub-task in words")
    earlier_verdict: Verdict = Field(description="of the critic that collected")
    verdict: Verdict
    truth: Truth
    picture: NearPath = Field(description="what both judges saw, with what they said; relative to this file")


class Verdicts(StageDocument):
    """``verify/verdicts.json``: second judgement of the collected attempts."""

    SCHEMA: ClassVar[str] = "vcage.verdicts/2"

    accept: Accept = Field(default="critic", description="judges of the episodes; if 'state', no critic refuses any")
    episodes: dict[str, list[Verdict]] = Field(description="file of an accepted episode → one verdict per sub-task")
    taken_over: int = Field(default=0, ge=0, description="verdicts of the same critic on the same question, reused")
    critic: CriticCounts = Field(description="this critic, over the attempts that it judged of which truth is kept")
    earlier_critic: CriticCounts = Field(description="the critic that collected, over the same attempts")
    not_kept: int = Field(ge=0, description="attempts judged while collecting that have no pictures or truth any more")
    differences: list[Difference] = Field(description="where the two say otherwise, in the order of the attempts")

    @property
    def refused(self) -> dict[str, str]:
        """File of an episode that does not count any more → the first reason why."""
        deciding = {
            file: [v for v in said if self.accept != "state" or v.provider == BY_HAND]
            for file, said in self.episodes.items()
        }
        first = {file: next((v for v in said if not v.accepted), None) for file, said in deciding.items()}
        return {file: verdict.reason for file, verdict in first.items() if verdict is not None}


class SingleVerdict(Document):
    """The answer about one picture pair and one sub-task text."""

    SCHEMA: ClassVar[str] = "vcage.verdict/1"

    text: str
    verdict: Verdict


class Render(Record):
    """One episode under one other look; its random draws are in the file's ``meta/randomisation``."""

    episode: int = Field(ge=0, description="number of the episode in the run")
    look: int = Field(ge=0, description="number of the look, from 0")
    ranges: str = Field(description="name of the ranges that the look was drawn from")
    seed: int = Field(ge=0, description="of the looks")
    file: RunPath = Field(description="path in the run folder")
    frames: int = Field(ge=1)


class Renders(StageDocument):
    """All renders of a run, of earlier calls of ``vcage render`` too."""

    SCHEMA: ClassVar[str] = "vcage.renders/2"

    renders: list[Render]
