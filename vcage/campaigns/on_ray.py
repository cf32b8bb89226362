"""The driver that runs jobs on a Ray cluster: one actor, with one renderer, for each job that runs at a time.

Actors get paths and return records; all else lies in the folder of the campaign, which every node must see.
"""

from __future__ import annotations

import logging
import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self

from vcage.base.commands import CALLED
from vcage.base.errors import ConfigurationError, DiskFull, OutputFolderError
from vcage.base.progress import Progress, silent
from vcage.base.version import __version__
from vcage.campaigns.driver import work_through, workers_here
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.hanging import HangWatch
from vcage.campaigns.job import Outcome, run_job
from vcage.campaigns.job_errors import LACKING
from vcage.campaigns.plan import Job
from vcage.campaigns.ray_actor import MARK, actor_class
from vcage.campaigns.ray_cluster import SETTINGS, RaySettings, connected, last_line, require_head
from vcage.campaigns.ray_nodes import Nodes
from vcage.campaigns.schedule import Schedule
from vcage.campaigns.stranded import Stranded

logger = logging.getLogger(__name__)


@dataclass(eq=False)
class _Worker:
    """An actor, its last unanswered call, its job since when (:func:`time.monotonic`), and its node's id and name."""

    actor: Any
    asked: Any
    job: Job | None = None
    since: float = field(default_factory=time.monotonic)
    ready: bool = False
    node: str = ""
    host: str = ""
    rest_s: float = 0.0
    rests_until: float = 0.0


