"""Start processes: forked from one with the needed imports, without this program's script."""

from __future__ import annotations

import multiprocessing
import os
import shutil
import signal
import sys
import threading
from functools import cache
from multiprocessing import forkserver, resource_tracker, spawn
from multiprocessing.context import ForkServerContext, SpawnContext
from multiprocessing.process import BaseProcess
from multiprocessing.util import get_temp_dir
from pathlib import Path
from typing import Any

from vcage.base.leftovers import mark_scratch, sweep_scratch

SAFE_PATH = "PYTHONSAFEPATH"
"""Python's switch: nothing is imported from the current folder."""

UNTOLD = "ignore:resource_tracker:UserWarning"
"""Hides a warning: Python's resource tracker reports what it removes after a process was killed."""


_preloaded: list[str] = []
"""Modules that the process imports from which others are forked."""


def preload(module: str) -> None:
    """Let the process that others are forked from import a module; to be called before any is begun."""
    _preloaded.append(module)
    process_context()


@cache
def process_context() -> SpawnContext | ForkServerContext:
    """Return the way to begin processes: forked from one that never works.

    A child of this process would lack the threads of its renderer. Where there can be no socket, as when the path in
    ``TMPDIR`` is too long, each process is spawned.
    """
    sweep_scratch()
    multiprocessing.set_forkserver_preload(_preloaded)  # Python's default is the script that runs
    sys.warnoptions.append(UNTOLD)
    resource_tracker.ensure_running()  # which would let Ctrl-C through again
    sys.warnoptions.remove(UNTOLD)
    through = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # Ctrl-C is this process's business
    safe = os.environ.get(SAFE_PATH)
    os.environ[SAFE_PATH] = safe or "1"  # else it would import what lies in the current folder
    try:
        mark_scratch(Path(get_temp_dir()))  # in which its socket lies
        forkserver.ensure_running()
    except OSError:
        return multiprocessing.get_context("spawn")
    finally:
        if safe is None:
            del os.environ[SAFE_PATH]
        signal.pthread_sigmask(signal.SIG_SETMASK, through)
    return multiprocessing.get_context("forkserver")


def remove_server_files() -> None:
    """Remove what a process that is about to end by ``os._exit`` would leave of the one that others are forked from."""
    if process_context.cache_info().currsize:
        shutil.rmtree(get_temp_dir(), ignore_errors=True)


_starting = threading.Lock()


def start(process: BaseProcess) -> None:
    """Start a process that does not run this program's script, as Python's own do to find what the script defines: so a
    script needs no ``if __name__ == "__main__"``."""
    with _starting:
        usual = spawn.get_preparation_data

        def without_script(name: str) -> dict[str, Any]:
            return {
                key: value
                for key, value in usual(name).items()
                if name != process.name or not key.startswith("init_main")
            }

        spawn.get_preparation_data = without_script
        try:
            process.start()
        finally:
            spawn.get_preparation_data = usual
