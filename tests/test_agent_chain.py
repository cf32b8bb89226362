"""The agent that runs the stages is their model: it reads each question, errs once in every role, mends it, goes on."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.model_server.answers import answer_question
from tests.runs import Answer, command, digests
from vcage.base.files import RunFolder
from vcage.base.pictures import read_picture
from vcage.models.kept import Exchanges

TASK = "Put the red block and the green block into the box"
CHAIN = (
    ("select-place", TASK, "--out"),
    ("inpaint-plan", "--run"),
    ("match", "--run"),
    ("optimize", "--run"),
    ("search-subtasks", "--run"),
    ("collect", "--episodes", "1", "--workers", "1", "--fps", "5", "--run"),
    ("verify", "--run"),
)

MOST_CHARACTERS = 50_000
"""What clients let a model read of one file."""


class ScriptedAgent:
    """Runs commands, and answers what they ask; its first answer to each kind of question is wrong."""

    def __init__(self, capsys: pytest.CaptureFixture[str]):
        self.capsys = capsys
        self.erred: dict[str, str] = {}
        self.batches: list[int] = []

    def run(self, *words: str) -> Answer:
        while True:
            ended = command(self.capsys, *words)
            if ended.code != 8:
                return ended
            asked = ended.error["details"]["asked"]
            self.batches.append(len(asked))
            for question in asked:
                self._answer(question)

    def _answer(self, question: dict[str, Any]) -> None:
        folder = Path(question["folder"])
        prompt, schema = (folder / "prompt.md").read_text(), json.loads((folder / "schema.json").read_text())
        assert len(prompt) < MOST_CHARACTERS
        kind = " ".join(sorted(schema["properties"]))
        if kind not in self.erred:
            self.erred[kind] = ""
            Path(question["answer"]).write_text("{}")
            return
        self.erred[kind] = self.erred[kind] or question["complaint"]
        pictures = [read_picture(path) for path in sorted(folder.glob("picture-*.png"))]
        Path(question["answer"]).write_text(json.dumps(answer_question(schema, prompt, pictures)))


def chained(agent: ScriptedAgent, run: Path, *models: str) -> None:
    for stage, *words in CHAIN:
        ended = agent.run(stage, *words, str(run), *(() if stage == "optimize" else models))
        assert ended.code == 0, (stage, ended.record)


@pytest.mark.slow
def test_an_agent_runs_the_chain_as_its_model_and_what_it_said_is_replayed_byte_for_byte(
    tmp_path: Path, capsys
) -> None:
    agent, run = ScriptedAgent(capsys), tmp_path / "run"
    chained(agent, run, "--models", "agent")
    assert len(agent.erred) == 5, "selection, goals, plan, pairs, verdicts"
    assert all("Field required" in complaint for complaint in agent.erred.values())
    assert agent.batches[-2] == 2, "verify asks for all verdicts at once"

    verdicts = json.loads(RunFolder(run).verdicts.read_text())
    assert verdicts["provenance"]["providers"] == {"critic": "agent"}
    exchanges = Exchanges(run / "exchanges").all()
    assert {exchange.role for exchange in exchanges} == {"reasoner", "critic"}

    again = tmp_path / "again"
    chained(agent, again, "--models", "replay", "--replay", str(run))
    said = {name: digest for name, digest in digests(run).items() if not name.startswith(("ask/", "exchanges/"))}
    assert digests(again) == said
