"""Work in processes of its own: whole results, whole errors, and no process left, however it ends."""

from __future__ import annotations

import logging
import multiprocessing
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest
from threadpoolctl import threadpool_info

from vcage.base.errors import DamagedFile, PartlyDone
from vcage.base.workers import Processes, cores, map_in_processes, one_blas_thread

WAIT = 20.0
"""Seconds after which a process that should have ended counts as left behind."""


def double(number: int) -> tuple[int, int]:
    return 2 * number, os.getpid()


def refuse_two(number: int) -> int:
    if number == 2:
        raise DamagedFile("two.hdf5 is damaged", hint="leave it out", details={"recording": "two"})
    time.sleep(0.01 if number < 2 else 60)
    return number


def vanish(_task: int) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def nothing_left() -> bool:
    """True if all processes that this one started end by themselves."""
    return _before_long(lambda: not multiprocessing.active_children())


def _before_long(happens) -> bool:
    end = time.monotonic() + WAIT
    while not happens() and time.monotonic() < end:
        time.sleep(0.05)
    return happens()


def test_one_worker_is_this_process_and_keeps_the_order():
    assert list(map_in_processes(double, [3, 1, 2], 1)) == [(6, os.getpid()), (2, os.getpid()), (4, os.getpid())]


def test_one_task_needs_no_process_of_its_own():
    assert list(map_in_processes(double, [4], 8)) == [(8, os.getpid())]


def test_no_task_gives_nothing():
    assert list(map_in_processes(double, [], 4)) == []


def test_several_workers_are_other_processes_and_give_every_result():
    found = list(map_in_processes(double, range(6), 2))
    assert sorted(result for result, _ in found) == [0, 2, 4, 6, 8, 10]
    assert os.getpid() not in {process for _, process in found}
    assert nothing_left()


def test_an_error_of_a_task_comes_whole_and_ends_the_others():
    begun = time.monotonic()
    with pytest.raises(DamagedFile) as refused:
        list(map_in_processes(refuse_two, [0, 1, 2, 3], 2))
    assert (refused.value.message, refused.value.hint) == ("two.hdf5 is damaged", "leave it out")
    assert refused.value.details == {"recording": "two"}
    assert nothing_left() and time.monotonic() - begun < 60


def test_a_killed_worker_leaves_its_work_open():
    with pytest.raises(PartlyDone, match="worker process was ended") as partly:
        list(map_in_processes(vanish, [0, 1, 2], 2))
    assert "--workers" in partly.value.hint
    assert nothing_left()


def until_twice(folder: Path) -> str:
    """Is ended from outside the first time."""
    if not (folder / "begun").exists():
        (folder / "begun").touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return "done"


def silent_once(folder: Path) -> str:
    if not (folder / "begun").exists():
        (folder / "begun").touch()
        time.sleep(600)
    return "done"


def answers(work, tasks, workers: int, limit_s: float | None = None) -> list:
    with Processes(work, workers, limit_s) as processes:
        for task in tasks:
            processes.submit(task)
        return list(processes.results())


def test_a_killed_process_loses_only_its_task_which_restarts(tmp_path):
    folders = [tmp_path / name for name in "ab"]
    for folder in folders:
        folder.mkdir()
    assert answers(until_twice, folders, 2) == ["done", "done"]
    assert nothing_left()


@pytest.mark.slow
def test_a_silent_process_is_ended_and_its_task_restarts(tmp_path):
    assert answers(silent_once, [tmp_path], 1, limit_s=3.0) == ["done"]
    assert nothing_left()


def crash_or_double(number: int) -> int:
    if number < 0:
        vanish(number)
    return 2 * number


def test_a_task_that_lost_its_process_may_end_with_a_result_in_place_of_other_tries():
    with Processes(crash_or_double, 2, lost=lambda task, how: f"{task} {how}") as processes:
        for task in (1, -1, 2):
            processes.submit(task)
        assert sorted(map(str, processes.results())) == ["-1 was ended from outside", "2", "4"]
    assert nothing_left()


def test_the_limit_may_depend_on_the_task():
    def seconds_left(task: float, elapsed: float) -> float:
        return 0.5 - elapsed if task > 100 else 60.0

    with Processes(time.sleep, 2, seconds_left, lost=lambda task, how: f"{task:.0f} {how}") as processes:
        processes.submit(1.0)
        processes.submit(600.0)
        assert set(processes.results()) == {None, "600 gave no answer and was ended after 1 s"}
    assert nothing_left()


def test_more_may_be_submitted_while_results_come():
    with Processes(double, 2) as processes:
        processes.submit(1)
        found = []
        for result, _ in processes.results():
            found.append(result)
            if result < 8:
                processes.submit(result)
    assert found == [2, 4, 8]


def say(word: str) -> None:
    logging.getLogger("vcage.elsewhere").warning("it said %s", word)


def test_logs_of_a_process_reach_the_parent(caplog):
    answers(say, ["hello", "there"], 2)
    assert sorted(record.getMessage() for record in caplog.records) == ["it said hello", "it said there"]
    assert {record.name for record in caplog.records} == {"vcage.elsewhere"}


