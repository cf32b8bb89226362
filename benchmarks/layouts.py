"""Layouts of the paper's tasks as episodes draw them: how fast, how many are refused and why, how they use the table.

``fill`` is how many cells of 5 cm an object's middle is found in, over as many draws, against how many it would be
found in if it were drawn uniformly from where the arms reach it within the workspace: 1 where nothing else rules, less
where the plan's relations, the other objects or the chain's feasibility leave less.
"""

from __future__ import annotations

import argparse
import logging
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks._laying_out import lay_out
from benchmarks.tasks import TASKS
from vcage.base.errors import VcageError
from vcage.base.files import RunFolder
from vcage.episodes.layouts import Layout, Layouts, NoLayout
from vcage.layout.items import centres_within
from vcage.runs.context import StageContext
from vcage.runs.inputs import read_plan
from vcage.runs.stage import ModelOptions
from vcage.schema.robot import DEFAULT_ROBOT
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtasks
from vcage.stages import search_subtasks, select_place
from vcage.tasks.stowing import ready_for

logger = logging.getLogger(__name__)

CELL = 0.05
"""Edge of a cell in which an object is found or not, metres."""

DRAWS, QUICK_DRAWS = 100, 10


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument("--robot", default=DEFAULT_ROBOT, help="which one (default: %(default)s)")
    parser.add_argument("--tasks", nargs="+", choices=TASKS, default=list(TASKS), help="which ones")


def run(quick: bool, robot: str = DEFAULT_ROBOT, tasks: Sequence[str] = tuple(TASKS)) -> dict[str, Any]:
    """A row for each task; reasons of refusals go to the log.

    Args:
        quick: 10 layouts of each, not 100.
        robot: by name.
        tasks: names of the paper's.
    """
    context = StageContext("offline")
    return {"rows": [_row(name, robot, QUICK_DRAWS if quick else DRAWS, context) for name in tasks]}


def _row(name: str, robot: str, draws: int, context: StageContext) -> dict[str, Any]:
    layouts, scene = _layouts_of(TASKS[name], robot, context)
    found: list[Layout] = []
    refused: Counter[str] = Counter()
    start, given_up = time.perf_counter(), 0
    for number in range(draws):
        try:
            found.append(layouts.draw(np.random.default_rng([0, number])))
            refused.update(found[-1].refused)
        except NoLayout as error:
            refused.update(error.details["refused"])
            given_up += 1
    seconds = time.perf_counter() - start
    for reason, count in refused.most_common(5):
        logger.info("%s: %d × %s", name, count, reason)
    fills = [fill(places, region) for places, region in _spread(found, scene, context) if len(region)]
    drawn = len(found) + sum(refused.values())
    return {
        "task": name,
        "robot": robot,
        "layouts": len(found),
        "none_found": given_up,
        "refused": round(sum(refused.values()) / drawn, 4) if drawn else None,
        "seconds": round(seconds / draws, 3),
        "deviation_cm": round(100 * float(np.mean([p.std(axis=0) for p, _ in _spread(found, scene, context)])), 1),
        "fill_least": round(min(fills), 3) if fills else None,
        "fill_mean": round(float(np.mean(fills)), 3) if fills else None,
    }


def _layouts_of(sentence: str, robot: str, context: StageContext) -> tuple[Layouts, Scene]:
    """Return the source of layouts of an instruction's first chain, from the first seed that no stage refuses."""
    for seed in range(10):
        with tempfile.TemporaryDirectory() as folder:
            made = RunFolder(Path(folder) / "run")
            try:
                lay_out(
                    made, select_place.Options(instruction=sentence, models="offline", seed=seed, robot=robot), context
                )
                search_subtasks.execute(made, ModelOptions(models="offline"), context)
            except VcageError as error:
                logger.info("seed %d: %s", seed, error.message)
                continue
            scene, record = Scene.read(made.layout), Subtasks.read(made.subtasks)
            kept = {subtask.id: subtask for subtask in record.kept}
            chain = [kept[name] for name in record.chains[0].subtasks]
            start = ready_for(chain[0], scene, context.objects(scene))
            return Layouts(start, read_plan(made, Scene.read(made.scene), context).relations, chain, context), start
    raise VcageError(f"no seed gave a scene for {sentence!r}")


def _spread(found: Sequence[Layout], scene: Scene, context: StageContext) -> list[tuple[np.ndarray, np.ndarray]]:
    """Of each object on the table: (n, 2) where it stood, and (m, 2, 2) where it could have stood alone, metres."""
    workspace = np.array([[scene.workspace.lower, scene.workspace.upper]])
    spread = []
    for o in context.objects(scene):
        if o.record.container is None and found:
            reach = context.within_reach(o.asset, o.record.role, scene)
            alone = centres_within(workspace, np.full(2, min(o.asset.size[:2]) / 2))
            region = alone if reach is None else _cut(reach, alone[0])
            spread.append((np.array([layout.poses[o.id].p[:2] for layout in found]), region))
    return spread


def _cut(rectangles: np.ndarray, bounds: np.ndarray) -> np.ndarray:
    """Cut (m, 2, 2) rectangles to another (2, 2)."""
    cut = np.stack([np.maximum(rectangles[:, 0], bounds[0]), np.minimum(rectangles[:, 1], bounds[1])], axis=1)
    return cut[np.all(cut[:, 0] < cut[:, 1], axis=1)]


def fill(places: np.ndarray, region: np.ndarray) -> float:
    """Occupied cells, against those expected of as many uniform draws from a region.

    Args:
        places: (n, 2) where it was, metres.
        region: (m, 2, 2) union of rectangles that it might have been in.
    """
    fine = CELL / 10
    lower, upper = region[:, 0].min(axis=0), region[:, 1].max(axis=0)
    axes = [np.arange(lower[k] + fine / 2, upper[k], fine) for k in range(2)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    inside = np.any([np.all((low <= points) & (points <= high), axis=1) for low, high in region], axis=0)
    _, counts = np.unique(np.floor(points[inside] / CELL).astype(int), axis=0, return_counts=True)
    expected = float(np.sum(1 - (1 - counts / counts.sum()) ** len(places)))
    return len(np.unique(np.floor(places / CELL).astype(int), axis=0)) / expected
