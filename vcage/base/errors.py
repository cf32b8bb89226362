"""One error tree: every failure that a user can cause or fix has a code, a hint and an exit code.

A script turns a :class:`VcageError` into one line on stderr and one JSON line on stdout
(:meth:`VcageError.as_record`), and exits with :attr:`VcageError.exit_code`. Any other exception is a bug
of ours and exits with 1.

Exit codes: 0 done, 1 a bug, 2 usage, 3 bad input file or schema, 4 key or configuration missing,
5 the model refused (final), 6 the endpoint failed for now or the folder is in use, 7 partly done (run again),
8 the agent that runs the command must answer first, 9 a replay differs from the recording.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, ClassVar

from vcage.base.text import shown


class VcageError(Exception):
    """Base of all errors that carry a way out.

    Args:
        message: what went wrong, naming the thing (file, object, option).
        hint: the user's remedy, in words.
        command: the one that fixes it, as a shell takes it (:mod:`vcage.base.commands`); shown after the hint.
        maker: the stage that fixes it when run (again); callers that know the run make a command of it.
        details: JSON-serialisable facts for a program that reads the error.
    """

    code: ClassVar[str] = "error"
    exit_code: ClassVar[int] = 1
    retryable: ClassVar[bool] = False

    def __init__(
        self,
        message: str,
        *,
        hint: str = "",
        command: str = "",
        maker: str = "",
        details: dict[str, Any] | None = None,
    ):
        super().__init__(message)
        self.message = message
        self.hint = hint
        self.command = command
        self.maker = maker
        self.details = details or {}

    def __reduce__(self) -> tuple[Any, ...]:
        """Errors cross from worker processes whole, whatever their constructors take."""
        way_out = {"hint": self.hint, "command": self.command, "maker": self.maker}
        return _restored, (type(self), self.message, way_out, self.details)

    @property
    def way_out(self) -> str:
        """The hint, and the command that fixes it if there is one."""
        hint = shown(self.hint)
        return f"{hint or 'run'}: {self.command}" if self.command else hint

    def offer(self, way_out: str) -> None:
        """Add another way out, in words."""
        self.hint = f"{self.hint}, or {way_out}" if self.hint else way_out

    def as_record(self) -> dict[str, Any]:
        """The ``error`` object of a script's last line of stdout."""
        return {
            "code": self.code,
            "message": shown(self.message),
            "hint": self.way_out,
            "retryable": self.retryable,
            "details": self.details,
        }

    def as_line(self) -> str:
        """The one line for stderr: the problem, then the way out; a command stands last, ready to be typed."""
        message, hint = (" ".join(map(str.strip, shown(text).splitlines())) for text in (self.message, self.hint))
        if self.command:
            return f"{message}; {hint or 'run'}: {self.command}"
        return f"{message} ({hint})" if hint else message


def _restored(kind: type[VcageError], message: str, way_out: dict[str, str], details: dict[str, Any]) -> VcageError:
    error = kind.__new__(kind)
    VcageError.__init__(error, message, **way_out, details=details)
    return error


# --- 2: the request itself cannot be met ---------------------------------------------------------------


class UsageError(VcageError):
    """An argument is missing, malformed or out of range."""

    code = "usage"
    exit_code = 2


class UnknownName(UsageError):
    """A name outside a closed set; the message lists the available ones."""

    code = "unknown_name"

    def __init__(self, what: str, name: str, available: Iterable[str], hint: str = "take one of those listed"):
        names = sorted(available)
        near = difflib.get_close_matches(name, names, n=3)
        listed = ", ".join(names[:40]) + (f", … ({len(names)} in all)" if len(names) > 40 else "")
        super().__init__(
            f"unknown {what} {name!r}; available: {listed or 'none'}",
            hint=f"did you mean {' or '.join(near)}?" if near else hint,
            details={"what": what, "name": name, "available": names},
        )


class AssetLeftOut(UsageError):
    """An object is annotated, but its package was not fetched."""

    code = "asset_left_out"


class UnreadInstruction(UsageError):
    """Words of an instruction match no action of the robot: names them, and the words that were understood."""

    code = "unread_instruction"

    @classmethod
    def of(cls, instruction: str, words: str, why: str, understood: Sequence[str] = ()) -> UnreadInstruction:
        """The error about some words.

        Args:
            instruction: the whole.
            words: the words not understood.
            why: the reason.
            understood: the clauses that were.
        """
        clauses = "; ".join(repr(clause) for clause in understood)
        rest = f"understood is {clauses}; say the rest otherwise, or leave it out" if clauses else ""
        return cls(
            f"{words!r} in {instruction!r} is not understood: {why}",
            hint=rest or "write it like 'Put the blocks on the plate'",
            details={"unread": words, "understood": list(understood)},
        )


class NoAssetFits(UsageError):
    """No object of the catalogue matches the instruction."""

    code = "no_asset_fits"


class InfeasibleScene(UsageError):
    """The objects cannot be placed: names them and the area that is missing (m²)."""

    code = "infeasible_scene"


class NoFeasibleTask(UsageError):
    """No chain of feasible sub-tasks fulfils the instruction in this scene."""

    code = "no_feasible_task"


class OutputFolderError(UsageError):
    """The output folder cannot be written (read-only, a file in its place, not ours)."""

    code = "output_not_writable"


# --- 3: a file is missing, damaged, or of another kind -------------------------------------------------


class InputFileError(VcageError):
    """An input file of a step is invalid."""

    code = "bad_input_file"
    exit_code = 3


