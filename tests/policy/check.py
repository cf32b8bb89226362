"""The real lerobot trains on our export, and it and vla-eval act in the environments that ``vcage serve`` offers.

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
from vcage.base.files import RunFolder

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


def options(**values: object) -> list[str]:
    """Options as lerobot's commands take them; ``__`` stands for a dot."""
    return [f"--{name.replace('__', '.')}={value}" for name, value in values.items()]


def trained(run: RunFolder, folder: Path) -> Path:
    """A small ACT policy that lerobot trains on a run's export for four steps, so it has learnt next to nothing."""
    size = {"dim_model": 64, "dim_feedforward": 64, "n_heads": 4, "n_encoder_layers": 1}
    of_policy = {"type": "act", "chunk_size": 8, "n_action_steps": 8, "pretrained_backbone_weights": "null", **size}
    of_policy |= {"device": "cpu", "push_to_hub": "false"}
    given = options(
        dataset__repo_id="local/blocks",
        dataset__root=run.root / "export" / "lerobot-v3.0",
        dataset__video_backend="pyav",
        **{f"policy__{name}": value for name, value in of_policy.items()},
        batch_size=4,
        steps=4,
        num_workers=0,
        wandb__enable="false",
        output_dir=folder,
    )
    ran("-m", "lerobot.scripts.lerobot_train", *given)
    return folder / "checkpoints" / "last" / "pretrained_model"


@pytest.mark.timeout(1800)
def test_a_policy_that_lerobot_trains_on_the_export_acts_in_two_environments_at_once(
    address: str, finished: Finished, tmp_path: Path
) -> None:
    policy = trained(finished.run, tmp_path / "act")
    of_env = {"env__type": "vcage", "env__address": address}
    of_eval = {"eval__n_episodes": 2, "eval__batch_size": 2, "eval__use_async_envs": "true", "seed": 1000}
    given = options(policy__path=policy, policy__device="cpu", **of_env, **of_eval, output_dir=tmp_path / "found")
    ran("-m", "lerobot.scripts.lerobot_eval", *given)
    found = json.loads((tmp_path / "found" / "eval_info.json").read_text())
    assert found["overall"]["n_episodes"] == 2
    assert [Path(path).stat().st_size > 1000 for path in found["overall"]["video_paths"]] == [True, True]


@pytest.mark.timeout(900)
def test_vla_eval_runs_the_task_as_a_benchmark(address: str, tmp_path: Path) -> None:
    found = json.loads(ran("-m", "vla_eval_still", address, str(tmp_path)).splitlines()[-1])
    assert found == [{"success": False}, {"success": False}]
