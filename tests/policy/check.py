"""The real lerobot-eval and vla-eval act in the environments that ``vcage serve`` offers.

``make test-policy`` runs it with VCAGE_POLICY_PYTHON, the interpreter of an environment that has both.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.run_folders import Finished

PYTHON = Path(os.environ["VCAGE_POLICY_PYTHON"])
HERE = Path(__file__).parent


@pytest.fixture(scope="module")
def address(finished: Finished) -> Iterator[str]:
    command = [sys.executable, "-m", "vcage.cli.main", "serve", str(finished.run.root), "--port", "0"]
    with subprocess.Popen([*command, "--environment-state"], stderr=subprocess.PIPE, text=True) as server:
        assert server.stderr is not None
        line = next(line for line in server.stderr if line.startswith("listening at "))
        yield line.split()[-1]
        server.terminate()
        assert server.stderr.read().splitlines()[-1].startswith("served ")
        assert server.wait() == 0


def ran(*command: str) -> str:
    environment = {**os.environ, "PYTHONPATH": str(HERE), "HF_HUB_OFFLINE": "1"}
    done = subprocess.run([str(PYTHON), *command], capture_output=True, text=True, env=environment, timeout=900)
    assert done.returncode == 0, done.stderr[-3000:]
    return done.stdout


@pytest.mark.timeout(1800)
def test_lerobot_eval_acts_in_two_environments_at_once(address: str, tmp_path: Path) -> None:
    ran("-m", "untrained", address, str(tmp_path / "act"))
    options = {"policy.path": tmp_path / "act", "env.type": "vcage", "env.address": address, "policy.device": "cpu"}
    options |= {"eval.n_episodes": 2, "eval.batch_size": 2, "eval.use_async_envs": "true", "seed": 1000}
    given = [f"--{name}={value}" for name, value in options.items()]
    ran("-m", "lerobot.scripts.lerobot_eval", *given, f"--output_dir={tmp_path / 'found'}")
    found = json.loads((tmp_path / "found" / "eval_info.json").read_text())
    assert found["overall"]["n_episodes"] == 2
    assert [Path(path).stat().st_size > 1000 for path in found["overall"]["video_paths"]] == [True, True]


@pytest.mark.timeout(900)
def test_vla_eval_runs_the_task_as_a_benchmark(address: str, tmp_path: Path) -> None:
    found = json.loads(ran("-m", "vla_eval_still", address, str(tmp_path)).splitlines()[-1])
    assert found == [{"success": False}, {"success": False}]
