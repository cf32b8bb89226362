"""``vcage verify``: the stage, or one pair of pictures."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import arg

from vcage.base.errors import UsageError
from vcage.base.files import RunFolder
from vcage.base.options import UNSAID
from vcage.cli.arguments import Command
from vcage.cli.output import Result
from vcage.cli.stage import StageCommand, execute_stage
from vcage.episodes.second_judge import judge_pair
from vcage.stages import verify

PICTURE = arg(metavar="PNG")


@dataclass(frozen=True, kw_only=True)
class Verify(StageCommand[verify.Options], Command):
    """Judge from pictures whether sub-tasks were done: all collected ones again, or one pair of pictures.

    Reads episodes/. Writes verify/verdicts.json: verdicts of the accepted episodes, precision and recall of this critic
    and of the one that collected (n and interval at 95 %), and where the two differ, each with a picture in
    verify/differences/. Attempts that were not accepted are judged with --refused alone. With --before and --after only
    answers.

    examples:
      vcage verify --run runs/stationery --models gemini --refused --force
      vcage verify --run runs/stationery --subtask marker_black-into-packaging_box --before a.png --after b.png
    """

    subtask: Annotated[str | None, arg(metavar="ID"), UNSAID] = None
    """with --before and --after: the sub-task that is judged"""
    before: Annotated[Path | None, PICTURE, UNSAID] = None
    """top view before, from the run's camera"""
    after: Annotated[Path | None, PICTURE, UNSAID] = None
    """top view after"""

    def execute(self) -> Result:
        """Run the stage, or judge one pair.

        Raises:
            UsageError: only some of --subtask, --before, --after are given.
        """
        if self.subtask and self.before and self.after:
            run = RunFolder(self.run)
            context = self.stage.context(run)
            answer = judge_pair(run, context, self.subtask, self.before, self.after)
            return Result(schema=answer.SCHEMA, summary=answer.model_dump(mode="json", by_alias=True))
        if self.subtask or self.before or self.after:
            raise UsageError("--subtask, --before and --after belong together", hint="give all three, or none")
        return execute_stage("verify", self)
