"""Free memory by the system and the control groups, and the largest of a process."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from vcage.base import memory

KB = 1024


@pytest.fixture
def machine(tmp_path, monkeypatch) -> Path:
    """A machine with 1000 kB left and no control groups."""
    for name in ("MEMINFO", "OWN_GROUPS", "GROUPS"):
        monkeypatch.setattr(memory, name, tmp_path / name)
    (tmp_path / "MEMINFO").write_text("MemTotal: 4000 kB\nMemFree:   10 kB\nMemAvailable:   1000 kB\n")
    return tmp_path


def group(folder: Path, limit: str, used: int, cached: int, *, version: int = 2) -> None:
    names = ("memory.max", "memory.current") if version == 2 else ("memory.limit_in_bytes", "memory.usage_in_bytes")
    folder.mkdir(parents=True, exist_ok=True)
    (folder / names[0]).write_text(f"{limit}\n")
    (folder / names[1]).write_text(f"{used}\n")
    prefix = "" if version == 2 else "inactive_file 0\ntotal_"
    (folder / "memory.stat").write_text(f"anon 5\n{prefix}inactive_file {cached}\n")


def test_the_page_cache_counts_as_free(machine):
    assert memory.free_memory() == 1000 * KB


def test_the_narrowest_control_group_limits(machine):
    (machine / "OWN_GROUPS").write_text("0::/outer/inner\n")
    group(machine / "GROUPS/outer", str(500 * KB), used=300 * KB, cached=100 * KB)
    group(machine / "GROUPS/outer/inner", "max", used=300 * KB, cached=0)
    assert memory.free_memory() == 300 * KB


def test_a_group_of_the_first_version_limits_as_well(machine):
    (machine / "OWN_GROUPS").write_text("5:devices:/\n4:memory:/elsewhere\n0::/\n")
    group(machine / "GROUPS/memory", str(400 * KB), used=300 * KB, cached=50 * KB, version=1)
    assert memory.free_memory() == 150 * KB


def test_a_group_that_took_more_than_its_limit_leaves_nothing(machine):
    (machine / "OWN_GROUPS").write_text("0::/\n")
    group(machine / "GROUPS", str(100 * KB), used=300 * KB, cached=0)
    assert memory.free_memory() == 0


def test_a_remembered_answer_is_asked_once_until_forgotten():
    asked = []
    double = memory.remembered(8)(lambda number: asked.append(number) or 2 * number)
    assert [double(1), double(1)] == [2, 2] and asked == [1]
    memory.forget()
    assert double(1) == 2 and asked == [1, 1]


def test_the_largest_memory_counts_what_was_let_go_of_and_can_begin_anew():
    memory.measure_memory_anew()
    before = memory.largest_memory()
    block = bytearray(200_000_000)
    block[::4096] = b"x" * len(block[::4096])
    del block
    assert memory.largest_memory() > before + 150_000_000
    memory.measure_memory_anew()
    assert memory.largest_memory() < before + 100_000_000


def test_without_figures_of_the_process_its_lifetime_counts(machine, monkeypatch):
    for name in ("OWN_STATUS", "OWN_PEAK"):
        monkeypatch.setattr(memory, name, machine / "missing" / name)
    memory.measure_memory_anew()
    assert memory.largest_memory() > 1_000_000


@pytest.mark.parametrize("reuse", [False, True])
def test_freed_memory_is_used_again(reuse):
    code = f"""
import resource
import numpy as np
from vcage.base.memory import reuse_freed_memory

def faults():
    for _ in range(10):
        held = [np.ones(2**20) for _ in range(3)]
        del held
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt

if {reuse}:
    reuse_freed_memory()
print(-faults() + faults())
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert (int(done.stdout) < 3 * 2048) == reuse  # pages of one turn


def test_the_values_used_last_are_kept_up_to_a_number_of_bytes():
    recent, made = memory.Recent[str, str](most_bytes=8), []

    def value_of(key: str) -> str:
        return recent.get(key, lambda: made.append(key) or key, len)

    assert [value_of(key) for key in ("aaaa", "bbbb", "aaaa", "cccc", "aaaa", "bbbb")] == [
        *("aaaa", "bbbb", "aaaa", "cccc", "aaaa", "bbbb")
    ]
    assert made == ["aaaa", "bbbb", "cccc", "bbbb"]
