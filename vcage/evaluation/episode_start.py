"""Starts of evaluated episodes: drawn from streams that collecting never uses, or those of recorded episodes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from vcage.base.errors import UnknownName
from vcage.base.files import RunFolder
from vcage.datasets.reader import EpisodeReader
from vcage.episodes.beginnings import Beginnings
from vcage.episodes.recorded import Recorded
from vcage.evaluation.factors import OtherLook
from vcage.runs.accepted import accepted_episodes
from vcage.runs.context import StageContext
from vcage.schema.asset import PhysicalModel
from vcage.schema.randomisation import Drawn
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Grasp
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import Slot

EVALUATION_STREAM = 2
"""Third number of the seed of an evaluation: collecting draws episodes by two numbers, and wordings with a 1 here."""

WORDING_STREAM, LOOK_STREAM = 1, 2
"""Fourth numbers of the seeds by which wording and look are chosen: they stay where other factors are changed."""


@dataclass(frozen=True)
class EpisodeStart:
    """Everything that the start of an episode fixes.

    Args:
        scene, models, objects: as they are then.
        drawn: look and world.
        sentence: the instruction.
        origin: where the start comes from: ``seed`` or ``episode``, and its number.
        grasps: of each sub-task, by its id, best first; empty for a recorded start.
        slots: where each sub-task puts its object, by its id; empty for a recorded start.
    """

    scene: Scene
    models: Mapping[str, PhysicalModel]
    objects: Mapping[str, SceneObject]
    drawn: Drawn
    sentence: str
    origin: dict[str, int]
    grasps: Mapping[str, Sequence[Grasp]] = field(default_factory=dict)
    slots: Mapping[str, Slot] = field(default_factory=dict)

    @classmethod
    def drawn_by(cls, beginnings: Beginnings, seed: int, number: int, other: OtherLook | None = None) -> EpisodeStart:
        """The start of a number, which depends on nothing else.

        Args:
            beginnings: of the task.
            seed: of the run's scene.
            number: of the start.
            other: the look in which one factor is changed.

        Raises:
            InfeasibleScene: its objects do not stay where they are put.
        """
        looks = [seed, number, EVALUATION_STREAM, LOOK_STREAM]
        begins = beginnings.draw(np.random.default_rng([seed, number, EVALUATION_STREAM]), np.random.default_rng(looks))
        drawn = begins.drawn
        if other is not None:
            look = beginnings.look(begins.start, other.ranges, np.random.default_rng(looks))
            drawn = drawn.model_copy(update={"look": other.change(drawn.look, look)})
        start, sentences = begins.start, beginnings.sentences(begins.start).all
        words = np.random.default_rng([seed, number, EVALUATION_STREAM, WORDING_STREAM])
        sentence = sentences[int(words.integers(len(sentences)))]
        return cls(
            start.scene,
            start.models,
            start.objects,
            drawn,
            sentence,
            {"seed": number},
            start.grasps,
            start.slots,
        )

    @classmethod
    def recorded(cls, run: RunFolder, index: int, context: StageContext) -> EpisodeStart:
        """The start of an accepted episode of a run.

        Raises:
            UnknownName: there is none of that number.
            DamagedFile, SchemaMismatch: its file cannot be read.
        """
        found = {episode.index: episode for episode in accepted_episodes(run)}
        if index not in found:
            raise UnknownName("accepted episode", str(index), map(str, found))
        path = run.file(str(found[index].file))
        with EpisodeReader(path) as reader:
            begun = Recorded.of(reader.episode, path, context)
        objects = {o.id: o for o in context.objects(begun.scene)}
        sentence = str(begun.episode.meta["task"])
        return cls(begun.scene, begun.models, objects, begun.drawn, sentence, {"episode": index})
