"""The whole chain with models that are asked over a network: the services' stand-in, with and without faults."""

from __future__ import annotations

import contextlib
import io
import json
import logging
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from tests.model_server import ModelServer, Special, text_answer
from tests.model_server.special import Faults
from tests.run_folders import QUICK_VIDEOS, REPOSITORY, Answer, command, copied
from vcage.base.files import RunFolder, read_json
from vcage.cli.main import main
from vcage.models.exchanges import Exchanges

TASK = "Put the red block and the green block into the box"

SCRIPTS = REPOSITORY / "skills" / "vcage-igsc" / "scripts"

STAGES = ("select-place", "inpaint-plan", "match", "optimize", "search-subtasks", "collect", "verify")

OPTIONS = {"collect": ("--episodes", "1", "--workers", "1", "--fps", "5"), "compress": QUICK_VIDEOS}

PASSING = (6, 7)
"""Exit codes after which an agent runs ``next``, which is the same command."""

MOST_TRIES = 4

SEED = 11930
"""Seed of faults in a fifth of the calls: three and more, of which one ends a command."""


@dataclass(frozen=True)
class Mixed:
    """A whole chain whose reasoner, editor and critic are of three providers, with faults."""

    run: Path
    failed: int
    key: str
    shown: str
    """All that its commands printed and logged."""


@pytest.fixture(scope="module")
def mixed(tmp_path_factory: pytest.TempPathFactory) -> Mixed:
    run, shown = tmp_path_factory.mktemp("models") / "run", io.StringIO()
    loggers = [logging.getLogger(name) for name in ("vcage", "urllib3")]  # commands replace the handlers of the root
    log = logging.StreamHandler(shown)
    with pytest.MonkeyPatch.context() as patch, ModelServer(faults=Faults(0.2, SEED)) as server:
        use(server, patch)
        for logger in loggers:
            logger.addHandler(log)
            logger.setLevel(logging.DEBUG)
        models = ("--models", "anthropic", "--editor", "openrouter", "--critic", "gemini")
        try:
            chain(["vcage", "select-place", TASK, "--out", str(run), *models], shown)
        finally:
            for logger in loggers:
                logger.removeHandler(log)
                logger.setLevel(logging.NOTSET)
    return Mixed(run, server.failed, server.key, shown.getvalue())


def use(server: ModelServer, patch: pytest.MonkeyPatch) -> None:
    """Let this process ask a server."""
    for name, value in server.environment.items():
        patch.setenv(name, value)


def chain(line: list[str], shown: io.StringIO) -> None:
    """Run a command, and what each stage says is ``next``, up to the report."""
    done: list[str] = []
    while line[1] != "report":
        done.append(line[1])
        line = _following(_ended(line, shown))
    _ended(line, shown)
    assert done == [*STAGES, "compress", "export"]


def _ended(line: list[str], shown: io.StringIO) -> dict[str, Any]:
    """The record of a command, once it went well."""
    for _ in range(MOST_TRIES):
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(shown):
            code = main(line[1:])
        shown.write(printed.getvalue())
        record = json.loads(printed.getvalue().splitlines()[-1])
        if code not in PASSING:
            break
        line = _following(record)
    assert code == 0, (line, record)
    return record


def _following(record: dict[str, Any]) -> list[str]:
    line = shlex.split(record["next"])
    return [*line, *OPTIONS.get(line[1], ())]


@pytest.mark.slow
def test_the_chain_runs_with_models_of_three_providers_whose_endpoints_fail_now_and_then(mixed: Mixed) -> None:
    assert mixed.failed > 2
    assert who_answered(mixed.run) == {("reasoner", "anthropic"), ("editor", "openrouter"), ("critic", "gemini")}
    verdicts = read_json(RunFolder(mixed.run).verdicts)
    assert verdicts["provenance"]["providers"]["critic"].startswith("gemini")
    assert (mixed.run / "report.html").is_file()


@pytest.mark.slow
def test_no_file_of_the_run_no_output_and_no_log_has_the_key(mixed: Mixed) -> None:
    files = [path for path in mixed.run.rglob("*") if path.is_file()]
    assert "POST" in mixed.shown and len(files) > 20
    assert not any(mixed.key.encode() in path.read_bytes() for path in files)
    assert mixed.key not in mixed.shown


@pytest.mark.slow
@pytest.mark.parametrize(
    ("reasoner", "editor"), [("gemini", "gemini"), ("openai", "openrouter")], ids=lambda provider: provider
)
def test_another_provider_answers_every_stage_that_asks(
    reasoner: str, editor: str, mixed: Mixed, tmp_path: Path, capsys, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The stages that ask nobody are copied from the mixed chain."""
    models = ("--models", reasoner, "--editor", editor)
    drawn = tmp_path / "drawn"
    judged = copied(RunFolder(mixed.run), tmp_path / "judged", before="compress").root
    with ModelServer() as server:
        use(server, monkeypatch)
        for line in (
            ("select-place", TASK, "--out", drawn, *models),
            ("inpaint-plan", "--run", drawn, *models),
            ("verify", "--run", judged, "--force", "--models", reasoner),
            ("search-subtasks", "--run", judged, "--force", "--models", reasoner),
        ):
            assert command(capsys, *line).code == 0
    assert server.failed == 0
    assert who_answered(drawn) == {("reasoner", reasoner), ("editor", editor)}
    assert who_answered(judged) == {("reasoner", reasoner), ("critic", reasoner)}


def who_answered(run: Path) -> set[tuple[str, str]]:
    """(role, provider) of every stored exchange."""
    exchanges = Exchanges(run / "exchanges").all()
    return {(exchange.role, exchange.provider.partition(":")[0]) for exchange in exchanges}


@pytest.mark.slow
def test_a_stage_script_with_a_fault_says_how_to_continue(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = str(tmp_path / "run")
    with ModelServer() as server:
        use(server, monkeypatch)
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
