"""What a command owes its caller: diagnostics on stderr, results on stdout, and one JSON object as the last line.

Success: ``{"ok": true, "schema": …, "output": …, "summary": {…}, "next": …}``.
Failure: ``{"ok": false, "error": {"code", "message", "hint", "retryable", "details"}, "next": …}``, and one line on
stderr.
"""

from __future__ import annotations

import contextlib
import errno
import gc
import logging
import os
import signal
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType
from typing import Any, ParamSpec

from vcage.base.commands import CALLED, vcage_command
from vcage.base.errors import (
    ConfigurationError,
    DiskFull,
    MissingDependency,
    OutputFolderError,
    PartlyDone,
    StaleStage,
    VcageError,
)
from vcage.base.files import NO_ROOM, RunFolder
from vcage.cli.process import LIMITS, folder_is_gone, removed_folder
from vcage.cli.streams import complain, print_record, print_text

logger = logging.getLogger(__name__)

P = ParamSpec("P")

INTERRUPTED = 130
"""Exit code after Ctrl-C, as shells have it (128 + SIGINT)."""


@dataclass(frozen=True)
class Result:
    """What a command did.

    Args:
        output: the file or folder that it wrote.
        summary: a few facts for the caller, JSON-serialisable.
        schema: id of the schema of ``output``.
        next: the command that goes on from here, also after an error.
        text: what a person reads, printed before the JSON line.
        error: set when the command did its work and the finding is a failure.
        facts: results that stand at the top of the JSON line, beside ``ok``, in either case.
    """

    output: Path | None = None
    summary: dict[str, Any] = field(default_factory=dict)
    schema: str = ""
    next: str = ""
    text: str = ""
    error: VcageError | None = None
    facts: dict[str, Any] = field(default_factory=dict)

    def as_record(self) -> dict[str, Any]:
        """The object of the last line of stdout."""
        if self.error is not None:
            goes_on = self.next or _goes_on(self.error) or None
            return {**self.facts, "ok": False, "error": self.error.as_record(), "next": goes_on}
        return {
            **self.facts,
            "ok": True,
            "schema": self.schema or None,
            "output": str(self.output) if self.output is not None else None,
            "summary": self.summary,
            "next": self.next or None,
        }


def _goes_on(error: VcageError) -> str:
    """The command that mends an error, or the same again where that may help."""
    return error.command or (CALLED.get() if error.retryable else "")


def run_cli(function: Callable[P, Result | None], *arguments: P.args, **options: P.kwargs) -> int:
    """Run a command and report on it.

    Args:
        function: does the work; None means that nothing is to be reported (``--help``).
        arguments, options: its own.

    Returns:
        The exit code for ``sys.exit``.
    """
    try:
        with _noting_interrupts():
            result = function(*arguments, **options)
    except VcageError as error:
        return _report_error(error)
    except KeyboardInterrupt as error:
        return _report_interruption(error)
    except Exception as error:
        if _interrupted.is_set():
            return _report_interruption(error)
        known = _of_the_machine(error)
        return _report_error(known) if known else _report_bug(error)
    if result is None:
        return 0
    if result.error is not None:
        return _report(result.as_record(), result.error.exit_code, result.error.as_line(), text=result.text)
    return _report(result.as_record(), 0, text=result.text)


@contextlib.contextmanager
def naming_stages(run: Path | None) -> Iterator[None]:
    """An error inside that a stage of the run mends tells the command of that stage."""
    try:
        yield
    except VcageError as error:
        if isinstance(error, StaleStage) and not error.maker:
            called = CALLED.get()
            error.offer(f"replace it: {called if '--force' in called.split() else f'{called} --force'}")
        elif error.maker and not error.command and run is not None:
            from vcage.cli.going_on import name_stage  # imported late: `vcage setup` works where no stage does

            name_stage(error, RunFolder(run))
        raise


