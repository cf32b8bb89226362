from __future__ import annotations

import json
from pathlib import Path

import pytest

from benchmarks._campaign_settled import settled


@pytest.mark.slow
def test_a_campaign_of_settled_jobs_is_read_to_its_end(tmp_path: Path):
    found = settled(tmp_path / "settled", 6)
    assert found["jobs"] == 6 == len(list((tmp_path / "settled").rglob("*.job.json")))
    assert min(found[who][key] for who in ("status", "driver") for key in ("cpu_s", "mb")) > 0
    assert not list((tmp_path / "settled").rglob("episodes.json"))
    record = json.loads(next((tmp_path / "settled").rglob("*.job.json")).read_text())
    assert (record["state"], record["verified"]) == ("done", 1)
