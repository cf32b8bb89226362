"""Compare the files of killed runs with those of an undisturbed one."""

from __future__ import annotations

from benchmarks.kills import compared


def test_changed_missing_and_extra_files_are_told_apart():
    undisturbed = {"runs/run/a": "1", "runs/run/b": "2", "runs/run/timings.json": ""}
    found = {"runs/run/a": "1", "runs/run/timings.json": "", "temporary/pymp-1/vcage": "", "runs/run/c.partial-1": "3"}
    assert compared(undisturbed, found) == (["runs/run/b"], ["runs/run/c.partial-1", "temporary/pymp-1/vcage"])
    assert compared(undisturbed, undisturbed) == ([], [])