class RayCrew:
    """Actors of a cluster, as many as it has processors, each on one job at a time.

    Each actor first reports its version of vcage and leaves a mark in the folder of the campaign. A node with another
    version or another folder, or without something that jobs need, is named, and gets no job.

    Args:
        ray: the module, connected.
        folder: of the campaign.
        workers: actors at most; None for as many as the cluster has processors.
        work: runs a job in an actor.
        settings: of the driver.
    """

    def __init__(
        self,
        ray: Any,
        folder: CampaignFolder,
        workers: int | None = None,
        work: Callable[[Path, Job], Outcome] = run_job,
        settings: RaySettings = SETTINGS,
    ):
        self._ray, self._folder, self._most, self._work, self._settings = ray, folder, workers, work, settings
        self._head = ray.get_runtime_context().gcs_address
        self._watch = HangWatch(folder.root)
        self._stranded = Stranded(folder, self._watch, settings.freed_within_s)
        self._waiting: deque[Job] = deque()
        self._workers: list[_Worker] = []
        self._nodes = Nodes(ray, folder.root, __version__, settings.seen_within_s)
        self._unborn = 0
        self._began, self._warned = time.monotonic(), False

    def __enter__(self) -> Self:
        self._employ()
        return self

    def __exit__(self, *_: object) -> None:
        for worker in self._workers:
            self._ray.kill(worker.actor)
        if busy := [worker.asked for worker in self._workers if worker.job is not None]:
            self._ray.wait(busy, num_returns=len(busy), timeout=5)

    def submit(self, job: Job, /) -> None:
        """Add a job; it begins as soon as an actor is free."""
        self._waiting.append(job)

    def results(self) -> Iterator[Outcome]:
        """Yield outcomes as they arrive, until none is awaited; more jobs may be submitted meanwhile.

        Raises:
            ClusterLost: the head of the cluster does not answer any more.
            ConfigurationError: no node can run jobs of this campaign; says why.
        """
        looked = -self._settings.look_every_s
        while self._waiting or self._stranded or any(worker.job for worker in self._workers):
            if time.monotonic() - looked >= self._settings.look_every_s:
                require_head(self._head)
                self._employ()
                self._warn_of_waiting()
                looked = time.monotonic()
            self._begin()
            yield from self._stranded.outcomes()
            for worker in self._answered():
                yield from self._answer_of(worker)
            for worker in [worker for worker in self._workers if self._seconds_left(worker) <= 0]:
                self._ray.kill(worker.actor, no_restart=False)
                seconds = time.monotonic() - worker.since
                self._lost(worker, f"gave no sign of life and was ended after {seconds:.0f} s")

    def room(self) -> int:
        """Number of jobs to submit at a time; it changes as nodes come and go."""
        return len(self._workers)

    def _employ(self) -> None:
        """Add actors up to the number of processors, or of workers; those without a place wait for one."""
        wanted = self._most or max(self._nodes.processors, 1)
        while len(self._workers) < wanted:
            kind = self._ray.remote(actor_class()).options(
                num_cpus=1, max_restarts=self._settings.restarts, label_selector=self._nodes.selector
            )
            actor = kind.remote(str(self._folder.root), CALLED.get() or "a campaign on Ray", __version__)
            self._workers.append(_Worker(actor, self._look_around(actor)))

    def _warn_of_waiting(self) -> None:
        """Warn once if no actor finds a place."""
        if any(worker.ready for worker in self._workers):
            self._warned = True
        elif not self._warned and time.monotonic() - self._began > self._settings.warn_after_s:
            free = self._ray.available_resources().get("CPU", 0)
            logger.warning(
                "no worker has begun yet: of %d processors of the cluster %d are free", self._nodes.processors, free
            )
            self._warned = True

    @staticmethod
    def _look_around(actor: Any) -> Any:
        """Let an actor examine its node, as soon as it has a place."""
        return actor.look_around.options(max_task_retries=-1).remote()

    def _begin(self) -> None:
        """Give jobs to actors that are free."""
        now = time.monotonic()
        for worker in self._workers:
            if self._waiting and worker.ready and worker.job is None and worker.rests_until <= now:
                worker.job, worker.since = self._waiting.popleft(), now
                worker.asked = worker.actor.run.remote(self._work, worker.job)

    def _answered(self) -> list[_Worker]:
        asked = {worker.asked: worker for worker in self._workers if worker.asked is not None}
        left = [self._seconds_left(worker) for worker in self._workers]
        longest = self._settings.look_for_freed_s if self._stranded else self._settings.look_every_s
        patience = max(0.0, min([longest, *left]))
        if not asked:
            time.sleep(patience)
            return []
        found, _ = self._ray.wait(list(asked), num_returns=len(asked), timeout=0)
        if not found:
            found, _ = self._ray.wait(list(asked), num_returns=1, timeout=patience)
        return [asked[one] for one in found]

    def _answer_of(self, worker: _Worker) -> Iterator[Outcome]:
        """Take the answer of an actor: its view of the node, or the outcome of its job."""
        try:
            answer = self._ray.get(worker.asked)
        except self._ray.exceptions.RayTaskError as error:  # it cannot even load its arguments
            self._cannot_begin(worker, error)
            return
        except self._ray.exceptions.RayError as error:
            self._lost(worker, f"was lost: {last_line(error)}", error)
            return
        worker.asked = None
        if isinstance(answer, Outcome):
            yield from self._outcome_of(worker, answer)
        elif answer is None:  # it was restarted meanwhile, perhaps on another node
            self._give_back(worker)
            worker.ready, worker.asked = False, self._look_around(worker.actor)
        else:
            self._place(worker, **answer)

    def _outcome_of(self, worker: _Worker, outcome: Outcome) -> Iterator[Outcome]:
        """Pass an outcome on, unless another node may have what this one lacks: the job goes there."""
        if isinstance(outcome.error, LACKING) and not self._nodes.is_the_only_one(worker.node):
            self._give_back(worker)
            self._leave_out(worker, outcome.error.as_line())
            return
        worker.job = None
        self._rest(worker, outcome)
        yield outcome

    def _give_back(self, worker: _Worker) -> None:
        """Let another actor begin the job of one that could not."""
        if worker.job is not None:
            self._waiting.appendleft(worker.job)
            worker.job = None

    def _place(self, worker: _Worker, node: str, host: str, **seen: str) -> None:
        """Take an actor's view of its node."""
        worker.node, worker.host = node, host
        if self._nodes.is_left_out(node):
            self._leave_out(worker, "")
        elif reason := self._nodes.reason_against(**seen):
            self._leave_out(worker, reason)
        else:
            worker.ready, self._unborn = True, 0

    def _cannot_begin(self, worker: _Worker, error: Exception) -> None:
        """Leave out the node of an actor that cannot load what it is given; end where even that is unknown."""
        if not worker.ready:
            self._dismiss(worker)
            hint = f"install vcage {__version__}, and what it needs, on every node"
            raise ConfigurationError(f"a Ray worker cannot run jobs: {last_line(error)}", hint=hint) from error
        self._give_back(worker)
        self._leave_out(worker, f"jobs cannot begin there: {last_line(error)}")

    def _lost(self, worker: _Worker, how: str, error: Exception | None = None) -> None:
        """Go on after an actor was lost: Ray restarts it, or another takes its place."""
        if worker.job is not None:
            self._stranded.add(worker.job, worker.since, how)
            worker.job = None
        if isinstance(error, self._ray.exceptions.ActorDiedError):
            self._workers.remove(worker)
            self._unborn += not worker.ready
            if self._unborn >= self._settings.unborn:
                raise ConfigurationError(
                    f"no worker of the Ray cluster can begin: {last_line(error)}",
                    hint="look into Ray's logs on the nodes",
                )
            self._employ()
        else:
            worker.asked, worker.ready = self._look_around(worker.actor), False

    def _rest(self, worker: _Worker, outcome: Outcome) -> None:
        """Pause an actor whose disk is full or cannot be written, lest it takes one job after the other."""
        if not isinstance(outcome.error, DiskFull | OutputFolderError):
            worker.rest_s = 0.0
            return
        worker.rest_s = min(max(2 * worker.rest_s, self._settings.rest_s), self._settings.longest_rest_s)
        worker.rests_until = time.monotonic() + worker.rest_s

    def _leave_out(self, worker: _Worker, reason: str) -> None:
        """Name the node of an actor, which can run no jobs, and use the others."""
        self._ray.wait([worker.actor.leave.remote()], timeout=5)
        self._dismiss(worker)
        self._nodes.leave_out(worker.node, worker.host, reason)
        self._employ()

    def _dismiss(self, worker: _Worker) -> None:
        self._workers.remove(worker)
        self._ray.kill(worker.actor)

    def _seconds_left(self, worker: _Worker) -> float:
        if worker.job is None:
            return self._settings.look_every_s
        return self._watch.seconds_left(worker.job, time.monotonic() - worker.since)


