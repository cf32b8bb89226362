"""The crew of actors beside a stand-in of Ray: actors that rest, and actors that cannot begin."""

from __future__ import annotations

import contextlib
import itertools
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.campaigns.stubbed import begun, run_stubbed
from vcage.base.errors import (
    ConfigurationError,
    DiskFull,
    MissingDependency,
    NoRenderer,
    OutputFolderError,
    SpendingCap,
    VcageError,
)
from vcage.base.version import __version__
from vcage.campaigns import on_ray
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.job import Outcome
from vcage.campaigns.on_ray import RayCrew
from vcage.campaigns.plan import Job
from vcage.campaigns.ray_actor import MARK
from vcage.campaigns.ray_cluster import RaySettings

QUICK = RaySettings(look_every_s=0.05, rest_s=0.2, longest_rest_s=0.3, unborn=3)


class RayError(Exception):
    """As in ``ray.exceptions``."""


class TaskError(RayError):
    pass


class DiedError(RayError):
    pass


class StandIn:
    """The parts of Ray that a crew uses; every call of an actor is answered at once by a function.

    Args:
        look_around: answers the question of that name.
        run: answers for a job.
        nodes: of one processor each; actors are spread over those that they may use.
    """

    def __init__(
        self,
        root: Path,
        look_around: Callable[[], Any],
        run: Callable[[Job], Any],
        nodes: Sequence[str] = ("node",),
    ):
        self.root, self._look_around, self._run, self._nodes = root, look_around, run, nodes
        self.here = ""
        """The node of the actor that answers."""
        self.exceptions = SimpleNamespace(RayError=RayError, RayTaskError=TaskError, ActorDiedError=DiedError)
        self.started, self._numbers = 0, itertools.count()
        self._calls: dict[int, Callable[[], Any]] = {}

    def get_runtime_context(self) -> Any:
        return SimpleNamespace(gcs_address="head:1")

    def nodes(self) -> list[dict[str, Any]]:
        return [{"Alive": True, "NodeID": name, "Resources": {"CPU": 1.0}} for name in self._nodes]

    def remote(self, _kind: type) -> Any:
        def options(label_selector: dict[str, str] | None, **_: Any) -> Any:
            left_out = "" if label_selector is None else label_selector["ray.io/node-id"]
            places = [name for name in self._nodes if name not in left_out.strip("!in()").split(",")]
            return SimpleNamespace(remote=lambda *_: self._actor(places[self.started % len(places)]))

        return SimpleNamespace(options=options)

    def wait(self, asked: list[int], **_: Any) -> tuple[list[int], list[int]]:
        return asked, []

    def get(self, asked: int) -> Any:
        return self._calls.pop(asked)()

    def kill(self, _actor: Any, **_: Any) -> None:
        pass

    def _actor(self, node: str) -> Any:
        self.started += 1
        look = SimpleNamespace(remote=lambda: self._asked(node, self._look_around))
        return SimpleNamespace(
            look_around=SimpleNamespace(options=lambda **_: look),
            run=SimpleNamespace(remote=lambda _work, job: self._asked(node, lambda: self._run(job))),
            leave=SimpleNamespace(remote=lambda: self._asked(node, lambda: None)),
        )

    def _asked(self, node: str, answer: Callable[[], Any]) -> int:
        def answer_there() -> Any:
            self.here = node
            return answer()

        number = next(self._numbers)
        self._calls[number] = answer_there
        return number


