"""The folder of a campaign: its plan, the run folders and records of its jobs, and the exchanges that they share."""

from __future__ import annotations

import contextlib
import logging
import os
from collections.abc import Callable, Iterator
from functools import lru_cache
from pathlib import Path

import yaml

from vcage.base.errors import DamagedFile, DiskFull, FolderInUse, InputFileError, MissingStage, OutputFolderError
from vcage.base.files import RunFolder, write_json, write_text
from vcage.base.folders import entries, is_hidden, listing, real_path
from vcage.base.hold import IN_USE, alone, holder_of, one_at_a_time
from vcage.base.leftovers import PARTIAL, recover, sweep_folder
from vcage.campaigns.looks import FOLDER as LOOKS
from vcage.campaigns.looks import keep_looks, keys_of, with_own_looks
from vcage.campaigns.plan import Job, Plan
from vcage.campaigns.record import JobError, JobRecord, Tries, read_record, read_tries, warn_if_damaged
from vcage.campaigns.shard import EVERY_JOB, Shard

logger = logging.getLogger(__name__)

PLAN = "plan.yml"


class CampaignFolder:
    """The folder given as ``--out``. Every process that works on the campaign may hold one.

    Args:
        root: its path; it need not exist yet.
    """

    def __init__(self, root: str | Path):
        self.root = real_path(root)
        self._records: dict[str, tuple[tuple[int, int], JobRecord]] = {}
        self._locks: dict[str, int] = {}  # jobs held here → the inode of their lock

    def __str__(self) -> str:
        return str(self.root)

    plan_file = property(lambda self: self.root / PLAN)
    exchanges = property(lambda self: self.root / "exchanges", doc="The folder of all jobs' exchanges with models.")
    bill = property(lambda self: self.exchanges / "bill.jsonl", doc="The file with their costs.")
    page = property(lambda self: self.root / "status.html")

    @property
    def plan(self) -> Plan:
        """The plan of the campaign.

        Raises:
            MissingStage: the folder holds none.
            InputFileError: it cannot be read.
        """
        if not self.plan_file.exists():
            raise MissingStage(f"{self.root} holds no campaign: {self.plan_file} does not exist", hint="check the path")
        return _loaded(self.plan_file, self.plan_file.stat().st_mtime_ns)

    def begin(self, plan: Plan) -> Plan:
        """Write a plan into the folder, new or in place of an earlier one that it continues.

        Returns:
            The plan as it was read back, which every later process reads too.

        Raises:
            OutputFolderError: the folder cannot be written, or holds something else.
            InputFileError: another campaign lies here.
        """
        self.require_fit(plan)
        RunFolder(self.root).make()
        with one_at_a_time(self.plan_file):
            self.require_fit(plan)
            sweep_folder(self.root, (self.plan_file.stem, LOOKS))  # of a process that was killed here
            named = with_own_looks(plan.with_robots(self.earlier), self.root)
            keys = {"schema": Plan.SCHEMA} | keys_of(named, self.root)
            text = yaml.safe_dump(keys, sort_keys=False, allow_unicode=True, width=120)
            if not self.plan_file.exists() or self.plan_file.read_text(encoding="utf-8") != text:
                write_text(self.plan_file, text)
            keep_looks(plan, self.root)
        return self.plan

    @property
    def earlier(self) -> Plan | None:
        """The plan of the campaign; None where there is none yet."""
        return self.plan if self.plan_file.exists() else None

    def require_fit(self, plan: Plan) -> None:
        """Check that a plan can begin here, or continue the one that is here; nothing is written.

        Raises:
            OutputFolderError: this is a file, or a folder of something else.
            InputFileError: another campaign lies here.
        """
        if (earlier := self.earlier) is None:
            self._require_empty()
        elif reason := with_own_looks(plan.with_robots(earlier), self.root).difference_to(earlier):
            raise InputFileError(
                f"{self.root} holds a campaign of another plan: the new one has {reason}",
                hint="give another --out; tasks, values of axes, seeds and episodes may be added to a plan, "
                "and limits, gates and the name may change, all else must stay",
            )

    def _require_empty(self) -> None:
        if not self.root.exists():
            return
        if not self.root.is_dir():
            raise OutputFolderError(f"{self.root} is no folder", hint="give a new or an empty folder as --out")
        names = sorted(path.name for path in self.root.iterdir())
        if others := [name for name in names if PARTIAL not in name and name != f"{PLAN}.lock"]:
            hint = "give a new or an empty folder as --out"
            raise OutputFolderError(f"{self.root} holds {others[0]}, and no campaign", hint=hint)

    def failed(self, plan: Plan, shard: Shard = EVERY_JOB) -> list[Job]:
        """The jobs of a share that failed or were given up.

        Args:
            plan: to go on with.
            shard: the share.

        Raises:
            InputFileError: a record is of another version, or may not be read.
        """
        cells = {cell.id: cell for cell in plan.cells}
        found = [one for one in self.records() if one.state != "done" and one.cell in cells]
        jobs = (plan.job(cells[one.cell], one.number, one.episodes) for one in found)
        return [job for job in jobs if shard.has(plan.index_of(job))]

    def forget_failed(self, shard: Shard = EVERY_JOB) -> int:
        """Remove the records of these jobs, so that they are tried again; return their number.

        Nothing is taken from another process that has begun or settled such a job meanwhile.

        Raises:
            InputFileError: a record is of another version, or may not be read.
        """
        count = 0
        for job in self.failed(self.plan, shard):
            with contextlib.suppress(FolderInUse), self.held(job):
                if (now := self.record(job)) is not None and now.state != "done":
                    self.tries_file(job).unlink(missing_ok=True)  # of a process that was killed before it could
                    self.record_file(job).unlink(missing_ok=True)
                    count += 1
        return count

    # --- jobs ---------------------------------------------------------------------------------------------

    def run(self, job: Job) -> RunFolder:
        """The run folder of a job."""
        return RunFolder(self.root / "jobs" / job.id)

    def record_file(self, job: Job) -> Path:
        """The file of a job's record, beside its run folder."""
        return self._beside(job.id, "job.json")

    def tries_file(self, job: Job) -> Path:
        """The file that counts its tries."""
        return self._beside(job.id, "tries.json")

    def beat_file(self, job: Job) -> Path:
        """The file that is touched at every step, and locked by the process that runs the job."""
        return self._beside(job.id, "beat")

    def _beside(self, job: str, ending: str) -> Path:
        return self.root / "jobs" / f"{job}.{ending}"

    def record(self, job: Job) -> JobRecord | None:
        """The record of a job; None while it is not settled, or asked for fewer episodes than there should be now.

        A damaged record, which :meth:`records` names, counts as none: the job is settled again.

        Raises:
            InputFileError: the file is of another version, or may not be read.
        """
        try:
            found = read_record(self.record_file(job))
        except (MissingStage, DamagedFile):
            return None
        return found if found.state != "done" or found.episodes >= job.episodes else None

    def records(self, unread: Callable[[InputFileError], None] = warn_if_damaged) -> Iterator[JobRecord]:
        """All records, by cell and number. Others may write meanwhile: a file is seen whole or not at all.

        Args:
            unread: called with the error of each that cannot be read; by default it ends
                the reading, except that of a damaged one.

        Raises:
            InputFileError: a folder cannot be listed.
        """
        for entry in self._entries(".job.json"):
            try:
                yield self._read(entry)
            except (MissingStage, FileNotFoundError):
                continue  # removed by --retry
            except InputFileError as error:
                unread(error)

    def _read(self, entry: os.DirEntry[str]) -> JobRecord:
        """Read a record, unless it is the one that was read before."""
        mark = -1, -1
        with contextlib.suppress(OSError):  # whoever reads it says why
            found = entry.stat()
            mark = found.st_mtime_ns, found.st_ino
        known = self._records.get(entry.path)
        if known is None or known[0] != mark:
            known = self._records[entry.path] = mark, read_record(Path(entry.path))
        return known[1]

    def begun(self) -> Iterator[Path]:
        """The lock files of jobs that were begun and are not settled."""
        for entry in self._entries(".tries.json"):
            yield Path(entry.path.removesuffix(".tries.json") + ".beat")

    def _entries(self, suffix: str) -> Iterator[os.DirEntry[str]]:
        """Files beside the run folders, by cell and number."""
        jobs = self.root / "jobs"
        for cell in filter(Path.is_dir, entries(jobs) if jobs.exists() else ()):
            with listing(cell), os.scandir(cell) as files:
                ours = (file for file in files if file.name.endswith(suffix) and not is_hidden(file.name))
                yield from sorted(ours, key=lambda entry: entry.name)

    def tries(self, job: Job) -> Tries:
        """The tries of a job so far; none where they cannot be read."""
        return read_tries(self.tries_file(job))

    def note_tries(self, job: Job, tries: Tries) -> None:
        """Write down the tries of a job."""
        write_json(self.tries_file(job), tries.model_dump(mode="json"))

    def note_fault(self, job: Job, before: Tries, error: JobError) -> None:
        """Take back a try that ended by a fault of the machine; all tries, where a full disk takes nothing else.

        Args:
            job: which.
            before: its tries before that one.
            error: that ended it.
        """
        tries = before.model_copy(update={"error": error})
        try:
            self.note_tries(job, tries)
        except DiskFull:
            self.tries_file(job).unlink(missing_ok=True)
            with contextlib.suppress(DiskFull):
                self.note_tries(job, tries)  # in the room of the file that was removed

    @contextlib.contextmanager
    def held(self, job: Job) -> Iterator[None]:
        """Hold a job for this process, and remove what one that was killed left of its record and its tries.

        Raises:
            FolderInUse: another process works on it.
        """
        path = self.beat_file(job)
        RunFolder(path.parent).make()
        try:
            with alone(path):
                self._locks[job.id] = path.stat().st_ino
                recover(self.record_file(job))
                recover(self.tries_file(job))
                yield
        except FolderInUse as error:
            error.details["job"] = job.id
            raise
        finally:
            self._locks.pop(job.id, None)

    def is_held(self, job: Job) -> bool:
        """True while a process works on a job."""
        return holder_of(self.beat_file(job)) is not None

    def beat(self, job: Job) -> None:
        """Show that a job got on. A process from which it was taken back ends here, at once: another one runs it."""
        with contextlib.suppress(OSError):  # what it works on will say what is wrong with the disk
            lock = self._locks.get(job.id)
            if lock is not None and self.beat_file(job).stat().st_ino != lock:
                logger.error("%s was taken back, as this process hung; it ends", job.id)
                os._exit(1)  # it must change nothing more, nor release locks by their names
            os.utime(self.beat_file(job))

    def take_back(self, job: Job) -> None:
        """Take a job from a process that hangs where nobody can end it. Should it wake, it ends at its next step."""
        for lock in (self.beat_file(job), self.run(job).root / IN_USE):
            lock.unlink(missing_ok=True)

    def last_beat(self, job: Job) -> int:
        """The time of its last step, ns, by the clock that the file system goes by; 0 if there was none."""
        try:
            return self.beat_file(job).stat().st_mtime_ns
        except OSError:
            return 0


@lru_cache(maxsize=4)
def _loaded(path: Path, _changed_ns: int) -> Plan:
    return Plan.load(path, check=False)  # it was checked before it was written
