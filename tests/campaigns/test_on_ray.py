"""The driver on a Ray cluster: two nodes on the loopback of this machine, and what may happen to them."""

from __future__ import annotations

import contextlib
import importlib.util
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest

from benchmarks._campaign_kills import at_work
from benchmarks._campaign_outputs import outputs
from benchmarks._ray_nodes import RayNodes
from tests.campaigns import test_campaign
from tests.campaigns.mounts import elsewhere, needs_mounts
from tests.campaigns.stubbed import began, begun, behave, run_stubbed
from tests.campaigns.test_campaign import PROGRAM
from tests.run_folders import REPOSITORY, clean_environment, process
from vcage.base.errors import ClusterLost, ConfigurationError, MissingDependency
from vcage.base.version import __version__
from vcage.campaigns import on_ray
from vcage.campaigns.driver import run_here
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.on_ray import run_on_ray
from vcage.campaigns.ray_actor import actor_class
from vcage.campaigns.ray_cluster import LOCAL_ONLY, OBJECT_STORE_BYTES, RaySettings, address_of, connected
from vcage.campaigns.schedule import Schedule, left_over

needs_ray = pytest.mark.skipif(
    importlib.util.find_spec("ray") is None, reason="Ray is not installed; `make test-ray` installs it"
)

QUICK = RaySettings(look_every_s=0.5, freed_within_s=3.0, rest_s=0.5, seen_within_s=1.0)

plan, undisturbed = test_campaign.plan, test_campaign.undisturbed  # fixtures: a real campaign of two jobs, and its plan

NODE = {
    "num_cpus": 1,
    "node_ip_address": "127.0.0.1",
    "include_dashboard": False,
    "object_store_memory": OBJECT_STORE_BYTES,
}


@pytest.fixture
def cluster(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """A cluster of two nodes; the head is the first."""
    monkeypatch.setenv(LOCAL_ONLY, "0")  # before Ray is imported
    monkeypatch.setenv("RAY_USAGE_STATS_ENABLED", "0")
    with tempfile.TemporaryDirectory(prefix="ray-", dir="/tmp") as folder:  # short, as paths of sockets must be
        monkeypatch.setenv("RAY_TMPDIR", folder)
        from ray.cluster_utils import Cluster

        started = Cluster(initialize_head=True, head_node_args=NODE, shutdown_at_exit=True)
        started.add_node(**NODE)
        yield started
        started.shutdown()


def driven(folder: CampaignFolder, cluster: Any, settings: RaySettings = QUICK, **keys: Any) -> Schedule:
    return run_on_ray(folder, cluster.address, work=run_stubbed, settings=settings, **keys)


def states(folder: CampaignFolder) -> Counter[str]:
    return Counter(record.state for record in folder.records())


def meanwhile(do: Callable[[], None], folder: CampaignFolder, jobs: int) -> threading.Thread:
    """Do something as soon as so many jobs have begun."""

    def wait() -> None:
        while len(began(folder.root.parent)) < jobs:
            time.sleep(0.05)
        do()

    thread = threading.Thread(target=wait, daemon=True)
    thread.start()
    return thread


def actors() -> list[psutil.Process]:
    """The processes of actors on this machine that run jobs of a test here."""
    found = []
    for one in psutil.Process().children(recursive=True):
        with contextlib.suppress(psutil.NoSuchProcess):
            if one.name().startswith("ray::Worker"):
                found.append(one)
    return found


def test_an_address_is_checked_where_it_is_given():
    assert address_of("auto") == "auto"
    assert address_of("10.0.0.1:6379") == "10.0.0.1:6379"
    for wrong in ("ray://10.0.0.1:10001", "10.0.0.1", "head:", "head:65536"):
        with pytest.raises(ValueError, match="expected auto, or HOST:PORT"):
            address_of(wrong)


def test_without_ray_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "ray", None)
    monkeypatch.setenv("RAY_TMPDIR", str(tmp_path))
    with pytest.raises(MissingDependency) as caught:
        run_on_ray(begun(tmp_path), "auto", work=run_stubbed)
    assert "vcage[ray]" in caught.value.command


def test_an_address_at_which_nothing_listens_is_named_at_once(tmp_path: Path):
    with pytest.raises(ClusterLost, match=r"no Ray cluster answers at 127\.0\.0\.1:9$"):
        run_on_ray(begun(tmp_path), "127.0.0.1:9", work=run_stubbed)


@needs_ray
def test_all_jobs_are_run_once_by_actors_of_both_nodes(cluster: Any, tmp_path: Path):
    folder = begun(tmp_path, seeds=2, episodes=5)
    assert left_over(driven(folder, cluster)) is None
    assert sorted(began(tmp_path)) == sorted(job.id for job in folder.plan.jobs())
    assert states(folder) == {"done": 10}


@needs_ray
def test_the_same_files_come_from_a_cluster_and_from_processes_of_this_machine(cluster: Any, tmp_path: Path):
    folders = []
    for name in ("ray", "here"):
        (tmp_path / name).mkdir()
        folders.append(begun(tmp_path / name, seeds=2, episodes=2))
        behave(tmp_path / name, n1="half")
    driven(folders[0], cluster)
    run_here(folders[1], 1, work=run_stubbed)
    assert outputs(folders[0].root) == outputs(folders[1].root)


