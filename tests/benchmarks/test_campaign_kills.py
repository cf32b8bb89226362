"""Compare campaigns that were killed with one that was not."""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

from benchmarks._campaign_kills import KilledCampaign
from benchmarks._campaign_outputs import differing, left_over, outputs


def campaign(folder: Path, picture: bytes, seconds: float, verified: int = 1) -> Path:
    run = folder / "jobs" / "cell" / "0000"
    (run / "place").mkdir(parents=True)
    (run / "place" / "source.png").write_bytes(picture)
    (run / "timings.json").write_text(str(seconds))
    record = {"verified": verified, "seconds": seconds, "ended": str(seconds), "tries": seconds, "bytes": seconds}
    (run.parent / "0000.job.json").write_text(json.dumps(record))
    return folder


def test_times_do_not_make_campaigns_differ_and_all_else_does(tmp_path: Path):
    one = outputs(campaign(tmp_path / "one", b"1", 1.0))
    assert differing(one, outputs(campaign(tmp_path / "later", b"1", 2.0))) == []
    assert differing(one, outputs(campaign(tmp_path / "other", b"2", 1.0))) == ["cell/0000/place/source.png"]
    assert differing(one, outputs(campaign(tmp_path / "fewer", b"1", 1.0, verified=0))) == ["cell/0000.job.json"]
    assert differing(one, {}) == sorted(one)


def test_partial_work_is_no_output_and_is_named(tmp_path: Path):
    found = campaign(tmp_path / "one", b"1", 1.0)
    before, part = outputs(found), found / "jobs" / "cell" / "0000" / "compress.partial-17"
    part.mkdir()
    (part / "a.mp4").touch()
    assert outputs(found) == before
    assert left_over(found) == ["jobs/cell/0000/compress.partial-17/a.mp4"]


def test_a_command_may_complain_at_any_length(tmp_path: Path):
    talks = "import sys; sys.stderr.write('word ' * 40_000 + '\\nat last\\n'); sys.exit(3)"
    killed = KilledCampaign(tmp_path / "PLAN.yml", tmp_path, [[]], program=(sys.executable, "-c", talks))
    killed.start()
    end = time.monotonic() + 60
    while killed.look() and time.monotonic() < end:
        time.sleep(0.05)
    killed.end()
    assert killed.unexpected == ["exit 3: at last"]
