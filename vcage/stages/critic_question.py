"""What the critic is given: two views of the table, calibration, and how each object looks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from vcage.models.protocols import CriticQuestion
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Goal
from vcage.stages.context import Workbench
from vcage.vision.protocols import Reference, View

TOP = "top"
"""Name of the scene's camera among the views; it is the one whose calibration every critic may rely on."""


def critic_question(
    scene: Scene,
    bench: Workbench,
    text: str,
    goals: Sequence[Goal],
    before: Mapping[str, np.ndarray],
    after: Mapping[str, np.ndarray],
    background: np.ndarray | None = None,
) -> CriticQuestion:
    """The question about one sub-task; pictures by camera name, taken by the scene's own cameras."""
    camera = scene.top_camera.camera()
    references = {
        o.id: Reference(o.phrase, *bench.reference(o), tuple(float(x) for x in bench.asset(o).size))
        for o in scene.objects
    }
    return CriticQuestion(
        text=text,
        goals=list(goals),
        before={TOP: View(before[TOP], camera)},
        after={TOP: View(after[TOP], camera)},
        references=references,
        table_height=scene.table.height,
        background=background,
    )


def background_name(episode: int) -> str:
    """File, in the folder of the episodes, of an episode's picture of the empty table."""
    return f"critic/e{episode:06d}-background-{TOP}.png"