@needs_ray
def test_an_actor_that_is_killed_loses_no_job(cluster: Any, tmp_path: Path):
    folder = begun(tmp_path, episodes=6)
    behave(tmp_path, all="slow")
    thread = meanwhile(lambda: actors()[0].kill(), folder, 2)
    assert left_over(driven(folder, cluster)) is None
    thread.join()
    assert states(folder) == {"done": 6}
    assert len(began(tmp_path)) == 7
    assert sum(record.tries for record in folder.records()) == 7


@needs_ray
def test_a_node_that_is_removed_loses_no_job(cluster: Any, tmp_path: Path):
    folder = begun(tmp_path, episodes=6)
    behave(tmp_path, all="slow")
    node = next(iter(cluster.worker_nodes))
    thread = meanwhile(lambda: cluster.remove_node(node, allow_graceful=False), folder, 2)
    assert left_over(driven(folder, cluster)) is None
    thread.join()
    assert states(folder) == {"done": 6}


@needs_ray
def test_a_node_that_joins_takes_jobs(cluster: Any, tmp_path: Path):
    cluster.remove_node(next(iter(cluster.worker_nodes)))
    folder = begun(tmp_path, episodes=10)
    behave(tmp_path, all="slow")
    most: list[int] = []

    def look(*_: object) -> None:
        most.append(len(actors()))
        if len(most) == 3:
            cluster.add_node(**NODE)

    assert left_over(driven(folder, cluster, progress=look)) is None
    assert states(folder) == {"done": 10}
    assert (most[0], most[2], most[-1]) == (0, 1, 2)


@needs_ray
def test_a_job_that_ends_its_actor_each_time_is_given_up_and_stops_no_other(cluster: Any, tmp_path: Path):
    folder = begun(tmp_path, episodes=3, limits={"tries": 2, "attempts": 9})
    behave(tmp_path, n1="crash")
    driven(folder, cluster)
    assert states(folder)["given_up"] == 1
    assert sum(record.verified for record in folder.records()) == 3
    assert Counter(began(tmp_path))[f"{folder.plan.cells[0].id}/0001"] == 2


