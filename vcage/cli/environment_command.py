"""The options of commands that open a run as an environment."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from tyro.conf import Positional, arg

from vcage.base.errors import UsageError
from vcage.base.options import FOLDER, NATURAL, POSITIVE, RANGES, UNSAID, Flag, several
from vcage.cli.arguments import Command

if TYPE_CHECKING:
    from vcage.evaluation.environment_options import EnvironmentOptions


@dataclass(frozen=True, kw_only=True)
class EnvironmentCommand(Command):
    """A command that opens a run as an environment."""

    run: Annotated[Path, FOLDER, Positional, arg(metavar="RUN")]
    """the run"""
    task: Annotated[int, NATURAL] = 0
    """number of the task, in a run that has several"""
    max_steps: Annotated[int | None, POSITIVE, UNSAID] = None
    """actions after which an episode ends (default: twice those of the run's longest accepted episode)"""
    randomise: Annotated[str | None, RANGES, UNSAID] = None
    """ranges of the differences between episodes, as of collect (default: those of the run)"""
    cameras: Annotated[tuple[str, ...], several("NAME ..."), UNSAID] = ()
    """whose pictures are observed (default: all of the robot)"""
    no_pictures: Flag = False
    """observe no pictures; no renderer is needed then, but for the videos of evaluate"""
    environment_state: Flag = False
    """observe the poses of the objects"""

    def environment(self) -> EnvironmentOptions:
        """Return these options for the environment.

        Raises:
            UsageError: cameras are chosen, and none are to be observed.
        """
        from vcage.evaluation.environment_options import EnvironmentOptions

        if self.cameras and self.no_pictures:
            raise UsageError("--cameras chooses pictures, and --no-pictures observes none", hint="leave one out")
        return EnvironmentOptions(
            chain=self.task,
            pictures=not self.no_pictures,
            cameras=self.cameras,
            environment_state=self.environment_state,
            max_steps=self.max_steps,
            randomise=self.randomise,
        )
