"""The estimate of a plan: from the costs of its own episodes where there are some, and on the page about planning."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from tests.campaigns.stubbed import begun, behave, plan
from tests.campaigns.test_driver import driven
from tests.run_folders import REPOSITORY
from vcage.campaigns.estimate import Estimate, UnitCosts
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.plan import Plan
from vcage.campaigns.status import status_of
from vcage.models.bill import Spent


def test_the_page_plans_a_million_episodes_by_the_measured_costs(tmp_path: Path):
    page = (REPOSITORY / "docs" / "planning.md").read_text(encoding="utf-8")
    path = tmp_path / "PLAN.yml"
    (written,) = re.findall(r"^```yaml\n(.*?)^```", page, re.DOTALL | re.MULTILINE)
    path.write_text(written)
    (shown,) = re.findall(r"^```text\n(.*?)\n```", page, re.DOTALL | re.MULTILINE)
    found = Estimate.of(Plan.load(path), CampaignFolder(tmp_path / "out"))
    assert found.asked == 1_000_000
    assert shown == found.text()


def test_a_plan_without_episodes_costs_the_measured_amount_for_each(tmp_path: Path):
    costs = UnitCosts("a test", cpu_seconds=36, bytes=2e6, files=10, memory_bytes=1e9)
    facts = Estimate(plan(tmp_path, seeds=2, episodes=50, episodes_per_job=5), 100, 100, costs).facts()
    assert (facts["cells"], facts["jobs"], facts["episodes"]) == (2, 20, 100)
    assert (facts["cpu_hours"], facts["bytes"], facts["files"]) == (1, 200_000_000, 1000)
    assert (facts["calls"], facts["usd"]) == (None, None)


def test_a_campaign_with_episodes_is_estimated_by_their_cost(tmp_path: Path):
    folder = begun(tmp_path, episodes=2)
    behave(tmp_path, all="half")
    driven(folder)
    grown = plan(tmp_path, episodes=10)
    found = Estimate.of(grown, folder)
    records = list(folder.records())
    assert (found.asked, found.left) == (10, 8)
    assert found.costs.source == "2 verified episodes of this campaign"
    assert found.costs.bytes == sum(record.bytes for record in records) / 2 > 0
    assert found.costs.files == sum(record.files for record in records) / 2 >= 2


def test_calls_and_money_are_shared_by_the_verified_episodes(tmp_path: Path):
    folder = begun(tmp_path, episodes=2)
    driven(folder)
    status = replace(status_of(folder), spent={"gemini": Spent(calls=6, usd=0.5)})
    costs = UnitCosts.of(status)
    assert costs is not None and (costs.calls, costs.usd) == (3, 0.25)


def test_no_more_cores_are_counted_than_there_are_jobs_left(tmp_path: Path):
    costs = UnitCosts("a test", cpu_seconds=3600, bytes=0, files=0, memory_bytes=0)
    found = Estimate(plan(tmp_path, episodes=32, episodes_per_job=1), 32, 32, costs)
    assert re.findall(r"on (\d+) cores +(.*)", found.text()) == [("16", "2.0 h"), ("256", "1.0 h"), ("4096", "1.0 h")]
    nearly = replace(found, left=8)
    assert re.findall(r"on (\d+) cores +(.*)", nearly.text())[0] == ("16", "1.0 h")
