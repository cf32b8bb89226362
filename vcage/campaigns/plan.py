"""The plan of a campaign (``PLAN.yml``): tasks, axes, counts, limits and gates; the cells and jobs that follow from it.

A cell is one task with one robot, layout, look and seed. A job is one run folder of a few episodes of a cell, with a
seed of its own. What a job makes depends on its cell, its number and its seed alone.
"""

from __future__ import annotations

import hashlib
import re
from dataclasses import replace
from functools import cached_property
from itertools import product
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, ValidationError, field_validator

from vcage.base.errors import SchemaMismatch, mismatch
from vcage.base.problems import require_none
from vcage.base.reading import read_yaml
from vcage.campaigns.wrong_fields import problems_of_fields
from vcage.models.providers import PROVIDERS
from vcage.schema.base import Document, Finite, Identifier, Record
from vcage.sim.robots import load_template

if TYPE_CHECKING:
    from vcage.stages.chain import ChainOptions

MOST_SEED = 2**62
"""Seeds of jobs lie below; two of 10^6 jobs draw the same with a chance of 10^-7."""

Seed = Annotated[int, Field(ge=0, lt=2**63, strict=True)]
Count = Annotated[int, Field(gt=0, le=10**9, strict=True)]

EXPLAINED = "see docs/campaigns.md for the keys of a plan"


class Task(Record):
    """A task of the robot: an instruction, goals, or every sub-task of a scene."""

    id: Identifier | None = Field(default=None, description="name in folders and tables; made of the task by default")
    instruction: str | None = Field(default=None, min_length=1)
    goals: tuple[str, ...] = Field(default=(), description="as `vcage run --goal`")
    starts: tuple[str, ...] = Field(default=(), description="as `vcage run --start`")
    objects: str | None = Field(default=None, description="as `vcage run --objects`")
    scene: Identifier = Field(default="table", description="scene template")
    all_subtasks: bool = Field(default=False, description="run every sub-task of the scene, each by itself")

    @property
    def name(self) -> str:
        """The id, or one made of the task."""
        goals = " ".join(self.goals)
        return self.id or slug(self.instruction or goals or f"{self.scene} subtasks")

    @property
    def options(self) -> dict[str, Any]:
        """The options of `vcage run` that ask for it, by their names in :class:`vcage.stages.chain.ChainOptions`."""
        return {
            "instruction": self.instruction,
            "goals": self.goals,
            "starts": self.starts,
            "objects": self.objects,
            "template": self.scene,
            "all_subtasks": self.all_subtasks,
        }


class Limits(Record):
    """Bounds on a campaign."""

    attempts: Count | None = Field(default=None, description="episodes run per cell; three for each asked one")
    seconds: float | None = Field(default=None, gt=0, allow_inf_nan=False, description="of one try of a job")
    usd: float | None = Field(default=None, ge=0, allow_inf_nan=False, description="for models online, of all jobs")
    calls: int | None = Field(default=None, ge=0, strict=True, description="answers of models online, of all jobs")
    tries: Count = Field(default=3, description="tries of a job that get no further, before it is given up")
    per_minute: dict[str, Annotated[float, Field(gt=0, allow_inf_nan=False)]] = Field(
        default={}, description="provider → questions a minute, of all jobs"
    )

    @field_validator("per_minute")
    @classmethod
    def _known_providers(cls, given: dict[str, float]) -> dict[str, float]:
        if given.keys() - PROVIDERS.keys():
            raise ValueError(f"expected some of {', '.join(PROVIDERS)}, each with a number")
        return given


class Gates(Record):
    """The acceptance below which a cell is stopped."""

    acceptance: Finite = Field(gt=0, le=1, description="smallest share of accepted episodes")
    after: Count = Field(description="episodes of a cell after which its share is checked, once")


class Cell(Record):
    """One task with one robot, layout, look and seed."""

    id: str
    task: Task
    robot: str
    layout: Literal["varied", "fixed"]
    look: str
    seed: Seed


