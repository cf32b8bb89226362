"""Beginnings of the episodes of a run: where objects stand, the look, and the words, drawn as the run asks for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.files import RunFolder
from vcage.episodes.starts import Start, Starts
from vcage.episodes.wordings import wordings_for
from vcage.episodes.worlds import reworded
from vcage.plans.actions import lasting
from vcage.runs.context import StageContext
from vcage.runs.inputs import read_plan
from vcage.schema.goals import Goal, in_steps
from vcage.schema.plan import Relation
from vcage.schema.randomisation import Drawn, Look, LookRanges, Randomisation
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Chain, Subtask
from vcage.sim.looks import draw_look
from vcage.sim.robots import load_robot
from vcage.tasks.described import require_settled
from vcage.tasks.stowing import ready_for
from vcage.tasks.templates import read_subtasks
from vcage.tasks.wording import in_other_words


@dataclass(frozen=True)
class Beginning:
    """The beginning of an episode.

    Args:
        start: objects where they stand, with grasps and slots of each sub-task.
        drawn: its look and the differences of its world.
    """

    start: Start
    drawn: Drawn


@dataclass(frozen=True)
class Sentences:
    """The words of an episode.

    Args:
        canonical: the instruction, or the words of the sub-task, about the objects as they look.
        all: wordings of the same meaning, the canonical one among them.
        subtasks: of the chain, in the words of the episode.
    """

    canonical: str
    all: list[str]
    subtasks: list[Subtask]


class Beginnings:
    """Draws the beginnings of the episodes of one chain.

    Args:
        scene: of the run, with an optimised layout.
        chain: of the run.
        subtasks: of the chain, in order.
        relations: of the plan, which hold in drawn layouts; None if none are drawn.
        ranges: of the differences between episodes.
        context: the library.

    Attributes:
        goals: what must be true at the end.
    """

    def __init__(
        self,
        scene: Scene,
        chain: Chain,
        subtasks: Sequence[Subtask],
        relations: Sequence[Relation] | None,
        ranges: Randomisation,
        context: StageContext,
    ):
        self.chain, self.subtasks, self.robot = chain, list(subtasks), load_robot(scene.robot)
        self.goals: list[Goal] = lasting(in_steps(scene.goals) or [subtask.goals for subtask in subtasks])
        self._scene, self._ranges, self._context = scene, ranges, context
        ready = ready_for(subtasks[0], scene, context.objects(scene))  # an instruction starts where its plan was proven
        self._starts = Starts(ready, relations, subtasks, ranges.world, context)

    @classmethod
    def of_run(
        cls, run: RunFolder, ranges: Randomisation, context: StageContext, varied: bool = True
    ) -> list[Beginnings]:
        """The beginnings of each chain of a run.

        Args:
            run: with a layout and sub-tasks.
            ranges: of the differences between episodes.
            context: the library.
            varied: draw a layout for each episode, as the plan allows; without, objects stand as optimised, with small
                shifts.

        Raises:
            MissingStage: the run lacks its layout or sub-tasks.
            DamagedFile, SchemaMismatch: one of its files cannot be read.
        """
        scene, found = Scene.read(run.layout), read_subtasks(run.subtasks)
        kept = {subtask.id: subtask for subtask in found.kept}
        planned = varied and run.plan.exists()  # a script that runs alone has no plan
        relations = read_plan(run, Scene.read(run.scene), context).relations if planned else None
        return [cls(scene, c, [kept[name] for name in c.subtasks], relations, ranges, context) for c in found.chains]

    def draw(self, rng: np.random.Generator, looks: np.random.Generator | None = None) -> Beginning:
        """A beginning in which the chain is feasible.

        Args:
            rng: source of every choice.
            looks: source of the choices of the look; None: ``rng``, after all others.

        Raises:
            InfeasibleScene: the objects do not stay where they were put.
        """
        start = self._starts.draw(rng)
        objects = list(start.objects.values())
        require_settled(start.scene, start.models, objects, "the start of the episode", self.robot)
        look = self.look(start, self._ranges.look, rng if looks is None else looks)
        return Beginning(start, Drawn(ranges=self._ranges.name, look=look, world=start.world))

    def look(self, start: Start, ranges: LookRanges, rng: np.random.Generator) -> Look:
        """A look of a start, drawn from ranges."""
        return draw_look(ranges, start.scene, start.models, self.robot, rng)

    def sentences(self, start: Start) -> Sentences:
        """The words of an episode that begins there."""
        said = [reworded(subtask, start.phrases) for subtask in self.subtasks]
        text = self.chain.text if self._scene.instruction else in_other_words(self.chain.text, start.phrases)
        wordings = [in_other_words(wording, start.phrases) for wording in self.chain.wordings]
        return Sentences(text, wordings_for(text, wordings, said, start.scene, self._context), said)
