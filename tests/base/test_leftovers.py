"""Leftovers of killed processes go; files of living ones, or of others, stay."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from vcage.base.files import cache_path
from vcage.base.leftovers import (
    PARTIAL,
    REPLACED,
    SCRATCH,
    recover,
    scratch_folder,
    sweep_cache,
    sweep_folder,
    sweep_scratch,
)

HOLDER = """
import signal
from vcage.base.leftovers import scratch_folder
with scratch_folder() as folder:
    (folder / "a file").touch()
    print(folder, flush=True)
    signal.pause()
"""

NOBODY = 2**22 + 1
"""More than the largest number of a process."""


@pytest.fixture(autouse=True)
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(tempfile, "tempdir", None)
    return tmp_path


def started() -> tuple[subprocess.Popen, Path]:
    process = subprocess.Popen([sys.executable, "-c", HOLDER], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    return process, Path(process.stdout.readline().strip())


def test_a_temporary_folder_is_removed_at_the_end():
    with scratch_folder() as folder:
        (folder / "a file").touch()
    assert not folder.exists()


def test_that_of_a_killed_process_is_removed_by_the_next_and_not_while_it_lives():
    process, folder = started()
    with process:
        sweep_scratch()
        assert (folder / "a file").exists()
        process.kill()
    assert folder.exists()
    with scratch_folder():
        assert not folder.exists()


def test_folders_of_others_and_links_stay(tmp_path):
    (tmp_path / "pymp-1").mkdir()
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / f"{SCRATCH}link").symlink_to(tmp_path / "elsewhere")
    (tmp_path / "vcage-my-run").mkdir()
    sweep_scratch()
    assert len(list(tmp_path.iterdir())) == 4


def test_partial_work_of_dead_processes_goes_from_a_held_folder(tmp_path):
    living = os.getppid()
    gone = [f"place{PARTIAL}{NOBODY}/a.png", f"options{PARTIAL}{NOBODY}.json", f"place/deep/b{PARTIAL}{NOBODY}.png"]
    gone += [f"place{PARTIAL}{NOBODY}{PARTIAL}{NOBODY}/a.png"]  # partial work within partial work
    stays = [
        f"place{PARTIAL}{living}/a.png",
        f"notes{PARTIAL}{NOBODY}.txt",
        f"mine/b{PARTIAL}{NOBODY}.png",
        f"place/b{PARTIAL}one.png",
        "place/c.png",
    ]
    for name in (*gone, *stays):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    sweep_folder(tmp_path, {"place", "options"})
    assert sorted(p.relative_to(tmp_path).as_posix() for p in tmp_path.rglob("*") if p.is_file()) == sorted(stays)


def test_a_replaced_file_is_put_back_if_nothing_took_its_place(tmp_path):
    for name in (f"place{REPLACED}{NOBODY}", f"match{REPLACED}{NOBODY}", "match"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "of").write_text(name)
    sweep_folder(tmp_path, {"place", "match"})
    assert {path.name: (path / "of").read_text() for path in tmp_path.iterdir()} == {
        "place": f"place{REPLACED}{NOBODY}",
        "match": "match",
    }


def test_partial_work_in_the_cache_goes_when_it_is_old(tmp_path, monkeypatch):
    monkeypatch.setenv("VCAGE_CACHE", str(tmp_path))
    old, new = (tmp_path / "assets" / f"{name}{PARTIAL}{NOBODY}" for name in ("old", "new"))
    for folder in (old, new):
        folder.mkdir(parents=True)
    os.utime(old, (0, 0))
    sweep_cache(cache_path())
    assert new.exists() and not old.exists()


def test_a_folder_killed_between_its_two_renames_is_restored(tmp_path):
    old = tmp_path / f"stage{REPLACED}123"
    old.mkdir()
    (old / "a").write_text("old")
    (tmp_path / f"stage{PARTIAL}123").mkdir()
    recover(tmp_path / "stage")
    assert (tmp_path / "stage" / "a").read_text() == "old"
    assert len(list(tmp_path.iterdir())) == 1


def test_files_of_a_living_process_are_left_alone(tmp_path):
    other = subprocess.Popen(["sleep", "60"])
    part = tmp_path / f"x{PARTIAL}{other.pid}"
    part.mkdir()
    recover(tmp_path / "x")
    assert part.is_dir()
    other.kill()
    other.wait()
    recover(tmp_path / "x")
    assert not part.exists()


def test_those_of_a_killed_process_go_though_its_parent_has_not_asked_how_it_ended(tmp_path):
    other = subprocess.Popen(["sleep", "60"])
    part = tmp_path / f"x{PARTIAL}{other.pid}"
    part.mkdir()
    other.kill()
    os.waitid(os.P_PID, other.pid, os.WEXITED | os.WNOWAIT)
    recover(tmp_path / "x")
    other.wait()
    assert not part.exists()
