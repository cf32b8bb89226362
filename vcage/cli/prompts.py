"""``vcage prompts``: what models are asked."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from vcage.apps.asking import STAGE_OF_PROMPT, question_of
from vcage.base.errors import InputFileError, MissingStage, UsageError
from vcage.base.files import RunFolder
from vcage.base.options import FOLDER, choice
from vcage.cli.arguments import Command, parse
from vcage.cli.going_on import words_of
from vcage.cli.output import Result
from vcage.cli.stage import options_of
from vcage.models.exchange import Question


@dataclass(frozen=True, kw_only=True)
class ShowPrompt(Command):
    """Print a question that a run asks a model: the prompt filled in, the pictures, the schema of the answer.

    Nothing is sent, and the run is not changed. The asking stage takes the options of its last
    call; its earlier questions are answered as the run's models did, or by rules.

    examples:
      vcage prompts show plan_layout --run runs/stationery
      vcage prompts show judge_subtask --run runs/stationery
    """

    name: Annotated[str, Positional, choice(list(STAGE_OF_PROMPT)), arg(metavar="NAME")]
    """the prompt"""
    run: Annotated[Path, FOLDER]
    """the run folder"""

    def execute(self) -> Result:
        """Print it."""
        run, stage = RunFolder(self.run), STAGE_OF_PROMPT[self.name]
        if not run.root.is_dir():
            raise MissingStage(f"there is no run in {run}", hint="begin one", maker="select_place")
        try:
            command = parse(options_of(stage), words_of(stage, run), prog=stage, text="", about="")
        except UsageError as error:
            hint = "fix it, or remove it: it holds no results"
            raise InputFileError(f"{run.options}, of {stage}: {error.message}", hint=hint) from error
        assert command is not None  # no help is asked for
        question = question_of(self.name, run, command.stage)
        summary = {
            "role": question.role,
            "hash": question.hash,
            "characters": len(question.messages[0].text),
            "pictures": list(question.captions),
        }
        return Result(summary=summary, text=_text(question))


def _text(question: Question) -> str:
    parts = [question.messages[0].text]
    if question.captions:
        shown = zip(question.captions, question.messages[0].pictures, strict=True)
        parts.append("\n".join(f"[picture {p.shape[1]} x {p.shape[0]}: {caption}]" for caption, p in shown))
    if question.schema is not None:
        parts.append(json.dumps(question.schema))
    return "\n\n".join(parts)
