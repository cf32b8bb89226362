"""Files for SLURM and Kubernetes: each task runs one shard."""

from __future__ import annotations

import os
import shlex
import subprocess
from dataclasses import replace
from pathlib import Path

import yaml

from vcage.campaigns.schedulers import ShardedCommand, kubernetes_job, slurm_script


def job(out: Path, program: str = "/opt/vcage") -> ShardedCommand:
    return ShardedCommand(
        "desk_1", (program, "campaign", str(out / "plan.yml"), "--out", str(out)), out, shards=8, workers=4
    )


def test_a_task_of_the_slurm_array_runs_its_shard(tmp_path: Path):
    out = tmp_path / "a campaign"
    out.mkdir()
    echo = tmp_path / "vcage"
    echo.write_text('#!/bin/sh\nfor word in "$@"; do echo "$word"; done\n')
    echo.chmod(0o755)
    script = out / "campaign.sbatch"
    script.write_text(slurm_script(job(out, str(echo))))
    environment = {**os.environ, "SLURM_ARRAY_TASK_ID": "5"}
    said = subprocess.run(["bash", script], env=environment, capture_output=True, text=True, check=True).stdout
    expected = ["campaign", str(out / "plan.yml"), "--out", str(out), "--workers", "4", "--shard", "5/8"]
    assert said.splitlines() == expected
    assert "#SBATCH --array=0-7\n#SBATCH --cpus-per-task=4\n#SBATCH --mem=8G\n" in script.read_text()


def test_a_name_that_kubernetes_would_refuse_is_mended(tmp_path: Path):
    document = yaml.safe_load(kubernetes_job(replace(job(tmp_path), name="a" * 51 + "_b")))
    assert document["metadata"]["name"] == "a" * 51


def test_an_index_of_the_kubernetes_job_runs_its_shard(tmp_path: Path):
    document = yaml.safe_load(kubernetes_job(job(tmp_path)))
    spec = document["spec"]
    assert (document["apiVersion"], document["kind"], document["metadata"]["name"]) == ("batch/v1", "Job", "desk-1")
    assert (spec["completionMode"], spec["completions"], spec["parallelism"]) == ("Indexed", 8, 8)
    (container,) = spec["template"]["spec"]["containers"]
    assert shlex.split(container["command"][2])[:3] == ["exec", "vcage", "campaign"]
    assert container["command"][2].endswith('--shard "$JOB_COMPLETION_INDEX/8"')
    assert container["volumeMounts"][0]["mountPath"] == str(tmp_path)
