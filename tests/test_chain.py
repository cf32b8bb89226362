"""``vcage run`` as a process that is killed at bad moments: the same command again finishes the same job."""

from __future__ import annotations

import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.run_folders import FPS, INSTRUCTION, QUICK_VIDEOS, Finished, clean_environment, copied, digests, process

VCAGE = [sys.executable, "-m", "vcage.cli.main"]
COLLECT = ["--models", "offline", "--episodes", "1", "--fps", str(FPS)]
RUN = [*VCAGE, "run", INSTRUCTION, *COLLECT, *QUICK_VIDEOS, "--out", "run"]


def killed(program: list[str], cwd: Path, when: Callable[[], bool]) -> None:
    """Start a program and kill it without warning as soon as ``when`` is true."""
    with open(cwd / "killed.log", "ab") as log:
        child = subprocess.Popen(program, cwd=cwd, env=clean_environment(), stdout=log, stderr=log)
        try:
            deadline = time.monotonic() + 300
            while not when():
                assert child.poll() is None, (cwd / "killed.log").read_text()
                assert time.monotonic() < deadline
                time.sleep(0.01)
        finally:
            child.send_signal(signal.SIGKILL)
            child.wait()


@pytest.mark.slow
def test_a_run_killed_repeatedly_ends_with_the_same_files(finished: Finished, tmp_path):
    run = copied(finished.run, tmp_path / "run", before="collect").root
    killed(RUN, tmp_path, lambda: any(run.glob("episodes.collecting/critic/*")))
    assert process([*VCAGE, "collect", "--run", "run", *COLLECT], tmp_path).code == 0
    for folder in ("verify", "compress"):  # they take longest; tests/cli/test_compress.py kills a compression
        shutil.copytree(finished.run.root / folder, run / folder)
    killed(RUN, tmp_path, lambda: any(run.glob("export.partial-*/*")))
    answer = process(RUN, tmp_path)
    assert answer.code == 0, answer.stderr
    assert not answer.record["summary"]["fresh"], "made from other episodes"
    assert digests(run) == digests(finished.run.root)
    left = {p.name for p in run.iterdir()} ^ {p.name for p in finished.run.root.iterdir()}
    assert left == {"options.json"}, "which commands keep, and a program does not"


@pytest.mark.slow
def test_a_killed_replacement_leaves_the_old_stage(finished: Finished, tmp_path):
    run = copied(finished.run, tmp_path / "run", before="inpaint_plan")
    before = digests(run.root / "place")
    line = [*VCAGE, "select-place", INSTRUCTION, "--out", "run", "--seed", "1", "--force"]
    killed(line, tmp_path, lambda: any(run.root.glob("place.partial-*/*.png")))
    assert digests(run.root / "place") == before