class MissingStage(InputFileError):
    """The output of an earlier stage is missing."""

    code = "missing_stage"


class DamagedFile(InputFileError):
    """A file cannot be parsed (JSON, HDF5, picture, mesh)."""

    code = "damaged_file"


class OversizedFile(DamagedFile):
    """A file holds, or declares, more than may be read into memory; names the size and the limit."""

    code = "oversized_file"


class SchemaMismatch(InputFileError):
    """A file is of another schema, another version, or breaks its own schema."""

    code = "schema_mismatch"


def mismatch(path: Path, field: str, message: str, hint: str = "fix the field", **details: Any) -> SchemaMismatch:
    """The error about one field of a file.

    Args:
        path: of the file.
        field: its name.
        message: the value, and the expected one.
        hint: the way out.
        details: more facts for a program.
    """
    named = {"path": str(path), "field": field, **details}
    return SchemaMismatch(f"{path}: field {field}: {message}", hint=hint, details=named)


class StaleStage(InputFileError):
    """A stage is finished, but from other inputs or options than the present ones."""

    code = "stale_stage"


class NotJudged(StaleStage):
    """Verify has judged other episodes than the present ones: a second run judges the new ones, and keeps the rest."""


class DrivesNotRecorded(InputFileError):
    """An episode lacks the commands to its arms: it was recorded by a version that did not store them."""

    code = "no_drives"


# --- 4: the machine or its configuration ---------------------------------------------------------------


class ConfigurationError(VcageError):
    """Something that must be installed or configured is not."""

    code = "configuration"
    exit_code = 4


class MissingKey(ConfigurationError):
    """A model endpoint needs a key that is nowhere to be found."""

    code = "missing_key"


class ModelNotServed(ConfigurationError):
    """An endpoint lacks a model; names the available ones."""

    code = "model_not_served"


class SpendingCap(ConfigurationError):
    """A run has asked models as often, or for as much money, as it may."""

    code = "spending_cap"


class MissingDependency(ConfigurationError):
    """An optional package is not installed; the hint names the extra."""

    code = "missing_dependency"


class NoRenderer(ConfigurationError):
    """SAPIEN finds no Vulkan driver that draws a picture."""

    code = "no_renderer"


# --- 5, 6: what others do: model endpoints, another process ------------------------------------------


class ModelRefused(VcageError):
    """The model answered, and its answer is final: a refusal, a safety block, or never valid."""

    code = "model_refused"
    exit_code = 5


class PassingFault(VcageError):
    """Others are busy or out of reach for now: the same call may succeed later."""

    exit_code = 6
    retryable = True


class EndpointFailed(PassingFault):
    """The endpoint did not answer, or answered with a passing fault (429, 5xx, time-out)."""

    code = "endpoint_failed"


class FolderInUse(PassingFault):
    """Another process works in the folder; says which."""

    code = "in_use"


class FileInUse(PassingFault):
    """Another process writes a file that is to be read."""

    code = "in_use"


class FetchFailed(PassingFault):
    """A package mirror or index does not answer, or lacks the requested package."""

    code = "fetch_failed"


class ClusterLost(PassingFault):
    """A cluster does not answer, or cannot be joined."""

    code = "cluster_lost"


# --- 7: partly done ------------------------------------------------------------------------------------


class PartlyDone(VcageError):
    """Work remains; running the same command again goes on from here."""

    code = "partly_done"
    exit_code = 7
    retryable = True


class TooFewVerified(PartlyDone):
    """Fewer episodes than requested were verified within the limit of attempts: a repetition would change nothing."""

    retryable = False


class StageInterrupted(PartlyDone):
    """A stage that another one needs was interrupted; names the command that resumes it."""

    code = "stage_interrupted"


class DiskFull(PartlyDone):
    """The disk or quota is full; nothing half-written was left."""

    code = "disk_full"


# --- 8: the agent that runs the command is the model ---------------------------------------------------


class AnswerNeeded(VcageError):
    """A question lies in the run folder, and the command goes on when it is answered.

    ``details["asked"]`` lists ``{folder, role, files, answer, round, complaint}`` for each question.
    """

    code = "answer_needed"
    exit_code = 8
    retryable = True

    @classmethod
    def of(cls, folder: Path, role: str, number: int, complaint: str, files: Sequence[str]) -> AnswerNeeded:
        """For one question.

        Args:
            folder: where it lies.
            role: who is asked.
            number: of the round.
            complaint: about the answer of the round before; empty in the first.
            files: of the question.
        """
        return cls.all_of([
            {
                "folder": str(folder),
                "role": role,
                "files": list(files),
                "answer": str(folder / "answer.json"),
                "round": number,
                "complaint": complaint,
            }
        ])  # fmt: skip

    @classmethod
    def all_of(cls, asked: Sequence[dict[str, Any]]) -> AnswerNeeded:
        """For several questions, as their details list them."""
        if len(asked) == 1:
            only = asked[0]
            message = f"the {only['role']}'s answer of round {only['round']} is needed: {only['folder']}/prompt.md"
        else:
            message = f"{len(asked)} answers are needed, the first to {asked[0]['folder']}/prompt.md"
        return cls(
            message,
            hint="read prompt.md and the pictures, write answer.json beside them, then run the same command again",
            details={"asked": list(asked)},
        )


# --- 9: a recording cannot be reproduced ---------------------------------------------------------------


class NotReproduced(VcageError):
    """A replay differs from its recording; says where first, and which versions differ."""

    code = "not_reproduced"
    exit_code = 9