@pytest.fixture(autouse=True)
def head(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(on_ray, "require_head", lambda address: None)


def fit(folder: CampaignFolder) -> Callable[[], dict[str, str]]:
    """The answer of an actor on a node that can run jobs."""

    def look_around() -> dict[str, str]:
        (folder.root / "mark").touch()
        return {"node": "node", "host": "here", "version": __version__, "mark": "mark", "fault": ""}

    return look_around


@pytest.mark.parametrize("kind", [DiskFull, OutputFolderError])
def test_an_actor_pauses_longer_each_time_while_its_disk_is_full_and_not_later(tmp_path: Path, kind: type[VcageError]):
    folder, moments = begun(tmp_path, episodes=6), list[float]()

    def run(job: Job) -> Outcome:
        moments.append(time.monotonic())
        return Outcome(job, error=kind("nothing can be written") if job.number < 3 else None)

    with RayCrew(StandIn(folder.root, fit(folder), run), folder, settings=QUICK) as crew:
        for job in folder.plan.jobs():
            crew.submit(job)
        assert len(list(crew.results())) == 6
    gaps = [later - earlier for earlier, later in itertools.pairwise(moments)]
    assert gaps[0] >= 0.2 and gaps[1] >= 0.3 and gaps[2] >= 0.3
    assert max(gaps[3:]) < 0.15


def test_the_driver_ends_where_no_actor_can_begin(tmp_path: Path):
    folder = begun(tmp_path)

    def die() -> None:
        raise DiedError("the node has no memory left")

    ray = StandIn(folder.root, die, lambda job: Outcome(job))
    with RayCrew(ray, folder, settings=QUICK) as crew:
        crew.submit(folder.plan.jobs()[0])
        with pytest.raises(ConfigurationError, match="no worker of the Ray cluster can begin: the node has no memory"):
            list(crew.results())
    assert ray.started == QUICK.unborn


def test_actors_that_die_now_and_then_do_not_end_the_driver(tmp_path: Path):
    folder, tries = begun(tmp_path, episodes=8), itertools.count()

    def run(job: Job) -> Outcome:
        if next(tries) % 2:
            raise DiedError("it was killed")
        return Outcome(job)

    with RayCrew(StandIn(folder.root, fit(folder), run), folder, settings=QUICK) as crew:
        for job in folder.plan.jobs():
            crew.submit(job)
        assert len(list(crew.results())) == 8


# --- nodes that lack something -----------------------------------------------------------------------------


def answers(folder: CampaignFolder, lacking: dict[str, Exception], nodes: Sequence[str]) -> list[Outcome]:
    """The outcomes of a campaign on nodes of which some answer each job with an error."""

    def look_around() -> dict[str, str]:
        return fit(folder)() | {"node": ray.here, "host": f"host-{ray.here}"}

    def run(job: Job) -> Outcome:
        error = lacking.get(ray.here)
        if error is None or isinstance(error, VcageError):
            return Outcome(job, error=error)
        raise error

    ray = StandIn(folder.root, look_around, run, nodes)
    with RayCrew(ray, folder, settings=QUICK) as crew:
        for job in folder.plan.jobs():
            crew.submit(job)
        return list(crew.results())


@pytest.mark.parametrize("error", [NoRenderer("no Vulkan"), MissingDependency("no torch"), TaskError("no module")])
def test_a_node_that_lacks_something_is_named_and_the_others_run_its_jobs(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, error: Exception
):
    folder = begun(tmp_path, episodes=6)
    found = answers(folder, {"bare": error}, ["bare", "one", "two"])
    assert sorted(one.job.number for one in found) == list(range(6))
    assert [one.error for one in found] == [None] * 6
    assert [str(error) in line and "host-bare (bare)" in line for line in caplog.messages] == [True]


def test_a_cluster_of_which_no_node_has_what_jobs_need_is_refused_and_all_are_named(tmp_path: Path):
    folder = begun(tmp_path, episodes=6)
    lacking: dict[str, Exception] = {"one": NoRenderer("no Vulkan"), "two": MissingDependency("no torch")}
    with pytest.raises(ConfigurationError, match="no node of the Ray cluster can run this campaign") as caught:
        answers(folder, lacking, ["one", "two"])
    assert "host-one (one): no Vulkan" in caught.value.message and "host-two (two): no torch" in caught.value.message


def test_the_only_node_that_lacks_something_ends_the_campaign_with_its_own_error(tmp_path: Path):
    folder = begun(tmp_path, episodes=1)
    (found,) = answers(folder, {"node": NoRenderer("no Vulkan")}, ["node"])
    assert isinstance(found.error, NoRenderer)


def test_a_limit_of_all_nodes_leaves_none_out(tmp_path: Path, caplog: pytest.LogCaptureFixture):
    folder = begun(tmp_path, episodes=2)
    cap = SpendingCap("the campaign has asked as often as it may")
    found = answers(folder, {"one": cap, "two": cap}, ["one", "two"])
    assert [one.error for one in found] == [cap, cap] and caplog.messages == []


def test_a_mark_of_a_node_that_was_lost_before_the_driver_saw_it_is_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    folder = begun(tmp_path, episodes=1)
    (lost := folder.root / f"{MARK}0").touch()
    ray = StandIn(folder.root, fit(folder), lambda job: run_stubbed(folder.root, job))
    monkeypatch.setattr(on_ray, "connected", lambda *_: contextlib.nullcontext(ray))
    on_ray.run_on_ray(folder, "auto", settings=QUICK)
    assert not lost.exists()
