"""The finished run that many tests look at: made once for all processes, since making it takes a minute."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from filelock import FileLock
from hypothesis import settings

from tests.run_folders import Finished, finished_run
from vcage.base.files import RunFolder
from vcage.runs.context import StageContext

settings.register_profile("any-machine", deadline=None)  # a busy machine may take any time for an example
settings.load_profile("any-machine")


@pytest.hookimpl(trylast=True)  # after -m and -k have chosen
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """A file that makes the finished run comes first, and the others that need it last.

    So the other processes have work until it exists.
    """
    needs: dict[Path, bool] = {}
    for item in items:
        needs[item.path] = needs.get(item.path, False) or "finished" in item.fixturenames
    maker = next((path for path, need in needs.items() if need), None)
    items.sort(key=lambda item: (item.path != maker, needs[item.path]))


@pytest.fixture(scope="session")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Finished:
    """One episode of "Put two blocks on the plate", through all nine stages and the report."""
    folder = _of_all_workers(tmp_path_factory) / "run"  # the name is in the exported data sets
    with FileLock(f"{folder}.lock"):
        if not (folder / "report.html").exists():
            return finished_run(folder)
    return Finished(RunFolder(folder), StageContext("offline"))


def _of_all_workers(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of this run of pytest that its worker processes share."""
    own = tmp_path_factory.getbasetemp()
    return own.parent if "PYTEST_XDIST_WORKER" in os.environ else own


@pytest.fixture(scope="session", autouse=True)
def no_ollama() -> Iterator[None]:
    """``auto`` does not take an Ollama that runs on this machine; nothing listens at port 9."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("VCAGE_OLLAMA_URL", "http://127.0.0.1:9")
        yield


@pytest.fixture(scope="session", autouse=True)
def nothing_imported(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Tests see the project's own library and robots, not what the user of this machine has imported."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("VCAGE_DATA", str(tmp_path_factory.mktemp("data")))
        patch.delenv("VCAGE_ASSETS", raising=False)
        yield
