"""A data set that grows is whole at any moment, and its old files are neither read nor written again."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.datasets.conftest import ENCODINGS, add, write
from tests.datasets.lerobot.conftest import contents
from vcage.base.errors import DamagedFile, OutputFolderError, UnknownName, UsageError
from vcage.datasets.lerobot import growing
from vcage.datasets.lerobot.growing import ADDING, COMMITTED, SIZES, SOURCES, GrowingSet
from vcage.datasets.recordings.opening import open_recordings


class Killed(BaseException):
    """Stands for the end of the process."""


def splits(root: Path) -> dict[str, str]:
    return json.loads((root / "meta/info.json").read_text())["splits"]


def test_episodes_are_part_of_the_data_set_once_they_are_committed(version, begun, episodes):
    before = contents(begun)
    with GrowingSet(version, begun) as data_set:
        data_set.add(episodes[0], ENCODINGS)
        assert (data_set.pending, data_set.episodes) == (1, 3)
        assert {name: data for name, data in contents(begun).items() if not name.startswith(ADDING)} == before
        data_set.commit()
        data_set.commit()
        data_set.add(episodes[1], ENCODINGS)
    assert len(open_recordings(begun)) == 3
    assert not [path for path in begun.iterdir() if path.name.startswith(".")]


def test_one_commit_gives_the_episodes_of_many(version, begun, episodes, tmp_path):
    for _ in range(2):
        add(version, begun, episodes)
    once = add(version, write(version, tmp_path / "once", episodes), [*episodes, *episodes])
    assert json.loads((begun / "meta/info.json").read_text()) == json.loads((once / "meta/info.json").read_text())
    assert [one.state.tolist() for one in open_recordings(begun)] == [
        one.state.tolist() for one in open_recordings(once)
    ]


def kill_at(monkeypatch: pytest.MonkeyPatch, calls: int, name: str, module: Any) -> Callable[[], bool]:
    """Let the n-th call of a function end the process; the answer says whether it came to that."""
    original, count = getattr(module, name), 0

    def counted(*arguments: Any, **options: Any) -> Any:
        nonlocal count
        count += 1
        if count == calls:
            raise Killed
        return original(*arguments, **options)

    monkeypatch.setattr(module, name, counted)
    return lambda: count >= calls


@pytest.mark.slow
@pytest.mark.parametrize(("function", "module"), [("replace", os), ("_add_lines", growing), ("rmtree", shutil)])
def test_a_commit_that_is_killed_at_any_step_is_ended_or_undone(
    version, begun, episodes, tmp_path, monkeypatch, function, module
):
    before, after = contents(begun), contents(add(version, shutil.copytree(begun, tmp_path / "after"), episodes))
    reached, calls = True, 0
    while reached:
        calls += 1
        root = shutil.copytree(begun, tmp_path / f"killed-{calls}")
        with monkeypatch.context() as patched:
            was_reached = kill_at(patched, calls, function, module)
            try:
                data_set = GrowingSet(version, root)
                for one in episodes:
                    data_set.add(one, ENCODINGS)
                data_set.commit()
            except Killed:
                pass
            reached = was_reached()
        GrowingSet(version, root)
        assert contents(root) in (before, after), calls
        assert not [path for path in root.iterdir() if path.name.startswith(".")]
    assert calls > 1 or function == "_add_lines"


def test_lines_that_a_killed_process_added_are_not_there_twice(v21, episodes, tmp_path, monkeypatch):
    root = shutil.copytree(v21, tmp_path / "set")
    original = growing._add_lines

    def killed_after(*arguments: Any) -> None:
        original(*arguments)
        raise Killed

    with monkeypatch.context() as patched, pytest.raises(Killed):
        patched.setattr(growing, "_add_lines", killed_after)
        add("lerobot-v2.1", root, episodes[:1])
    assert (root / COMMITTED / SIZES).is_file()
    GrowingSet("lerobot-v2.1", root)
    assert len((root / "meta/episodes.jsonl").read_text().splitlines()) == 3
    assert len(open_recordings(root)) == 3


def test_old_files_are_neither_written_nor_replaced(version, begun, episodes):
    old = {path: path.stat() for path in begun.rglob("*") if path.suffix == ".mp4" or path.parts[-3] == "data"}
    add(version, begun, episodes)
    assert {path: (path.stat().st_ino, path.stat().st_mtime_ns) for path in old} == {
        path: (stat.st_ino, stat.st_mtime_ns) for path, stat in old.items()
    }


def test_where_each_episode_comes_from_is_kept(version, begun, episodes):
    with GrowingSet(version, begun) as data_set:
        data_set.add(episodes[0], ENCODINGS, {"run": "a"})
        data_set.commit()
        data_set.add(episodes[1], ENCODINGS, {"run": "b"})
        data_set.commit()
        assert list(data_set.sources()) == [{"episode_index": 2, "run": "a"}, {"episode_index": 3, "run": "b"}]


def test_a_refused_episode_is_no_source(version, begun, episodes):
    with GrowingSet(version, begun) as data_set:
        with pytest.raises(UsageError, match="other robot"):
            data_set.add(replace(episodes[0], robot="aloha"), ENCODINGS, {"run": "a"})
        data_set.add(episodes[0], ENCODINGS, {"run": "b"})
        data_set.commit()
    assert json.loads((begun / SOURCES).read_text()) == {"episode_index": 2, "run": "b"}


def test_a_new_split_begins_where_the_last_one_ends(version, begun, episodes):
    for split in ("test", "test"):
        with GrowingSet(version, begun, split) as data_set:
            data_set.add(episodes[0], ENCODINGS)
            data_set.commit()
    assert splits(begun) == {"train": "0:2", "test": "2:4"}
    with GrowingSet(version, begun) as data_set, pytest.raises(UsageError, match="its splits is"):
        data_set.add(episodes[0], ENCODINGS)
    assert splits(begun) == {"train": "0:2", "test": "2:4"}


def test_a_new_data_set_may_begin_with_any_split(version, episodes, tmp_path):
    with GrowingSet(version, tmp_path / "set", "test") as data_set:
        data_set.add(episodes[0], ENCODINGS)
        data_set.commit()
    assert splits(tmp_path / "set") == {"test": "0:1"}


def test_a_folder_of_something_else_is_in_the_way(version, tmp_path):
    (tmp_path / "photos").mkdir()
    (tmp_path / "photos/cat.png").touch()
    with pytest.raises(OutputFolderError, match="in the way"):
        GrowingSet(version, tmp_path / "photos")


def test_an_unknown_format_is_refused(tmp_path):
    with pytest.raises(UnknownName):
        GrowingSet("lerobot-v9", tmp_path)


def test_a_commit_of_unknown_sizes_is_named(version, begun):
    (begun / COMMITTED).mkdir()
    (begun / COMMITTED / SIZES).write_text("[]")
    with pytest.raises(DamagedFile, match=r"sizes\.json"):
        GrowingSet(version, begun)
