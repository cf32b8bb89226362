"""A folder is one process's, and no longer than that process lives."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from vcage.base.errors import FolderInUse
from vcage.base.hold import IN_USE, alone, held, holder_of

HOLDER = """
import signal, sys, time
from pathlib import Path
from vcage.base.commands import CALLED
from vcage.base.hold import held
from vcage.base.workers import Processes

if __name__ == "__main__":
    signal.signal(signal.SIGHUP, signal.SIG_DFL)  # under nohup it is ignored
    CALLED.set("vcage collect --run 'a  run'")
    with held(Path(sys.argv[1])), Processes(time.sleep, 2) as crew:
        crew.submit(100)  # a worker must not keep what its parent held
        print("at work", flush=True)
        time.sleep(100)
"""


@pytest.fixture
def holder(tmp_path: Path):
    (tmp_path / "holder.py").write_text(HOLDER)
    program = [sys.executable, str(tmp_path / "holder.py"), str(tmp_path)]
    with subprocess.Popen(program, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None and process.stdout.readline() == "at work\n"
        yield process
        process.kill()


def test_the_second_process_learns_the_running_command_and_may_retry(holder, tmp_path: Path):
    with pytest.raises(FolderInUse, match="vcage collect --run 'a  run'") as refused, held(tmp_path):
        pass
    assert f"process {holder.pid} on " in refused.value.message
    assert (refused.value.exit_code, refused.value.retryable) == (6, True)
    assert str(holder.pid) in (tmp_path / IN_USE).read_text()


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGHUP])
def test_a_folder_is_free_as_soon_as_its_holder_was_killed(holder, tmp_path: Path, number: int):
    holder.send_signal(number)
    holder.wait(timeout=60)
    with held(tmp_path):
        pass
    assert not (tmp_path / IN_USE).exists()


def test_a_file_is_held_by_one_process_and_stays_afterwards(tmp_path: Path):
    path = tmp_path / "job.beat"
    said = f"{path.name} is in use by process {os.getpid()} on "
    with alone(path), pytest.raises(FolderInUse, match=said), alone(path):
        pass
    with alone(path):
        pass
    assert path.exists()


@contextmanager
def looked_at(path: Path, watchers: int = 3) -> Iterator[None]:
    """Threads that ask all the time who holds a file."""
    ended = threading.Event()

    def look() -> None:
        while not ended.is_set():
            holder_of(path)

    threads = [threading.Thread(target=look) for _ in range(watchers)]
    for thread in threads:
        thread.start()
    try:
        yield
    finally:
        ended.set()
        for thread in threads:
            thread.join()


def test_to_look_who_holds_a_file_refuses_it_to_nobody(tmp_path: Path):
    path = tmp_path / "job.beat"
    with looked_at(path):
        for _ in range(100):
            with alone(path):
                pass


def test_a_file_that_is_held_is_refused_at_once_while_others_look(tmp_path: Path):
    path = tmp_path / "job.beat"
    with alone(path), looked_at(path):
        for _ in range(50):
            assert holder_of(path) is not None
            with pytest.raises(FolderInUse), alone(path):
                pass
