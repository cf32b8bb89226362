"""The agent that runs the stages is their model: it reads each question, errs once in every role, and corrects it."""

from __future__ import annotations

import json
import shlex
import shutil
from pathlib import Path
from typing import Any

import pytest

from tests.run_folders import FOLDERS, command, digests
from tests.scripted_agent import Act, Read, Run, ScriptedAgent, Write
from vcage.base.commands import vcage_command
from vcage.base.pictures import read_picture
from vcage.models.exchanges import Exchanges

TASK = "Get the table ready for the next player: the red and the green block both belong in the box"
"""Plain English that the rules refuse: whoever reads it is the model."""

CHAIN = (
    ("select-place", TASK, "--out"),
    ("inpaint-plan", "--run"),
    ("match", "--run"),
    ("optimize", "--run"),
    ("search-subtasks", "--run"),
    ("collect", "--episodes", "1", "--workers", "1", "--fps", "5", "--run"),
    ("verify", "--run"),
)


UNASKED = ("match", "optimize", "collect")
"""Stages that ask no agent."""


def carried_out(agent: ScriptedAgent, capsys: pytest.CaptureFixture[str], asked: str) -> dict[str, Any]:
    """Let the agent run a command in this process."""
    acts, seen = agent.run(asked), None
    while True:
        try:
            act = acts.send(seen)
        except StopIteration as end:
            return end.value
        seen = _seen(act, capsys)


def _seen(act: Act, capsys: pytest.CaptureFixture[str]) -> Any:
    if isinstance(act, Run):
        return json.dumps(command(capsys, *shlex.split(act.command)[1:]).record)
    if isinstance(act, Write):
        return act.path.write_text(act.text)
    return act.path.read_text() if isinstance(act, Read) else read_picture(act.path)


def chained(agent: ScriptedAgent, capsys: pytest.CaptureFixture[str], folder: Path, *models: str) -> list[str]:
    """Run the chain; return the stages that had something to do."""
    made = []
    for stage, *words in CHAIN:
        asked = () if stage == "optimize" else models
        ended = carried_out(agent, capsys, vcage_command(stage, *words, folder, *asked))
        assert ended["ok"], (stage, ended)
        made += [stage] if ended["summary"]["fresh"] else []
    return made


def test_the_rules_refuse_questions_for_the_agent(tmp_path: Path, capsys) -> None:
    answer = command(capsys, "select-place", TASK, "--out", tmp_path / "run", "--models", "offline")
    assert answer.code == 2 and "next player" in answer.error["message"]


@pytest.mark.slow
def test_an_agent_runs_the_chain_as_its_model_and_its_answers_are_replayed_byte_for_byte(
    tmp_path: Path, capsys
) -> None:
    agent, first = ScriptedAgent(), tmp_path / "run"
    assert chained(agent, capsys, first, "--models", "agent") == [stage for stage, *_ in CHAIN]
    agent.assert_it_mended_everything(first)
    assert agent.batches[-2] == 2, "verify asks for all verdicts at once"

    exchanges = Exchanges(first / "exchanges").all()
    assert {exchange.role for exchange in exchanges} == {"reasoner", "critic"}

    again = tmp_path / "again"
    for stage in UNASKED:  # these ask nobody; that their work is reproducible is for tests/test_chain.py
        shutil.copytree(first / FOLDERS[stage], again / FOLDERS[stage])
    made = chained(agent, capsys, again, "--models", "replay", "--replay", str(first))
    assert made == [stage for stage, *_ in CHAIN if stage.replace("-", "_") not in UNASKED]
    said = {name: digest for name, digest in digests(first).items() if not name.startswith(("ask/", "exchanges/"))}
    assert digests(again) == said
