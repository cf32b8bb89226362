"""Half-written work of a killed process is mended; that of a living one is left alone."""

from __future__ import annotations

import subprocess

from vcage.base.partial import PARTIAL, REPLACED, recover


def test_a_folder_killed_between_its_two_renames_is_restored(tmp_path):
    old = tmp_path / f"stage{REPLACED}123"
    old.mkdir()
    (old / "a").write_text("old")
    (tmp_path / f"stage{PARTIAL}123").mkdir()
    recover(tmp_path / "stage")
    assert (tmp_path / "stage" / "a").read_text() == "old"
    assert len(list(tmp_path.iterdir())) == 1


def test_what_a_process_that_is_still_there_writes_is_left_to_it(tmp_path):
    other = subprocess.Popen(["sleep", "60"])
    part = tmp_path / f"x{PARTIAL}{other.pid}"
    part.mkdir()
    recover(tmp_path / "x")
    assert part.is_dir()
    other.kill()
    other.wait()
    recover(tmp_path / "x")
    assert not part.exists()
