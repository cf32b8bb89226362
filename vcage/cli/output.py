"""The output of a command: diagnostics on stderr, results on stdout, and one JSON object as the last line.

Success: ``{"ok": true, "schema": …, "output": …, "summary": {…}, "next": …}``.
Failure: ``{"ok": false, "error": {"code", "message", "hint", "retryable", "details"}, "next": …}``, and one line on
stderr.
"""

from __future__ import annotations

import errno
import logging
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ParamSpec

from vcage.base.commands import CALLED, vcage_command
from vcage.base.errors import (
    ConfigurationError,
    DiskFull,
    MissingDependency,
    OutputFolderError,
    PartlyDone,
    VcageError,
)
from vcage.base.files import NO_ROOM
from vcage.cli.process import LIMITS, folder_is_gone, interruption, noting_interrupts, removed_folder
from vcage.cli.streams import complain, print_record, print_text

logger = logging.getLogger(__name__)

P = ParamSpec("P")


class Bug(VcageError):
    """An error of ours, or an unexpected one."""

    code = "bug"


@dataclass(frozen=True)
class Result:
    """The result of a command.

    Args:
        output: the file or folder that it wrote.
        summary: a few facts for the caller, JSON-serialisable.
        schema: id of the schema of ``output``.
        next: the command to run next, also after an error.
        text: for a person, printed before the JSON line.
        error: set if the command did its work and the finding is a failure.
        facts: results at the top of the JSON line, beside ``ok``, in either case.
    """

    output: Path | None = None
    summary: dict[str, Any] = field(default_factory=dict)
    schema: str = ""
    next: str = ""
    text: str = ""
    error: VcageError | None = None
    facts: dict[str, Any] = field(default_factory=dict)

    def as_record(self) -> dict[str, Any]:
        """Return the object of the last line of stdout."""
        if self.error is not None:
            same_again = CALLED.get() if self.error.retryable else ""
            goes_on = self.next or self.error.command or same_again or None
            return {**self.facts, "ok": False, "error": self.error.as_record(), "next": goes_on}
        return {
            **self.facts,
            "ok": True,
            "schema": self.schema or None,
            "output": str(self.output) if self.output is not None else None,
            "summary": self.summary,
            "next": self.next or None,
        }


def run_cli(function: Callable[P, Result | None], *arguments: P.args, **options: P.kwargs) -> int:
    """Run a command and report on it.

    Args:
        function: does the work; None means that nothing is to be reported (``--help``).
        arguments, options: its own.

    Returns:
        The exit code for ``sys.exit``.
    """
    try:
        with noting_interrupts():
            result = function(*arguments, **options)
    except VcageError as error:
        result = Result(error=error)
    except (KeyboardInterrupt, Exception) as error:
        result = Result(error=interruption(error) or _of_the_machine(error) or _bug(error))
    return 0 if result is None else _report(result)


def _report(result: Result) -> int:
    """Print the error on stderr, then text and record; return the exit code.

    It is that of a full disk if stdout takes nothing and nothing else went wrong.
    """
    code = 0
    if result.error is not None:
        code = result.error.exit_code
        complain(result.error.as_line())
    try:
        if result.text:
            print_text(result.text)
        print_record(result.as_record())
    except OSError as error:
        complain(f"the result cannot be written to stdout: {error.strerror} (run the same command again)")
        return code or DiskFull.exit_code
    return code


def _bug(error: BaseException) -> Bug:
    logger.error("this is a bug in vcage", exc_info=error)
    message = " ".join(f"{type(error).__name__}: {error}".split())
    return Bug(message, hint="report it with the traceback on stderr")


def _of_the_machine(error: BaseException) -> VcageError | None:
    """Translate an error of the system or of a package of others for the user; None for a bug."""
    if isinstance(error, MemoryError):
        return PartlyDone("not enough memory", hint="free some, or run the same command again with fewer --workers")
    if isinstance(error, RuntimeError) and "home directory" in str(error):
        return ConfigurationError("no home folder is known", hint="set HOME, and name folders without ~")
    if isinstance(error, ImportError):
        return _of_a_package(error)
    return _of_the_system(error) if isinstance(error, OSError) else None


def _of_the_system(error: OSError) -> VcageError | None:
    if error.errno in NO_ROOM:
        return DiskFull(f"no space left: {error}", hint="free some space and run the command again")
    if error.errno == errno.ENAMETOOLONG:
        return OutputFolderError(f"too long a name: {error.filename}", hint="give a shorter --out")
    if error.errno in (errno.EMFILE, errno.ENFILE):
        return ConfigurationError(f"too many open files: {error}", hint=f"raise the limit: ulimit -n {LIMITS.wanted}")
    return removed_folder() if folder_is_gone() else None


def _of_a_package(error: ImportError) -> ConfigurationError | None:
    """The error of a package of others that is missing or does not load; None where the module is ours."""
    if (error.name or "").partition(".")[0] == "vcage":
        return None
    where = f" ({error.path})" if error.path and error.path not in str(error) else ""
    return MissingDependency(
        f"a Python package cannot be imported: {error}{where}",
        hint="see what is missing",
        command=vcage_command("doctor"),
    )