@needs_ray
def test_a_silent_actor_is_replaced(cluster: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("vcage.campaigns.hanging.silence_limit", lambda plan: 6.0)
    folder = begun(tmp_path, episodes=4, limits={"tries": 1})
    behave(tmp_path, n0="hang")
    driven(folder, cluster)
    lost = next(record for record in folder.records() if record.state == "given_up")
    assert lost.number == 0 and lost.error is not None and "gave no sign of life" in lost.error.message
    assert sum(record.verified for record in folder.records()) == 4


@needs_ray
def test_a_stopped_actor_is_ended_and_its_job_is_done_once(
    cluster: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("vcage.campaigns.hanging.silence_limit", lambda plan: 15.0)
    folder = begun(tmp_path, episodes=4)
    behave(tmp_path, all="slow")
    stopped: list[psutil.Process] = []

    def stop() -> None:
        stopped.append(psutil.Process(min(at_work(folder.root).values())))
        stopped[0].suspend()

    thread = meanwhile(stop, folder, 1)
    assert left_over(driven(folder, cluster)) is None
    thread.join()
    assert states(folder) == {"done": 4}
    assert len(began(tmp_path)) == 5
    if stopped[0].is_running():
        stopped[0].resume()
        stopped[0].wait(20)
    assert (states(folder), len(began(tmp_path))) == ({"done": 4}, 5)


@needs_ray
def test_a_stopped_node_gives_its_job_back_and_does_not_go_on_with_it_later(
    cluster: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("vcage.campaigns.hanging.silence_limit", lambda plan: 15.0)
    folder = begun(tmp_path, episodes=4)
    behave(tmp_path, all="slow")
    node = cluster.worker_nodes.copy().pop()
    stopped: list[psutil.Process] = []

    def stop() -> None:
        raylet = psutil.Process(node.all_processes["raylet"][0].process.pid)
        stopped.extend([raylet, *raylet.children(recursive=True)])
        for one in stopped:
            one.suspend()

    thread = meanwhile(stop, folder, 2)
    assert left_over(driven(folder, cluster)) is None
    thread.join()
    assert states(folder) == {"done": 4}
    before = outputs(folder.root), list(folder.records())
    for one in stopped:
        one.resume()
    psutil.wait_procs(stopped, timeout=20)
    assert (outputs(folder.root), list(folder.records())) == before


@needs_ray
def test_a_cluster_with_another_version_is_refused_and_its_nodes_are_named(
    cluster: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(on_ray, "__version__", "9.9.9")
    folder = begun(tmp_path)
    with pytest.raises(ConfigurationError, match="no node of the Ray cluster can run") as caught:
        driven(folder, cluster)
    assert caught.value.message.count(f"it has vcage {__version__}, not 9.9.9") == 2
    assert began(tmp_path) == []
    assert not list(folder.root.glob("*.partial-*"))


@needs_ray
@needs_mounts
def test_a_node_with_another_folder_gets_no_job_and_is_named(
    cluster: Any, tmp_path: Path, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
):
    cluster.remove_node(next(iter(cluster.worker_nodes)))
    folder = begun(tmp_path, episodes=4)
    behave(tmp_path, all="slow")
    monkeypatch.setattr(cluster, "_shutdown_at_exit", False)  # which takes signals, as only the main thread may
    elsewhere(lambda: cluster.add_node(**NODE), mount_over=folder.root)
    assert left_over(driven(folder, cluster, workers=2)) is None
    assert states(folder) == {"done": 4}
    assert f"{folder.root} is another folder there" in caplog.text


@needs_ray
def test_a_node_without_a_renderer_gets_no_more_jobs_and_is_named(
    cluster: Any, tmp_path: Path, caplog: pytest.LogCaptureFixture
):
    folder = begun(tmp_path, episodes=4, limits={"tries": 1})
    behave(tmp_path, all="lack")
    (tmp_path / "bare-node").write_text(next(iter(cluster.worker_nodes)).node_id)
    assert left_over(driven(folder, cluster)) is None
    assert states(folder) == {"done": 4}
    assert len(began(tmp_path)) == 5
    assert [record.tries for record in folder.records()] == [1] * 4
    assert "no job is given to a node of the Ray cluster" in caplog.text and "no Vulkan driver" in caplog.text


@needs_ray
def test_a_driver_that_is_killed_goes_on_when_it_is_started_again(cluster: Any, tmp_path: Path):
    folder = begun(tmp_path, episodes=6)
    behave(tmp_path, all="slow")
    script = (
        "import sys; from pathlib import Path; from tests.campaigns.test_on_ray import *\n"
        "run_on_ray(CampaignFolder(Path(sys.argv[1])), sys.argv[2], work=run_stubbed, settings=QUICK)"
    )
    command = [sys.executable, "-c", script, str(folder.root), cluster.address]
    driver = subprocess.Popen(command, cwd=REPOSITORY, env=clean_environment() | {LOCAL_ONLY: "0"})
    meanwhile(driver.kill, folder, 3).join(60)
    driver.wait()
    assert states(folder)["done"] < 6
    assert left_over(driven(folder, cluster)) is None
    assert states(folder) == {"done": 6}


@needs_ray
def test_a_lost_head_ends_the_driver_and_the_same_campaign_goes_on(cluster: Any, tmp_path: Path):
    folder = begun(tmp_path, episodes=4)
    behave(tmp_path, all="slow")
    head = next(one for one in psutil.Process().children(recursive=True) if "gcs_server" in one.name())
    thread = meanwhile(head.kill, folder, 1)
    with pytest.raises(ClusterLost, match="does not answer any more") as caught:
        driven(folder, cluster)
    assert caught.value.retryable and "run the same command" in caught.value.hint
    thread.join()
    cluster.shutdown()
    assert left_over(run_here(folder, 1, work=run_stubbed)) is None
    assert states(folder) == {"done": 4}


@needs_ray
@pytest.mark.parametrize("hidden", [True, False])
def test_a_cluster_that_ray_start_began_runs_jobs_on_both_nodes_by_its_loopback_address(tmp_path: Path, hidden: bool):
    folder = begun(tmp_path, episodes=4)
    with RayNodes(hidden=hidden) as nodes:
        nodes.start()
        command = [sys.executable, "-m", "tests.campaigns.stubbed_command", "campaign", tmp_path / "PLAN.yml"]
        command += ["--out", folder.root, "--ray", nodes.address, "--workers", "2"]
        environment = clean_environment() | nodes.environment
        done = subprocess.run(command, cwd=REPOSITORY, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert states(folder) == {"done": 4}


@needs_ray
def test_a_cluster_of_its_own_starts_no_worker_that_no_actor_asked_for(monkeypatch: pytest.MonkeyPatch):
    with tempfile.TemporaryDirectory(prefix="ray-", dir="/tmp") as folder:
        monkeypatch.setenv("RAY_TMPDIR", folder)
        with connected("auto", 2) as ray:
            own = [ray.remote(actor_class()).remote("", "", __version__)]
            ray.get([one.run.remote(None, None) for one in own])
            names = [one.name() for one in psutil.Process().children(recursive=True)]
    assert sum(name.startswith("ray::Worker") for name in names) == 1
    assert not [name for name in names if name.startswith("ray::IDLE")]


@needs_ray
@pytest.mark.slow
def test_a_real_campaign_on_a_cluster_of_its_own_makes_the_same_files(
    plan: Path,
    undisturbed: Path,
    tmp_path: Path,
):
    out = tmp_path / "campaign"
    done = process([*PROGRAM, "campaign", plan, "--out", out, "--ray", "auto", "--workers", "2"], REPOSITORY)
    assert done.code == 0, done.record
    assert (done.record["summary"]["verified"], done.record["summary"]["jobs"]) == (2, {"done": 2})
    assert outputs(out) == outputs(undisturbed)