def run_on_ray(
    folder: CampaignFolder,
    address: str,
    workers: int | None = None,
    progress: Progress = silent,
    work: Callable[[Path, Job], Outcome] = run_job,
    settings: RaySettings = SETTINGS,
) -> Schedule:
    """Run the jobs of a campaign on a Ray cluster.

    Args:
        folder: of the campaign, with its plan.
        address: ``HOST:PORT`` of the head; ``auto`` for the cluster that this machine belongs to, or else one of its
            own, for as long as the campaign runs.
        workers: actors at most; by default as many as the cluster has processors.
        progress: called before each job.
        work: runs a job in an actor.
        settings: of the driver.

    Returns:
        The schedule, with the jobs that are left.

    Raises:
        InputFileError: the plan, or a record, cannot be read.
        MissingDependency: Ray is not installed.
        ClusterLost: no cluster answers, or its head is lost.
        ConfigurationError: no node of it can run jobs of this campaign.
    """
    schedule = Schedule(folder)
    with connected(address, workers or workers_here(settings.actor_bytes)) as ray:
        crew = RayCrew(ray, folder, workers, work, settings)
        work_through(schedule, crew, crew.room, progress)
    for mark in folder.root.glob(f"{MARK}*"):  # of actors that were lost before the driver saw it
        mark.unlink(missing_ok=True)
    return schedule
