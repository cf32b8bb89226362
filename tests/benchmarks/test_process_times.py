"""Commands of the benchmarks are timed with every process below them."""

from __future__ import annotations

import sys

from benchmarks._process_times import timed

BURN = "import time\nwhile time.process_time() < 0.4: pass\n"


def test_a_process_that_outlives_its_parent_is_counted() -> None:
    orphan = f"import os\nif os.fork() == 0:\n    os.setsid()\n    exec({BURN!r})\n    os._exit(0)\nprint('ended')"
    done = timed([sys.executable, "-c", orphan])
    assert (done.code, done.stdout) == (0, "ended\n")
    assert done.cpu_s > 0.35


def test_a_line_on_stderr_marks_the_seconds_until_then_those_of_ended_children_too() -> None:
    child = f"import subprocess, sys\nsubprocess.run([sys.executable, '-c', {BURN!r}])\nprint('half', file=sys.stderr)"
    done = timed([sys.executable, "-c", f"{child}\n{BURN}"])
    (half,) = done.marks
    assert half.line == "half"
    assert 0.35 < half.cpu_s < done.cpu_s - 0.35
