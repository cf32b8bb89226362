"""Weights from a hub id or a folder, through ``transformers``; and the device that they run on.

Nothing that comes with weights is executed: code beside them is refused, and only safetensors are read, never a
pickle. A run folder from someone else may name weights in its resuming command.
"""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path
from typing import Any

from vcage.base.commands import pip_command
from vcage.base.errors import FetchFailed, InputFileError, MissingDependency, VcageError

EXTRA = "vision"
"""The extra of this package that installs ``transformers``."""

_HUB_ID = re.compile(r"[\w-][\w.-]*/[\w-][\w.-]*")


class Weights:
    """The weights of one model of ``transformers``: found on construction, read on first use.

    Args:
        where: a folder that ``save_pretrained`` wrote (or a snapshot of a hub), or a hub id such as
            ``facebook/dinov2-small``.
        kinds: the ``model_type`` values of ``config.json`` that the caller can use.

    Raises:
        MissingDependency: ``transformers`` is not installed.
        InputFileError: ``where`` is no hub id, and no folder with a model.
    """

    def __init__(self, where: str, kinds: tuple[str, ...]):
        require("transformers", "the model")
        self.where, self.kinds = where, kinds
        self.folder = _folder(where)

    @property
    def name(self) -> str:
        """The hub id, or the folder's own name: a record names weights, not places on a machine."""
        return self.folder.resolve().name if self.folder else self.where

    def read(self, kind: str) -> Any:
        """Load with ``transformers.<kind>.from_pretrained``: a model on :func:`device`, or a processor.

        Raises:
            FetchFailed: the hub does not answer, or has no such model.
            InputFileError: the folder holds another kind of model, or none that loads without executing its content.
        """
        import transformers

        transformers.logging.set_verbosity_error()
        transformers.logging.disable_progress_bar()
        options = {"local_files_only": self.folder is not None, "trust_remote_code": False}
        source = str(self.folder or self.where)
        try:
            config = transformers.AutoConfig.from_pretrained(source, **options)
            self._require_kind(config.model_type)
            safe = {} if kind == "AutoProcessor" else {"use_safetensors": True}
            made = getattr(transformers, kind).from_pretrained(source, **options, **safe)
        except VcageError:
            raise
        except Exception as error:  # transformers, safetensors and the hub raise errors of many types.
            raise self._failure(error) from error
        return made.to(device()).eval() if hasattr(made, "eval") else made

    def _require_kind(self, found: str) -> None:
        if found not in self.kinds:
            raise InputFileError(
                f"{self.where} holds a model of the type {found}; expected {' or '.join(self.kinds)}",
                hint="give other weights, or another model for this role",
            )

    def _failure(self, error: Exception) -> VcageError:
        why = " ".join(str(error).split()).partition(" You can inspect")[0][:300]
        if self.folder or "custom code" in why:
            hint = "it needs a known model_type and model.safetensors: code and pickles beside them are not executed"
            return InputFileError(f"no model can be read from {self.where}: {why}", hint=hint)
        return FetchFailed(
            f"{self.where} cannot be fetched from the hub: {why}",
            hint=f"fetch it where there is a network (hf download {self.where} --local-dir FOLDER), "
            "then name the folder in place of the hub id",
        )


def require(module: str, what: str, command: str = "") -> None:
    """Check that an optional package is installed.

    Args:
        module: of the package.
        what: name of the feature that needs it.
        command: installs it; by default that of the extra.

    Raises:
        MissingDependency: it is not installed; names the command that installs it.
    """
    if importlib.util.find_spec(module) is None:
        raise MissingDependency(
            f"{what} needs the package {module}, which is not installed",
            command=command or pip_command(f"vcage[{EXTRA}]"),
        )


def device() -> str:
    """``cuda`` where there is a GPU usable by torch, else ``cpu``."""
    import torch

    return "cuda" if torch.cuda.is_available() else "cpu"


def _folder(where: str) -> Path | None:
    """The folder that ``where`` names, or None for a hub id."""
    path = Path(where).expanduser()
    if path.is_dir():
        if not (path / "config.json").is_file():
            raise InputFileError(f"the folder {where} holds no model", hint="it needs config.json and the weights")
        return path
    if not _HUB_ID.fullmatch(where):
        raise InputFileError(
            f"{where!r} is neither a folder that exists nor a hub id", hint="a hub id looks like facebook/dinov2-small"
        )
    return None
