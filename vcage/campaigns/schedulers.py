"""Files for schedulers of clusters: a SLURM array script, and an indexed Job of Kubernetes, each task one shard."""

from __future__ import annotations

import json
import shlex
from dataclasses import dataclass
from pathlib import Path

from vcage.base.errors import UsageError
from vcage.base.version import __version__


@dataclass(frozen=True)
class ShardedCommand:
    """A campaign that a scheduler runs.

    Args:
        name: of the campaign.
        command: the words that run it here, with its plan and folder.
        out: its folder, which all tasks must see under this path.
        shards: tasks.
        workers: processes, and cores, of each task.
    """

    name: str
    command: tuple[str, ...]
    out: Path
    shards: int
    workers: int


GIGABYTES_PER_WORKER = 2
"""Memory to ask for; measured, a process takes one at most."""


SIGNS_REFUSED = {"SLURM": "\\", "Kubernetes": ":"}
"""Signs that a scheduler takes in no path: SLURM numbers no file below one with a backslash."""


def require_path(out: Path, scheduler: str) -> None:
    """Refuse a folder whose path a scheduler does not take.

    Args:
        out: the folder of the campaign.
        scheduler: one of :data:`SIGNS_REFUSED`.

    Raises:
        UsageError: it does not; names the sign.
    """
    for sign in str(out):
        if sign in SIGNS_REFUSED[scheduler] or not sign.isprintable():
            raise UsageError(
                f"{scheduler} takes no path with {sign!r}, as in {str(out)!r}", hint="give another folder as --out"
            )


def slurm_script(job: ShardedCommand) -> str:
    """The text of an array script for ``sbatch``."""
    command = shlex.join([*job.command, "--workers", str(job.workers)])
    return f"""\
#!/bin/bash
#SBATCH --job-name={job.name}
#SBATCH --array=0-{job.shards - 1}
#SBATCH --cpus-per-task={job.workers}
#SBATCH --mem={GIGABYTES_PER_WORKER * job.workers}G
#SBATCH --time=24:00:00
#SBATCH --requeue
#SBATCH --output="{_in_slurm(job.out)}/slurm-%a.log"
#SBATCH --open-mode=append
#
# Each task runs every {job.shards}th job. Add --partition and --account as your cluster wants them.
# A task that ends early goes on when the script is submitted again. It ends with code 7 where jobs of other tasks must
# be settled first, as those that verify too few episodes. To submit a second round right away:
#   sbatch --dependency=afterany:FIRST_JOB_ID {shlex.quote(str(job.out / "campaign.sbatch"))}
export OMP_NUM_THREADS=1
exec {command} --shard "$SLURM_ARRAY_TASK_ID/{job.shards}"
"""


def kubernetes_job(job: ShardedCommand) -> str:
    """The text of an indexed Job for ``kubectl apply``.

    An index that ends with code 7, as jobs of others are not settled yet, is tried again later, up to the limit.
    """
    name = _in_yaml(job.name.replace("_", "-")[:52].rstrip("-"))  # a label ends with a letter or digit
    words = ["vcage", *job.command[job.command.index("campaign") :], "--workers", str(job.workers)]
    script = f'exec {shlex.join(words).replace("$", "$$")} --shard "$JOB_COMPLETION_INDEX/{job.shards}"'
    return f"""\
apiVersion: batch/v1
kind: Job
metadata:
  name: {name}
spec:
  completionMode: Indexed
  completions: {job.shards}
  parallelism: {job.shards}
  backoffLimitPerIndex: 10
  template:
    spec:
      restartPolicy: Never
      containers:
        - name: vcage
          image: vcage:{__version__}  # yours; the Dockerfile is in the repository
          command: ["/bin/bash", "-c", {_in_yaml(script)}]
          env:
            - {{name: OMP_NUM_THREADS, value: "1"}}
          resources:
            requests: {{cpu: "{job.workers}", memory: {GIGABYTES_PER_WORKER * job.workers}Gi}}
            limits: {{memory: {2 * GIGABYTES_PER_WORKER * job.workers}Gi}}
          volumeMounts:
            - {{name: campaign, mountPath: {_in_yaml(str(job.out))}}}
      volumes:
        - name: campaign
          persistentVolumeClaim: {{claimName: {name}}}  # yours: ReadWriteMany, on a file system that locks files
"""


def _in_slurm(out: Path) -> str:
    """A path between quotes in a line ``#SBATCH``, where % begins the number of a task."""
    return str(out).replace('"', r"\"").replace("%", "%%")


def _in_yaml(text: str) -> str:
    """Text in quotes: a name may look like a number, and a path may hold what YAML reads otherwise."""
    return json.dumps(text, ensure_ascii=False)
