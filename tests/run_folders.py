"""Small finished runs: how the tests make one, copy it, look at its files, and call commands on it."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from vcage.apps.report.page import write_report
from vcage.base.files import PRODUCERS, RunFolder, sha256_file
from vcage.cli.main import main
from vcage.datasets.packing.settings import CompressionSettings
from vcage.runs.context import StageContext
from vcage.stages import chain

REPOSITORY = Path(__file__).resolve().parents[1]
INSTRUCTION = "Put two blocks on the plate"
FPS = 5
VIDEOS = CompressionSettings(crf=20, effort="fast", keyframes=2)
"""Nothing is searched: that is for tests/video, tests/datasets and tests/stages/test_compress_export.py."""

QUICK_VIDEOS = ["--crf", "20", "--effort", "fast", "--keyframes", "2"]
"""The same as options."""

OPTIONS = chain.ChainOptions(
    instruction=INSTRUCTION,
    models="offline",
    episodes=1,
    fps=FPS,
    compression=VIDEOS,
    workers=1,
)
"""A chain as quick as it gets with every stage at work."""

STAGES = list(chain.STAGES)
FOLDERS = {stage: folder for folder, stage in PRODUCERS.items()}
BY_PRODUCTS = {"timings.json", "options.json", "unfinished.json", "report.html"}
"""Files of a run that hold wall times, or what else does not change what is made."""


@dataclass(frozen=True)
class Finished:
    """A run and what made it; its folder is shared, so copy before changing anything."""

    run: RunFolder
    context: StageContext


def finished_run(folder: Path) -> Finished:
    """One episode through the whole chain, in this process."""
    run, context = RunFolder(folder), StageContext("offline")
    chain.run_chain(run, OPTIONS, context)
    write_report(run)
    return Finished(run, context)


def copied(run: RunFolder, folder: Path, *, before: str | None = None) -> RunFolder:
    """A copy of a run with the stages that come before ``before``, or with all."""
    count = len(STAGES) if before is None else STAGES.index(before)
    for stage in STAGES[:count]:
        shutil.copytree(run.root / FOLDERS[stage], folder / FOLDERS[stage])
    return RunFolder(folder)


def digests(root: Path) -> dict[str, str]:
    """Path → SHA-256 of every file but the by-products."""
    paths = sorted(path for path in root.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    names = {path.relative_to(root).as_posix(): path for path in paths}
    return {name: sha256_file(path) for name, path in names.items() if path.name not in BY_PRODUCTS}


@dataclass(frozen=True)
class Answer:
    """How a command ended."""

    code: int
    record: dict[str, Any]
    stderr: str

    @property
    def error(self) -> dict[str, Any]:
        return self.record["error"]

    @property
    def complaints(self) -> list[str]:
        """The lines of stderr that say what went wrong."""
        return [line for line in self.stderr.splitlines() if line.startswith("vcage: error: ")]


def command(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> Answer:
    """Run ``vcage …`` in this process."""
    capsys.readouterr()
    code = main([str(argument) for argument in arguments])
    out, err = capsys.readouterr()
    return Answer(code, json.loads(out.splitlines()[-1]), err)


def clean_environment() -> dict[str, str]:
    """The environment of a shell in which ours is not activated: no search paths, and the system's PATH."""
    kept = {
        name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV")
    }
    own = str(Path(sys.executable).parent)
    return kept | {"PATH": os.pathsep.join(part for part in kept["PATH"].split(os.pathsep) if part != own)}


def process(program: list[str | Path], cwd: Path) -> Answer:
    """Run a program that is one of our commands to its end."""
    done = subprocess.run(list(map(str, program)), cwd=cwd, env=clean_environment(), capture_output=True, text=True)
    lines = done.stdout.splitlines()
    assert lines, done.stderr
    return Answer(done.returncode, json.loads(lines[-1]), done.stderr)
