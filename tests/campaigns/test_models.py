"""The models of a campaign: what one job has asked, no other asks again, and all jobs have one limit."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.campaigns.stubbed import begun
from tests.model_server import ModelServer
from vcage.base.errors import SpendingCap
from vcage.base.workers import SameProcess
from vcage.campaigns.driver import work_through
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.job import run_job
from vcage.campaigns.schedule import Schedule, left_over
from vcage.campaigns.status import status_of
from vcage.models.exchanges import Exchanges
from vcage.stages import chain, select_place

KEYS = {
    "tasks": [{"id": "blocks", "instruction": "Put the red block and the green block into the box"}],
    "episodes": 1,
    "options": {"models": "gemini"},
}


@pytest.fixture
def server(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[ModelServer]:
    """A model server, and a chain that only chooses and places the objects."""
    monkeypatch.setattr(chain, "STAGES", {"select_place": select_place})
    with ModelServer() as running:
        for name, value in running.environment.items():
            monkeypatch.setenv(name, value)
        monkeypatch.setenv("VCAGE_PRICE_FILE", str(tmp_path / "prices.json"))
        (tmp_path / "prices.json").write_text("{}")
        yield running


def driven(folder: CampaignFolder) -> Schedule:
    schedule = Schedule(folder)
    work_through(schedule, SameProcess(lambda job: run_job(folder.root, job)), 1)
    return schedule


def test_a_question_of_one_job_is_not_asked_again_by_another(server: ModelServer, tmp_path: Path):
    folder = begun(tmp_path, seeds=2, **KEYS, limits={"attempts": 1})
    driven(folder)
    runs = [Exchanges(folder.run(job).exchanges).all() for job in folder.plan.jobs()]
    hashes = {exchange.hash for exchanges in runs for exchange in exchanges}
    assert all(runs) and len(hashes) < sum(map(len, runs))
    assert len(server.requests) == len(hashes) == len(Exchanges(folder.exchanges).all())
    assert status_of(folder).calls == len(hashes)


@pytest.mark.slow
def test_a_limit_of_calls_ends_the_campaign_and_a_larger_one_goes_on(server: ModelServer, tmp_path: Path):
    folder = begun(tmp_path, seeds=3, **KEYS, limits={"calls": 0, "attempts": 1})
    error = left_over(driven(folder))
    assert isinstance(error, SpendingCap) and "the campaign holds 0 answers" in error.message
    assert server.requests == [] and list(folder.records()) == []
    begun(tmp_path, seeds=3, **KEYS, limits={"calls": 100, "attempts": 1})
    assert left_over(driven(folder)) is None
    assert {record.cell for record in folder.records()} == {cell.id for cell in folder.plan.cells}


def test_a_key_that_is_missing_settles_no_job(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    for name in ("VCAGE_OPENAI_API_KEY", "OPENAI_API_KEY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("VCAGE_KEY_FILE", str(tmp_path / "keys.json"))
    folder = begun(tmp_path, seeds=3, options={"models": "openai"})
    error = left_over(driven(folder))
    assert error is not None and error.code == "missing_key"
    assert list(folder.records()) == []
    assert json.loads(folder.tries_file(folder.plan.jobs()[0]).read_text())["count"] == 0
