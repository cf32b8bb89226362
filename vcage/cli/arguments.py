"""Commands as dataclasses: tyro parses them, and its errors are errors of ours: exit code 2, and a JSON line."""

from __future__ import annotations

import contextlib
import io
import re
import sys
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, TypeVar

import tyro
from tyro.conf import arg

from vcage.base.errors import UsageError
from vcage.base.options import Flag
from vcage.cli.output import Result

T = TypeVar("T")


@dataclass(frozen=True, kw_only=True)
class CommonOptions:
    """What every command takes."""

    verbose: Annotated[Flag, arg(aliases=("-v",))] = False
    """say more on stderr"""


@dataclass(frozen=True, kw_only=True)
class Command(CommonOptions, ABC):
    """A command: its docstring is the help, its fields are the options."""

    @abstractmethod
    def execute(self) -> Result:
        """Do it."""


def parse(options: type[T], arguments: Sequence[str], *, prog: str, text: str) -> T | None:
    """The options on a command line; None when help was asked for, which is printed.

    Args:
        options: a dataclass, whose fields' docstrings are the help.
        arguments: the words after the command's name.
        prog: the command's name in the help.
        text: what the help says between usage and options, as it is written.

    Raises:
        UsageError: the command line is not one of these options; says what is wrong with it.
    """
    printed, complaint = io.StringIO(), io.StringIO()
    try:
        with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(complaint):
            return tyro.cli(options, prog=prog, description="", args=arguments)
    except SystemExit as end:
        if end.code:
            what, meant = _in_one_line(complaint.getvalue())
            raise UsageError(f"{prog}: {what}", hint=f"{meant}see: {prog} --help") from None
    usage, _, boxes = printed.getvalue().partition("\n\n")
    sys.stdout.write(f"{usage}\n\n{text}\n\n{_without_frames(boxes)}\n")
    return None


# tyro frames what it says; where stdout is no terminal (here it is a buffer), with rules of hyphens alone.


def _without_frames(help_text: str) -> str:
    """tyro's lists of options, each under its title."""
    titled = re.sub(r"^ ?(\S.*?) *\n *-+ *$", r"\1:", help_text, flags=re.MULTILINE)
    return re.sub(r"^ *-{3,} *\n| +$", "", titled, flags=re.MULTILINE).strip()


def _in_one_line(complaint: str) -> tuple[str, str]:
    """What is wrong, and a question whether something else was meant, if tyro knows of it.

    tyro says what is wrong between its title's rule and the next, then what is like it, then where the help is.
    """
    parts = re.split(r"\n *-{3,} *\n", complaint)
    said, after = parts[min(1, len(parts) - 1)], parts[min(2, len(parts) - 1)]
    missing = re.findall(r"^ {4,8}(\S.*?) *\n((?: {9,}\S.*\n?)*)", said + "\n", re.MULTILINE)
    if said.strip().startswith("Missing from ") and missing:
        explained = (f"{name} ({' '.join(text.replace('(required)', '').split())})" for name, text in missing)
        return f"missing: {'; '.join(explained)}", ""
    line = " ".join(said.split())
    if unknown := re.fullmatch("Unrecognized options: (.*)", line):
        words = unknown[1].split(", ")
        options = [word for word in words if word.startswith("-")]
        near = re.findall(r"^ +(--[\w-]+)", after, re.MULTILINE) if "Perhaps you meant" in after else []
        what = f"there is no option {' or '.join(options)}" if options else f"one word too many: {' '.join(words)}"
        return what, f"did you mean {' or '.join(near)}? " if near else ""
    if choice := re.fullmatch(r"invalid choice (.*) for argument '(.*)'\. Expected one of \((.*?),?\)\.", line):
        return f"{choice[2]}: there is no {choice[1]}; there are: {choice[3].replace(chr(39), '')}", ""
    if bare := re.match("Missing value for argument '(.*?)'", line):
        return f"{bare[1]} needs a value", ""
    return line.removeprefix("Error parsing "), ""
