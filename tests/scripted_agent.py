"""An agent that runs commands and is their model: it errs once per kind of question, reads why, corrects it, continues.

Its steps are acts; the executor sends back the result: in this process, or through a client's tools.
"""

from __future__ import annotations

import json
from collections.abc import Generator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from tests.model_server.answers import answer_question
from vcage.base.files import RunFolder

MOST_CHARACTERS = 50_000
"""What clients let a model read of one file."""


@dataclass(frozen=True)
class Run:
    """Run a command; what it printed is seen."""

    command: str


@dataclass(frozen=True)
class Read:
    """Read a file of text; its text is seen."""

    path: Path


@dataclass(frozen=True)
class Look:
    """Look at a picture; (H, W, 3) uint8 RGB is seen."""

    path: Path


@dataclass(frozen=True)
class Write:
    """Write a file; nothing is seen."""

    path: Path
    text: str


Act = Run | Read | Look | Write


@dataclass
class ScriptedAgent:
    """Its own memory: how it erred, and how many questions came at once."""

    erred: dict[str, str] = field(default_factory=dict)
    """The fields of a kind of question → the complaint about its first answer, which was wrong."""
    batches: list[int] = field(default_factory=list)

    def assert_it_mended_everything(self, run: Path) -> None:
        """It erred once in each kind of question, was told why, and its verdicts count."""
        assert len(self.erred) == 8, "selection, goals, review, plan, pairs, wordings, slots, verdicts"
        assert all("Field required" in complaint for complaint in self.erred.values())
        verdicts = json.loads(RunFolder(run).verdicts.read_text())
        assert verdicts["provenance"]["providers"] == {"critic": "agent"}

    def run(self, command: str) -> Generator[Act, Any, dict[str, Any]]:
        """Run a command to its end, answering what it asks; its record is returned."""
        while True:
            record = last_record((yield Run(command)))
            if record["ok"] or record["error"]["code"] != "answer_needed":
                return record
            asked = record["error"]["details"]["asked"]
            self.batches.append(len(asked))
            for question in asked:
                yield from self._answer(question)
            command = record["next"]

    def _answer(self, question: dict[str, Any]) -> Generator[Act, Any, None]:
        folder, answer = Path(question["folder"]), Path(question["answer"])
        prompt, schema = (yield Read(folder / "prompt.md")), json.loads((yield Read(folder / "schema.json")))
        assert len(prompt) < MOST_CHARACTERS
        kind = " ".join(sorted(schema["properties"]))
        if kind not in self.erred:
            self.erred[kind] = ""
            yield Write(answer, "{}")
            return
        self.erred[kind] = self.erred[kind] or question["complaint"]
        pictures: list[np.ndarray] = []
        for name in question["files"]:
            if name.startswith("picture-"):
                pictures.append((yield Look(folder / name)))
        yield Write(answer, json.dumps(answer_question(schema, prompt, pictures)))


def last_record(printed: str) -> dict[str, Any]:
    """The JSON object at the end of a command's output; a client may add lines of its own, and stderr."""
    lines = [line for line in printed.splitlines() if line.startswith("{") and '"ok": ' in line]
    assert lines, printed
    return json.loads(lines[-1])
