"""Errors that end a try of a job, and their meaning for the job."""

from __future__ import annotations

import errno
import logging
from enum import Enum

from vcage.base.errors import (
    ConfigurationError,
    DiskFull,
    InputFileError,
    MissingDependency,
    MissingKey,
    MissingStage,
    ModelNotServed,
    NoRenderer,
    OutputFolderError,
    PassingFault,
    TooFewVerified,
    VcageError,
)
from vcage.base.files import NO_ROOM, RunFolder
from vcage.campaigns.record import JobError
from vcage.runs.accepted import no_episode_counts

logger = logging.getLogger(__name__)

OF_THE_MACHINE = (PassingFault, DiskFull, OutputFolderError, ConfigurationError)
"""Errors that say nothing about the job: it stays open, and the try does not count."""

LACKING = (MissingDependency, MissingKey, ModelNotServed, NoRenderer)
"""Those of them about something that a machine lacks and another may have: no job can run there."""

MACHINE_ERRORS = (*NO_ROOM, errno.EROFS, errno.EACCES, errno.EPERM, errno.EIO, errno.ESTALE)
"""Numbers of such errors of the system: of its disks, or of a file server that is gone."""


class Meaning(Enum):
    """The meaning of an error for the job that it ended."""

    RESULT = "the chain ran to its end, and no episode counts"
    REPEATS = "another try would end with it too"
    AGAIN = "another try may go better"
    MACHINE = "it says nothing about the job"


def meaning_of(error: Exception, run: RunFolder) -> Meaning:
    """Tell a job's result from errors of the job and of its machine.

    Args:
        error: raised by it.
        run: the folder in which it ran.
    """
    if isinstance(error, TooFewVerified) or (isinstance(error, MissingStage) and no_episode_counts(run)):
        return Meaning.RESULT
    if isinstance(error, OF_THE_MACHINE) or _number(error) in MACHINE_ERRORS:
        return Meaning.MACHINE
    if isinstance(error, VcageError):
        return Meaning.AGAIN if error.retryable else Meaning.REPEATS
    if not isinstance(error, OSError | MemoryError):
        logger.error("%s: this is a bug in vcage", run, exc_info=error)
    return Meaning.AGAIN


def named(error: Exception) -> JobError:
    """An error as records hold it."""
    if isinstance(error, VcageError):
        return JobError(code=error.code, message=error.as_line()[:2000])
    return JobError(code="bug", message=" ".join(f"{type(error).__name__}: {error}".split())[:2000])


def _number(error: Exception) -> int | None:
    """The number of the error of the system, where one is behind an error."""
    found = error.__cause__ if isinstance(error, InputFileError) else error
    return found.errno if isinstance(found, OSError) else None


def of_the_machine(error: Exception) -> Exception:
    """A fault of the machine, as drivers take it."""
    if isinstance(error, InputFileError):
        return OutputFolderError(error.message, hint="see that its disk, or file server, can be read")
    return of_the_system(error) if isinstance(error, OSError) else error


def of_the_system(error: OSError) -> VcageError:
    """An error of the operating system, as drivers take it."""
    if error.errno in NO_ROOM:
        return DiskFull(f"no space left: {error}", hint="free some space and run the same command again")
    return OutputFolderError(f"cannot write: {error}", hint="make the folder of the campaign writable")
