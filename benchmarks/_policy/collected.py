"""Episodes for the policy benchmark: the project's own stages on one instruction, with varied and with fixed layouts.

The same scene is collected three times: as it is by default, with a layout drawn anew for every episode; with
``--layout fixed``, the optimised layout with small shifts; and once more varied, from another seed, which is held out.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from vcage.base.errors import StaleStage, TooFewVerified
from vcage.base.files import RunFolder
from vcage.base.progress import Progress
from vcage.runs.accepted import accepted_episodes
from vcage.stages import collect, compress, inpaint_plan, match, optimize, search_subtasks, select_place, verify
from vcage.stages.chain import ChainOptions

logger = logging.getLogger(__name__)

SCENE_STAGES = (select_place, inpaint_plan, match, optimize, search_subtasks)

SCENE_SEED, HELD_OUT_SEED = 0, 1
"""Of the scene and the training episodes, and of the held-out ones: the same objects, other layouts and lights."""


@dataclass(frozen=True)
class Task:
    """The content of the episodes.

    Args:
        instruction: in plain language.
        robot: name of the robot.
        data: folder with the runs, which a second benchmark reuses.
        workers: processes that collect and compress; None for as many as there are cores.
    """

    instruction: str
    robot: str
    data: Path
    workers: int | None = None

    def varied(self, episodes: int) -> RunFolder:
        """Training episodes with random layouts, compressed as the project does by default."""
        options = self._options(episodes, "varied")
        run = self._collected("varied", options)
        context, said = options.context(run), _said("varied: compress")
        try:
            compress.execute(run, options, context, said)
        except StaleStage:  # more episodes were asked for than last time
            compress.execute(run, replace(options, force=True), context, said)
        return run

    def fixed(self, episodes: int) -> RunFolder:
        """Training episodes whose layout is the optimised one with small shifts."""
        return self._collected("fixed", self._options(episodes, "fixed"))

    def held_out(self, episodes: int) -> RunFolder:
        """Episodes of other varied layouts than those of training."""
        return self._collected("held-out", self._options(episodes, "varied"), HELD_OUT_SEED)

    def _options(self, episodes: int, layout: Literal["varied", "fixed"]) -> ChainOptions:
        return ChainOptions(
            instruction=self.instruction,
            robot=self.robot,
            episodes=episodes,
            layout=layout,
            seed=SCENE_SEED,
            models="offline",
            workers=self.workers,
            keep_raw=True,
        )

    def _collected(self, name: str, options: ChainOptions, seed: int = SCENE_SEED) -> RunFolder:
        """The run of that name with the wanted number of episodes; existing ones are not collected again."""
        run = RunFolder(self.data / name)
        context = options.context(run)
        for stage in SCENE_STAGES:
            stage.execute(run, options, context)
        own = replace(options, seed=seed)
        collect.execute(run, own, context, _said(f"{name}: collect"))
        verify.execute(run, own, context)
        found, wanted = len(accepted_episodes(run)), options.episodes or 0
        if found < wanted:
            raise TooFewVerified(f"{run.root} has {found} episodes, {wanted} are wanted")
        return run


def _said(what: str) -> Progress:
    """Progress as lines of the log."""
    return lambda step, number, total: logger.info("%s: %d of %d, %s", what, number, total, step)
