"""The whole chain with models that are asked over a network: the services' stand-in, with and without faults."""

from __future__ import annotations

import json
import logging
import shlex
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

from tests.model_server import ModelServer, Special, text_answer
from tests.model_server.special import Faults
from tests.run_folders import QUICK_VIDEOS, REPOSITORY, Answer, command
from vcage.base.files import RunFolder, read_json
from vcage.models.exchanges import Exchanges

TASK = "Put the red block and the green block into the box"

SCRIPTS = REPOSITORY / "skills" / "vcage-igsc" / "scripts"

STAGES = ("select-place", "inpaint-plan", "match", "optimize", "search-subtasks", "collect", "verify")

OPTIONS = {"collect": ("--episodes", "1", "--workers", "1", "--fps", "5"), "compress": QUICK_VIDEOS}

PASSING = (6, 7)
"""Exit codes after which an agent runs ``next``, which is the same command."""

MOST_TRIES = 4

SEED = 11930
"""Of faults in a fifth of the calls: three and more, of which one ends a command."""


class Driven:
    """An agent that starts the chain with the models that it wants, and runs what each stage says is ``next``."""

    def __init__(self, capsys: pytest.CaptureFixture[str]):
        self._capsys = capsys
        self.shown: list[str] = []
        self.codes: Counter[int] = Counter()

    def chain(self, line: list[str]) -> None:
        done: list[str] = []
        while line[1] != "report":
            done.append(line[1])
            line = _following(self._ended(line))
        self._ended(line)
        assert done == [*STAGES, "compress", "export"]

    def _ended(self, line: list[str]) -> Answer:
        """The stage's answer, once it went well."""
        for _ in range(MOST_TRIES):
            answer = command(self._capsys, *line[1:])
            self.shown += [str(answer.record), answer.stderr]
            self.codes[answer.code] += 1
            if answer.code not in PASSING:
                break
            line = _following(answer)
        assert answer.code == 0, (line, answer.record, answer.stderr)
        return answer


def _following(answer: Answer) -> list[str]:
    line = shlex.split(answer.record["next"])
    return [*line, *OPTIONS.get(line[1], ())]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("models", "faults", "who"),
    [
        (("--models", "gemini"), None, {"gemini"}),
        (("--models", "openai", "--editor", "openrouter"), None, {"openai", "openrouter"}),
        (
            ("--models", "anthropic", "--editor", "openrouter", "--critic", "gemini"),
            Faults(0.2, SEED),
            {"anthropic", "openrouter", "gemini"},
        ),
    ],
    ids=("gemini", "openai with pictures of openrouter", "mixed with faults"),
)
def test_the_chain_runs_with_models_behind_endpoints(
    models: tuple[str, ...],
    faults: Faults | None,
    who: set[str],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    caplog: pytest.LogCaptureFixture,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    caplog.set_level(logging.DEBUG)
    run = tmp_path / "run"
    with ModelServer(faults=faults) as server:
        for name, value in server.environment.items():
            monkeypatch.setenv(name, value)
        driven = Driven(capsys)
        driven.chain(["vcage", "select-place", TASK, "--out", str(run), *models])
    exchanges = Exchanges(run / "exchanges").all()
    assert {exchange.provider.partition(":")[0] for exchange in exchanges} == who
    assert {exchange.role for exchange in exchanges} == {"reasoner", "editor", "critic"}
    assert (server.failed > 2) == (faults is not None)
    verdicts = read_json(RunFolder(run).verdicts)
    assert verdicts["provenance"]["providers"]["critic"].partition(":")[0] in who
    kept = [path for path in run.rglob("*") if path.is_file()]
    assert (run / "report.html") in kept
    assert not any(server.key.encode() in path.read_bytes() for path in kept)
    assert server.key not in "".join(driven.shown) + caplog.text


@pytest.mark.slow
def test_a_stage_script_that_meets_a_fault_says_how_to_go_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = str(tmp_path / "run")
    with ModelServer() as server:
        for name, value in server.environment.items():
            monkeypatch.setenv(name, value)
        script = [sys.executable, str(SCRIPTS / "select_place.py")]
        chosen = as_process([*script, TASK, "--out", run, "--models", "anthropic", "--editor", "openrouter"])
        server.queue(text_answer("I would rather not say."), Special(), Special(picture="AAAA"))
        failed = as_process(shlex.split(chosen.record["next"]))
        assert (failed.code, failed.error["code"], failed.error["retryable"]) == (6, "endpoint_failed", True)
        again = as_process(shlex.split(failed.record["next"]))
        assert (again.code, len(server.requests)) == (0, 7), "what was answered is not asked again"
    assert server.key not in str([chosen, failed, again])


def as_process(line: list[str]) -> Answer:
    done = subprocess.run(line, capture_output=True, text=True)
    lines = done.stdout.splitlines()
    assert lines, done.stderr
    return Answer(done.returncode, json.loads(lines[-1]), done.stdout + done.stderr)
