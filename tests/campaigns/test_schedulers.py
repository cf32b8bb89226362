"""Files for SLURM and Kubernetes: each task runs one shard."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from vcage.base.errors import UsageError
from vcage.campaigns.schedulers import ShardedCommand, kubernetes_job, require_path, slurm_script


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


ODD = "50% of “a” & 'b' #1 \"c\" $HOME $(id) 🧱"
"""A name of a folder that is hard on shells, on YAML and on ``sbatch``."""


def argument_of_sbatch(line: str) -> str:
    """The argument of a line ``#SBATCH``, as ``sbatch`` parses it: quotes, escapes, and comments behind #."""
    return shlex.split(line.removeprefix("#SBATCH"), comments=True)[0]


def test_the_log_of_slurm_lies_in_the_folder_of_the_campaign_whatever_its_name(tmp_path: Path):
    out = tmp_path / ODD
    (line,) = [line for line in slurm_script(job(out)).splitlines() if line.startswith("#SBATCH --output=")]
    pattern = argument_of_sbatch(line).removeprefix("--output=")
    expanded = re.sub("%(.)", lambda found: {"%": "%", "a": "5"}[found[1]], pattern)
    assert expanded == f"{out}/slurm-5.log"


def test_kubernetes_gets_the_same_folder_whatever_its_name(tmp_path: Path):
    out = tmp_path / ODD
    (container,) = yaml.safe_load(kubernetes_job(job(out)))["spec"]["template"]["spec"]["containers"]
    assert container["volumeMounts"][0]["mountPath"] == str(out)
    script = re.sub(r"\$\$|\$\((\w+)\)", lambda found: "expanded" if found[1] else "$", container["command"][2])
    assert shlex.split(script)[3:6] == [str(out / "plan.yml"), "--out", str(out)]
    assert "🧱" in kubernetes_job(job(out))  # half of an escaped pair is no character for other readers of YAML


@pytest.mark.parametrize("name", ["2026", "1e5", "null", "no", "0x1f"])
def test_a_name_that_looks_like_something_else_stays_text(tmp_path: Path, name: str):
    document = yaml.safe_load(kubernetes_job(replace(job(tmp_path), name=name)))
    (volume,) = document["spec"]["template"]["spec"]["volumes"]
    assert (document["metadata"]["name"], volume["persistentVolumeClaim"]["claimName"]) == (name, name)


@pytest.mark.parametrize(
    ("scheduler", "name"),
    [("SLURM", "a\\b"), ("SLURM", "a\nb"), ("Kubernetes", "a:b"), ("Kubernetes", "a\x7fb"), ("Kubernetes", "a\tb")],
)
def test_a_path_that_a_scheduler_does_not_take_is_refused_with_the_sign(tmp_path: Path, scheduler: str, name: str):
    with pytest.raises(UsageError, match=re.escape(f"{scheduler} takes no path with {name[1:-1]!r}")):
        require_path(tmp_path / name, scheduler)
    require_path(tmp_path / ODD, scheduler)