class Job(Record):
    """One run folder.

    Example:
        >>> Plan.load(Path("PLAN.yml")).jobs()[0].id
        'put-two-blocks-on-the-plate_aloha-agilex_varied_light_0/0000'
    """

    cell: Cell
    number: int = Field(ge=0, description="in its cell")
    episodes: int = Field(gt=0, description="verified episodes to collect; of each sub-task where all are run")
    seed: Seed

    @property
    def id(self) -> str:
        """Its folder below ``jobs/``."""
        return job_id(self.cell.id, self.number)


def job_id(cell: str, number: int) -> str:
    """The id of a job by the id of its cell and its number."""
    return f"{cell}/{number:04d}"


class Plan(Document):
    """``PLAN.yml``."""

    SCHEMA: ClassVar[str] = "vcage.campaign/1"

    name: Identifier
    seed: Seed = Field(default=0, description="of the whole campaign")
    tasks: tuple[Task, ...] = Field(min_length=1)
    robots: tuple[str, ...] = Field(default=(), description="none for that of each task's scene")
    layouts: tuple[Literal["varied", "fixed"], ...] = Field(default=("varied",), min_length=1)
    looks: tuple[str, ...] = Field(default=("light",), min_length=1, description="as `vcage run --randomise`")
    seeds: Count | Annotated[tuple[Seed, ...], Field(min_length=1)] = Field(
        default=1, description="independent repetitions of each combination: their number, or the list"
    )
    episodes: Count = Field(description="verified episodes per cell; per sub-task where all are run")
    episodes_per_job: Count = 5
    limits: Limits = Limits()
    gates: Gates | None = None
    options: dict[str, Any] = Field(default={}, description="further options of `vcage run`, of all jobs")

    @classmethod
    def load(cls, path: Path, *, check: bool = True) -> Self:
        """Read a plan.

        Args:
            path: of its file.
            check: that each of its cells is possible, too, without running it.

        Raises:
            InputFileError: the file cannot be read, or fields of it are wrong: names the file and all of these.
        """
        data = read_yaml(path)
        if not isinstance(data, dict):
            got = "nothing" if data is None else f"a {type(data).__name__}"
            raise mismatch(
                path, "(whole file)", f"got {got}; expected name, tasks, episodes and further keys", EXPLAINED
            )
        data = {"schema": cls.SCHEMA, **data}
        try:
            plan = cls.parse(data, path)
        except SchemaMismatch as error:
            if isinstance(error.__cause__, ValidationError):
                require_none(problems_of_fields(path, data, error.__cause__, cls))
            raise
        near = tuple(_beside(look, path) for look in plan.looks)
        plan = plan.model_copy(update={"looks": near})
        if check:
            from vcage.campaigns.impossible import problems_of_values  # all stages, which `vcage status` does without

            require_none(list(problems_of_values(path, plan)))
        return plan

    @cached_property
    def chain_options(self) -> ChainOptions:
        """The options that all jobs share."""
        from vcage.campaigns.options import options_of_plan  # all stages, which `vcage status` does without

        return options_of_plan(self.options)

    @cached_property
    def cells(self) -> tuple[Cell, ...]:
        """All cells, in the order of the plan."""
        seeds = tuple(range(self.seeds)) if isinstance(self.seeds, int) else self.seeds
        found = []
        for task in self.tasks:
            for robot, layout, look, seed in product(self.robots_of(task), self.layouts, self.looks, seeds):
                name = f"{task.name}_{slug(robot)}_{layout}_{slug(Path(look).stem)}_{seed}"
                found.append(Cell(id=name, task=task, robot=robot, layout=layout, look=look, seed=seed))
        return tuple(found)

    def robots_of(self, task: Task) -> tuple[str, ...]:
        """The robots that do a task."""
        return self.robots or (load_template(task.scene).robot,)

    def with_robots(self, earlier: Plan | None) -> Plan:
        """Name the robots that this plan leaves out: those of the campaign that it continues, else that of all scenes.

        A campaign goes on with its robots when the default is another one. Where scenes name different robots, it still
        names none.

        Args:
            earlier: the plan of that campaign; None for a new one.
        """
        if self.robots:
            return self
        if earlier is not None:
            robots = earlier.robots
        else:
            of_scenes = {robot for task in self.tasks for robot in self.robots_of(task)}
            robots = tuple(of_scenes) if len(of_scenes) == 1 else ()
        return Plan.model_validate(self.model_dump(by_alias=True) | {"robots": robots}) if robots else self

    def job(self, cell: Cell, number: int, episodes: int | None = None) -> Job:
        """The job of a cell with that number."""
        drawn = hashlib.sha256(f"{self.seed}/{cell.id}/{number}".encode()).digest()
        seed = int.from_bytes(drawn[:8], "big") % MOST_SEED
        return Job(cell=cell, number=number, episodes=episodes or self.episodes_per_job, seed=seed)

    def jobs_of(self, cell: Cell) -> tuple[Job, ...]:
        """The jobs of a cell that are sure to be needed; more may follow where these verify too few episodes."""
        if cell.id not in self._jobs_of:
            count = ceil(self.episodes / self.episodes_per_job)
            self._jobs_of[cell.id] = tuple(self.job(cell, n, self.asked_of(n)) for n in range(count))
        return self._jobs_of[cell.id]

    @cached_property
    def _jobs_of(self) -> dict[str, tuple[Job, ...]]:
        return {}

    def asked_of(self, number: int) -> int:
        """Episodes that the plan asks of the job with that number in any cell; none of those that may follow."""
        return max(0, min(self.episodes_per_job, self.episodes - number * self.episodes_per_job))

    def jobs(self) -> list[Job]:
        """These jobs of all cells: the first of each cell, then the second of each, and so on."""
        return [job for row in zip(*map(self.jobs_of, self.cells), strict=True) for job in row]

    @property
    def probes(self) -> int:
        """The number of first jobs of a cell that decide its gate; 0 without gates."""
        return 0 if self.gates is None else ceil(self.gates.after / self.episodes_per_job)

    @property
    def shares_crfs(self) -> bool:
        """True if the jobs of a cell begin at the CRFs that its first job finds.

        Read from the options as they stand: parsing them imports all stages, which `vcage status` does without.
        """
        return self.options.get("crf") is None and self.options.get("scope", "camera") == "camera"

    def deciding(self, number: int) -> int:
        """The number of first jobs of a cell that must be settled before the one with that number begins."""
        return max(count for count in (0, int(self.shares_crfs), self.probes) if count <= number)

    def index_of(self, job: Job) -> int:
        """The place of a job in that order, by which ``--shard`` shares the jobs out."""
        return job.number * len(self.cells) + self._places[job.cell.id]

    @cached_property
    def _places(self) -> dict[str, int]:
        return {cell.id: place for place, cell in enumerate(self.cells)}

    def options_of(self, job: Job) -> ChainOptions:
        """The options of the chain for a job."""
        return replace(
            self.chain_options,
            **job.cell.task.options,
            robot=job.cell.robot,
            layout=job.cell.layout,
            randomise=job.cell.look,
            seed=job.seed,
            episodes=job.episodes,
            workers=1,
        )

    def difference_to(self, earlier: Plan) -> str:
        """The reason why this plan cannot continue a campaign of an earlier one; empty if it can.

        Tasks, values of axes, seeds and episodes may be added; limits, gates and the name may change. What changes an
        episode that is there may not.
        """
        for field in ("seed", "episodes_per_job", "options"):
            if getattr(self, field) != getattr(earlier, field):
                return f"another value of {field}"
        if self.episodes < earlier.episodes:
            return f"fewer episodes per cell ({self.episodes}, not {earlier.episodes})"
        cells = {cell.id: cell for cell in self.cells}
        lost = [cell.id for cell in earlier.cells if cells.get(cell.id) != cell]
        return f"no cell, or another one, called {lost[0]}" if lost else ""


def slug(text: str, most: int = 40) -> str:
    """Text as a part of a folder's name; a hash is added where it is long or has no letter or digit of ASCII."""
    plain = re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")
    if len(plain) <= most and plain:
        return plain
    return f"{plain[:most].strip('-')}-{hashlib.sha256(text.encode()).hexdigest()[:6]}".strip("-")


def _beside(look: str, plan: Path) -> str:
    """The name of ranges, or the path of their file, which a plan gives from its own folder."""
    return str((plan.absolute().parent / look).resolve()) if look.endswith((".yml", ".yaml")) else look
