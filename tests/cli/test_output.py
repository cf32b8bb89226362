"""What a command prints and how it exits."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from vcage.base.errors import ModelRefused
from vcage.cli.output import Result, run_cli


def last_line(text: str) -> Any:
    return json.loads(text.splitlines()[-1])


def raising(error: BaseException) -> Any:
    def function() -> None:
        raise error

    return function


def test_success_is_one_json_line_after_the_text(capsys: pytest.CaptureFixture[str]) -> None:
    result = Result(output=Path("a/b.json"), schema="x/1", summary={"n": 1}, next="go on", text="two\nlines")
    assert run_cli(lambda: result) == 0
    out, err = capsys.readouterr()
    assert out.splitlines()[:2] == ["two", "lines"]
    assert last_line(out) == {"ok": True, "schema": "x/1", "output": "a/b.json", "summary": {"n": 1}, "next": "go on"}
    assert err == ""


def test_an_error_of_ours_gives_its_code_one_line_and_the_record(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_cli(raising(ModelRefused("the model\nrefused", hint="reword"))) == 5
    out, err = capsys.readouterr()
    assert err == "vcage: error: the model refused (reword)\n"
    error = last_line(out)["error"]
    assert (error["code"], error["hint"], error["retryable"]) == ("model_refused", "reword", False)


def test_a_failed_finding_keeps_its_text(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_cli(lambda: Result(text="a table", error=ModelRefused("no"))) == 5
    out, _ = capsys.readouterr()
    assert out.startswith("a table\n")
    assert last_line(out)["ok"] is False


def test_an_unexpected_exception_is_called_a_bug_with_its_traceback(
    capsys: pytest.CaptureFixture[str], caplog: pytest.LogCaptureFixture
) -> None:
    assert run_cli(raising(ZeroDivisionError("oops"))) == 1
    out, _ = capsys.readouterr()
    assert last_line(out)["error"]["code"] == "bug"
    assert "Traceback" in caplog.text


def test_ctrl_c_is_reported_as_an_interruption(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_cli(raising(KeyboardInterrupt())) == 130
    out, _ = capsys.readouterr()
    assert last_line(out)["error"]["retryable"] is True


def test_a_full_disk_is_partly_done_not_a_bug(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_cli(raising(OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)))) == 7
    out, _ = capsys.readouterr()
    assert last_line(out)["error"]["code"] == "disk_full"


STRAY = """
import os, sys
from vcage.cli.output import Result, run_cli
from vcage.cli.streams import stray_output_on_stderr
def work():
    with stray_output_on_stderr():
        print("from python")
        os.write(1, b"from a library\\n")
        import ctypes
        ctypes.CDLL(None).printf(b"from C, still in a buffer\\n")
    return Result(summary={"lines": int(sys.argv[1])}, text="x\\n" * int(sys.argv[1]))
sys.exit(run_cli(work))
"""


def test_prints_of_libraries_go_to_stderr() -> None:
    done = subprocess.run([sys.executable, "-c", STRAY, "0"], capture_output=True, text=True)
    assert done.returncode == 0
    assert len(done.stdout.splitlines()) == 1 and last_line(done.stdout)["ok"]
    for text in ("from python", "from a library", "from C"):
        assert text in done.stderr


def test_a_reader_that_goes_away_is_no_error() -> None:
    command = f"'{sys.executable}' -c '{STRAY}' 100000 2>err | head -n 1; echo ${{PIPESTATUS[0]}}; cat err; rm err"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True)
    assert done.stdout.splitlines()[:2] == ["x", "0"]
    assert "BrokenPipe" not in done.stdout


INTERRUPTED = """
import os, signal, sys
number = signal.Signals[sys.argv[1]]
from vcage.cli.process import end_process
from vcage.cli.output import run_cli
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job inherits that it is ignored
class Fragile:
    def __del__(self):
        os.abort()
def work():
    fragile = Fragile()
    try:
        os.kill(os.getpid(), number)
    except KeyboardInterrupt as error:
        if len(sys.argv) > 2:
            raise ImportError("made of it by a library") from error
        raise
sys.exit(end_process(run_cli(work)))
"""


@pytest.mark.parametrize("how", [["SIGINT"], ["SIGINT", "import-error"], ["SIGTERM"]])
def test_an_interruption_ends_the_process_before_teardown(how: list[str]) -> None:
    done = subprocess.run([sys.executable, "-c", INTERRUPTED, *how], capture_output=True, text=True)
    assert done.returncode == 130
    assert last_line(done.stdout)["error"]["code"] == "interrupted"


def test_too_long_a_name_is_no_bug(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_cli(raising(OSError(errno.ENAMETOOLONG, os.strerror(errno.ENAMETOOLONG), "n" * 300))) == 2
    out, _ = capsys.readouterr()
    assert last_line(out)["error"]["code"] == "output_not_writable"