def _of_the_machine(error: Exception) -> VcageError | None:
    """Translate an error of the system or of a package of others for the user; None for a bug."""
    if isinstance(error, MemoryError):
        return PartlyDone("not enough memory", hint="free some, or run the same command again with fewer --workers")
    if isinstance(error, RuntimeError) and "home directory" in str(error):
        return ConfigurationError("no home folder is known", hint="set HOME, and name folders without ~")
    if isinstance(error, ImportError):
        return _of_a_package(error)
    if not isinstance(error, OSError):
        return None
    if error.errno in NO_ROOM:
        return DiskFull(f"no space left: {error}", hint="free some space and run the command again")
    if error.errno == errno.ENAMETOOLONG:
        return OutputFolderError(f"too long a name: {error.filename}", hint="give a shorter --out")
    if error.errno in (errno.EMFILE, errno.ENFILE):
        return ConfigurationError(f"too many open files: {error}", hint=f"raise the limit: ulimit -n {LIMITS.wanted}")
    return removed_folder() if folder_is_gone() else None


def _of_a_package(error: ImportError) -> ConfigurationError | None:
    """That a package of others is missing, or does not load; None where it is a module of ours."""
    name = (error.name or "").partition(".")[0]
    if name == "vcage":
        return None
    where = f" ({error.path})" if error.path and error.path not in str(error) else ""
    return MissingDependency(
        f"a Python package cannot be imported: {error}{where}",
        hint="see what is missing",
        command=vcage_command("doctor"),
    )


def _report_error(error: VcageError) -> int:
    return _report(Result(error=error).as_record(), error.exit_code, error.as_line())


_interrupted = threading.Event()
"""Set by Ctrl-C and SIGTERM. Libraries in C that are being imported swallow the exception, or make another of it."""


@contextlib.contextmanager
def _noting_interrupts() -> Iterator[None]:
    """Note Ctrl-C, and what ``kill`` and schedulers send, besides raising :class:`KeyboardInterrupt`."""
    _interrupted.clear()

    def note(number: int, frame: FrameType | None) -> None:
        _interrupted.set()
        signal.default_int_handler(number, frame)

    usual = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL}
    if threading.current_thread() is not threading.main_thread():
        usual = {}
    before = {number: handler for number, handler in usual.items() if signal.getsignal(number) is handler}
    for number in before:
        signal.signal(number, note)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def stop_if_interrupted() -> None:
    """Raise :class:`KeyboardInterrupt` if there was a Ctrl-C that a library has swallowed."""
    if _interrupted.is_set():
        raise KeyboardInterrupt


def end_process(code: int) -> int:
    """The exit code for ``sys.exit``; after Ctrl-C it ends the process at once.

    The simulator's tear-down crashes when it was stopped in the middle of its work.
    """
    if code == INTERRUPTED:
        from vcage.base.process_start import leave_nothing

        leave_nothing()
        logging.shutdown()
        os._exit(code)
    gc.freeze()  # what is loaded need not be looked through once more: a fifth of a second
    return code


_interruptions: list[BaseException] = []
"""Kept until the process ends: to let go of one lets go of what it stopped, which crashes (:func:`end_process`)."""


def _report_interruption(error: BaseException) -> int:
    _interruptions.append(error)
    record = _error_record("interrupted", "interrupted", "run the same command again to go on", retryable=True)
    return _report({**record, "next": CALLED.get() or None}, INTERRUPTED, "interrupted")


def _report_bug(error: Exception) -> int:
    logger.error("this is a bug in vcage", exc_info=error)
    message = " ".join(f"{type(error).__name__}: {error}".split())
    record = _error_record("bug", message, "report it with the traceback on stderr", retryable=False)
    return _report(record, 1, message)


def _error_record(code: str, message: str, hint: str, *, retryable: bool) -> dict[str, Any]:
    return {
        "ok": False,
        "error": {"code": code, "message": message, "hint": hint, "retryable": retryable, "details": {}},
        "next": None,
    }


def _report(record: dict[str, Any], code: int, complaint: str = "", text: str = "") -> int:
    """Say on stderr what went wrong, print text and record; the exit code, that of a full disk where stdout takes
    nothing and nothing else went wrong."""
    if complaint:
        complain(complaint)
    try:
        if text:
            print_text(text)
        print_record(record)
    except OSError as error:
        complain(f"the result cannot be written to stdout: {error.strerror} (run the same command again)")
        return code or DiskFull.exit_code
    return code
