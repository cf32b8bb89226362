"""Videos of rollouts, simulated again from their actions: what a policy observed need not be what people look at."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vcage.apps.report.previews import browser_video, side_by_side
from vcage.base.errors import NoRenderer
from vcage.base.files import RunFolder, write_bytes
from vcage.base.progress import Progress, silent
from vcage.evaluation.evaluate import actions_file
from vcage.evaluation.rollouts import Order, Rollouts
from vcage.schema.evaluation import Evaluation, Rollout
from vcage.schema.scene import Scene
from vcage.sim.robots import load_robot

logger = logging.getLogger(__name__)

WRIST = "wrist"
"""Part of the names of cameras that hands carry; people look through the others."""


def chosen(record: Evaluation, most: int) -> list[Rollout]:
    """Rollouts to look at: failures of each kind in turn, and a quarter of successes, in the order of their seeds."""
    kinds: dict[str, list[Rollout]] = {}
    for rollout in record.rollouts:
        kinds.setdefault(rollout.furthest, []).append(rollout)
    successes = kinds.pop("done", [])
    failures = [kind[turn] for turn in range(most) for kind in kinds.values() if turn < len(kind)]
    shown = min(len(successes), max(most // 4, most - len(failures)))
    return sorted([*failures[: most - shown], *successes[:shown]], key=lambda rollout: rollout.seed)


def film(order: Order, record: Evaluation, out: Path, most: int, progress: Progress = silent) -> dict[int, Path]:
    """Write ``videos/<seed>.mp4`` of some rollouts, where they are not there yet.

    Args:
        order: of the evaluation.
        record: of it.
        out: its folder.
        most: videos at most.
        progress: told before each video.

    Returns:
        Seed → its video; empty, with a warning, where nothing here can draw.
    """
    wanted = chosen(record, most)
    paths = {rollout.seed: out / "videos" / f"{rollout.seed}.mp4" for rollout in wanted}
    missing = [seed for seed, path in paths.items() if not path.exists()]
    if missing:
        try:
            camera = _Camera(order)
        except NoRenderer as error:
            logger.warning("no videos of rollouts: %s", error)
            return {}
        for number, seed in enumerate(missing):
            progress(f"video of {seed}", number, len(missing))
            write_bytes(paths[seed], camera.video(seed, np.load(actions_file(out, seed))))
    return paths


class _Camera:
    """Draws rollouts of an order, side by side by all cameras that hands do not carry.

    Args:
        order: of the evaluation.

    Raises:
        NoRenderer: nothing here can draw.
    """

    def __init__(self, order: Order):
        every = list(load_robot(Scene.read(RunFolder(order.run).layout).robot).cameras)
        cameras = tuple(name for name in every if WRIST not in name) or tuple(every)
        self._rollouts = Rollouts(
            replace(order, environment=replace(order.environment, pictures=True, cameras=cameras))
        )

    def video(self, seed: int, actions: NDArray[np.float64]) -> bytes:
        """Return the MP4 of a rollout."""
        return browser_video(self._frames(seed, actions), self._rollouts.env.fps)

    def _frames(self, seed: int, actions: NDArray[np.float64]) -> Iterator[NDArray[np.uint8]]:
        env = self._rollouts.env
        seen = self._rollouts.begun(seed)
        yield side_by_side([*seen["pixels"].values()])
        for action in actions:
            env.act(action)
            yield side_by_side([*env.observe()["pixels"].values()])
