"""Command-line parsing whose errors are errors of ours: exit code 2, and a JSON line like any other."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import NoReturn

from vcage.base.errors import UsageError


class Parser(argparse.ArgumentParser):
    """An ``ArgumentParser`` that raises :class:`UsageError` and prints descriptions as they are written."""

    def __init__(self, prog: str, description: str):
        super().__init__(
            prog=prog,
            description=description,
            formatter_class=argparse.RawDescriptionHelpFormatter,
            allow_abbrev=False,
        )

    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{self.prog}: {message}", hint=f"see: {self.prog} --help")


def folder(text: str) -> Path:
    """A folder's path, for ``type=`` of an option; an empty text would mean the working directory."""
    if not text.strip():
        raise argparse.ArgumentTypeError("the folder has no name")
    return Path(text)