def environment_of(_task: int) -> str | None:
    return os.environ.get("VCAGE_OF_THIS_TEST")


def test_a_process_has_the_environment_that_this_one_has_when_it_begins(monkeypatch):
    assert answers(environment_of, [0], 1) == [None]
    monkeypatch.setenv("VCAGE_OF_THIS_TEST", "set later")
    assert answers(environment_of, [0], 1) == ["set later"]


def forked_from(_task: int) -> int:
    return os.getppid()


@pytest.mark.slow
def test_processes_start_again_after_the_fork_server_was_killed():
    [server] = answers(forked_from, [0], 1)
    assert server != os.getpid()
    os.kill(server, signal.SIGKILL)
    assert _before_long(lambda: psutil.Process(server).status() == psutil.STATUS_ZOMBIE)
    assert answers(forked_from, [0], 1) not in ([server], [os.getpid()])


LOADED_AHEAD = """
from vcage.base.workers import Processes, preload_module
preload_module("colorsys")
LOADED = "'colorsys' in __import__('sys').modules"
with Processes(eval, 1) as processes:
    processes.submit(LOADED)
    print(*processes.results(), eval(LOADED))
"""


@pytest.mark.skipif(cores() == 1, reason="nothing is loaded ahead on one core")
def test_preloaded_modules_exist_in_workers_only():
    done = subprocess.run([sys.executable, "-c", LOADED_AHEAD], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("True False\n", "")


FORKED_FROM_A_COMMAND = '''
import os, signal
from vcage.base import own_process
from vcage.base.workers import Processes, preload_module
own_process.runs_a_command = True
kept = open(os.__file__)
os.environ["VCAGE_TEST"] = "of the command"
signal.signal(signal.SIGTERM, lambda *_: None)
preload_module("colorsys")
SAID = """[(sys := __import__('sys')) and 'colorsys' in sys.modules, (os := __import__('os')).environ.get('VCAGE_TEST'),
    'PYTHONSAFEPATH' in os.environ, os.__file__ in [os.readlink(f'/proc/self/fd/{fd}') for fd in range(3, 9)
    if os.path.exists(f'/proc/self/fd/{fd}')], __import__('signal').getsignal(15).name,
    open('/proc/%d/stat' % os.getppid()).read().split()[3]]"""
with Processes(eval, 1) as processes:
    processes.submit(SAID)
    *facts, parent = next(processes.results())
    print(*facts, int(parent) == os.getpid(), 'colorsys' in __import__('sys').modules)
'''


@pytest.mark.skipif(cores() == 1, reason="nothing is loaded ahead on one core")
def test_processes_of_a_command_have_its_imports_but_neither_its_files_nor_its_signals():
    done = subprocess.run([sys.executable, "-c", FORKED_FROM_A_COMMAND], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("True of the command False False SIG_DFL True True\n", "")


@pytest.mark.skipif(cores() == 1, reason="nothing is loaded ahead on one core")
def test_modules_in_the_current_folder_do_not_shadow_preloaded_ones(tmp_path):
    (tmp_path / "colorsys.py").write_text("raise RuntimeError('another one')")
    done = subprocess.run([sys.executable, "-c", LOADED_AHEAD], capture_output=True, text=True, cwd=tmp_path)
    assert (done.stdout, done.stderr) == ("True False\n", "")


INTERRUPTED = """
import os, signal, time
from vcage.base.worker_process import remove_server_files
from vcage.base.workers import preload_module
signal.signal(signal.SIGINT, lambda *_: None)
preload_module("slow")
time.sleep(0.5)
os.killpg(0, signal.SIGINT)
time.sleep(0.5)
remove_server_files()
os._exit(0)
"""


@pytest.mark.skipif(cores() == 1, reason="nothing is loaded ahead on one core")
def test_ctrl_c_while_something_is_loaded_ahead_leaves_no_trace(tmp_path):
    (tmp_path / "slow.py").write_text("import time; time.sleep(1)")
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    done = subprocess.run(
        [sys.executable, "-c", INTERRUPTED],
        capture_output=True,
        text=True,
        env=os.environ | {"PYTHONPATH": str(tmp_path), "TMPDIR": str(temporary)},
        start_new_session=True,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert not list(temporary.iterdir())


def test_processes_begin_by_themselves_where_temporary_files_lie_too_deep_for_a_socket(tmp_path):
    deep = tmp_path / ("deep" * 30)
    deep.mkdir()
    environment = os.environ | {"TMPDIR": str(deep)}
    done = subprocess.run([sys.executable, "-c", LOADED_AHEAD], capture_output=True, text=True, env=environment)
    assert (done.stdout, done.stderr) == ("False False\n", "")


def give_what_cannot_be_sent(_task: int):
    return lambda: None


def test_a_result_that_cannot_be_sent_is_an_error_that_says_so():
    with pytest.raises(TypeError, match="cannot be sent between processes"):
        answers(give_what_cannot_be_sent, [0], 1)


def test_a_parent_that_exits_leaves_no_process():
    results = map_in_processes(refuse_two, [0, 1, 3, 4], 2)
    next(results)
    results.close()
    assert nothing_left()


def test_there_is_at_least_one_core():
    assert cores() >= 1


def test_every_blas_has_one_thread_inside_and_its_own_number_again_after():
    def threads() -> list[int]:
        return [library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"]

    before = threads()
    with one_blas_thread():
        assert set(threads()) == {1}
    assert threads() == before


# --- when the process that started them ends -----------------------------------------------------------

PARENT = """
import signal, time
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job inherits that it is ignored
from vcage.base.workers import map_in_processes
for _ in map_in_processes(time.sleep, [0, 0, 600, 600], 2):
    print("working", flush=True)
"""


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_workers_end_with_the_process_that_started_them(number):
    with subprocess.Popen([sys.executable, "-c", PARENT], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as parent:
        assert parent.stdout is not None
        assert [parent.stdout.readline() for _ in range(2)] == [b"working\n"] * 2
        children = psutil.Process(parent.pid).children(recursive=True)
        assert len(children) >= 2
        parent.send_signal(number)
        assert parent.wait(WAIT) != 0
    assert not psutil.wait_procs(children, WAIT)[1]


# --- what a worker knows of its parent process --------------------------------------------------------

SETS_A_VARIABLE = "import os; os.environ['OF_AN_IMPORT'] = 'set'"

ENVIRONMENT_AFTER_IMPORT = """
import os
from vcage.base.workers import Processes, preload_module
os.environ["LEFT_OUT_LATER"] = os.environ["CHANGED_LATER"] = "before"
preload_module("sets_a_variable")
del os.environ["LEFT_OUT_LATER"]
os.environ["CHANGED_LATER"] = "after"
with Processes(eval, 1) as processes:
    for name in ("OF_AN_IMPORT", "LEFT_OUT_LATER", "CHANGED_LATER", "PYTHONSAFEPATH"):
        processes.submit(f"__import__('os').environ.get('{name}')")
    print(*processes.results(), os.environ.get("OF_AN_IMPORT"))
"""


@pytest.mark.skipif(cores() == 1, reason="nothing is loaded ahead on one core")
def test_environment_changes_of_an_import_stay_in_its_process(tmp_path):
    (tmp_path / "sets_a_variable.py").write_text(SETS_A_VARIABLE)
    done = subprocess.run(
        [sys.executable, "-c", ENVIRONMENT_AFTER_IMPORT],
        capture_output=True,
        text=True,
        env=os.environ | {"PYTHONPATH": str(tmp_path)},
    )
    assert (done.stdout, done.stderr) == ("set None after None None\n", "")


BARE_SCRIPT = """
import math, os
from vcage.base.errors import UsageError
from vcage.base.workers import map_in_processes
print("begun")
print(sorted(map_in_processes(math.factorial, [3, 4], 2)))

class Mine(int):
    pass

try:
    list(map_in_processes(math.factorial, [Mine(3), Mine(4)], 2))
except UsageError as error:
    print(error.as_line())
"""


@pytest.mark.parametrize("deep", [False, True], ids=["forked", "spawned"])
@pytest.mark.parametrize("way", ["file", "stdin", "module"])
def test_a_script_needs_no_main_guard_and_its_own_functions_are_refused_by_name(tmp_path, way, deep):
    script = tmp_path / "bare_script.py"
    script.write_text(BARE_SCRIPT)
    temporary = tmp_path / ("deep" * 30 if deep else "t")
    temporary.mkdir()
    done = subprocess.run(
        [sys.executable, *{"file": [str(script)], "stdin": ["-"], "module": ["-m", "bare_script"]}[way]],
        input=BARE_SCRIPT if way == "stdin" else None,
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env=os.environ | {"TMPDIR": str(temporary)},
    )
    begun, results, refused = done.stdout.splitlines()
    assert (begun, results, done.stderr) == ("begun", "[6, 24]", "")
    assert "'Mine'" in refused and "in a module" in refused


# --- after a worker was killed -------------------------------------------------------------------------

KILLED = """
import os, signal
from vcage.base.workers import map_in_processes
list(map_in_processes(abs, [1, 2], 2))
print("begun", flush=True)
signal.pause()
"""


def test_the_folder_of_a_killed_process_is_removed_by_the_next_and_that_of_a_living_one_is_not(tmp_path):
    environment = os.environ | {"TMPDIR": str(tmp_path)}
    (tmp_path / "pymp-of-others").mkdir()

    def begun() -> subprocess.Popen:
        process = subprocess.Popen([sys.executable, "-c", KILLED], stdout=subprocess.PIPE, text=True, env=environment)
        assert process.stdout is not None and process.stdout.readline() == "begun\n"
        return process

    with begun() as killed:
        killed.kill()
    (left,) = set(tmp_path.iterdir()) - {tmp_path / "pymp-of-others"}
    with begun() as first, begun() as second:
        names = {path.name for path in tmp_path.iterdir()}
        for process in (first, second):
            process.terminate()
    assert len(names) == 3 and "pymp-of-others" in names and left.name not in names
