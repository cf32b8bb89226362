"""Commands as dataclasses, which tyro parses; its complaints become errors of ours: exit code 2, and a JSON line."""

from __future__ import annotations

import contextlib
import io
import re
import textwrap
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import MISSING, dataclass, fields, is_dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar, get_type_hints

import tyro
from tyro.conf import Positional, UseAppendAction, arg
from tyro.constructors import PrimitiveConstructorSpec

from vcage.base.errors import UsageError
from vcage.base.options import Flag
from vcage.cli.output import Result
from vcage.cli.streams import print_text

T = TypeVar("T")


@dataclass(frozen=True, kw_only=True)
class CommonOptions:
    """Options of every command."""

    verbose: Annotated[Flag, arg(aliases=("-v",))] = False
    """say more on stderr"""
    progress: Literal["text", "json"] = "text"
    """how work that takes long tells how far it is: for people on stderr, or as lines of JSON on stdout"""


@dataclass(frozen=True, kw_only=True)
class Command(CommonOptions, ABC):
    """A command: its docstring is the help, its fields are the options."""

    @abstractmethod
    def execute(self) -> Result:
        """Run the command."""


def parse(options: type[T], arguments: Sequence[str], *, prog: str, text: str, about: str) -> T | None:
    """Parse the options of a command line; None if it asked for help, which is printed.

    Args:
        options: a dataclass, whose fields' docstrings are the help.
        arguments: the words after the command's name.
        prog: the command's name in the help.
        text: the help between usage and options, verbatim.
        about: the command that shows the help.

    Raises:
        UsageError: the command line does not match these options; names the mistake.
    """
    printed, complaint = io.StringIO(), io.StringIO()
    try:
        with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(complaint):
            return tyro.cli(options, prog=prog, description="", args=arguments)
    except SystemExit as end:
        if end.code:
            what, meant = _in_one_line(complaint.getvalue())
            raise UsageError(f"{prog}: {what}", hint=f"{meant}see", command=about) from None
    usage, _, boxes = printed.getvalue().partition("\n\n")
    print_text(f"{usage}\n\n{text}\n\n{_without_frames(boxes)}")
    return None


@dataclass(frozen=True)
class _Option:
    """A field that is an option: its name in Python (dotted inside another field), its value, default and marks."""

    key: str
    value: Any
    default: Any
    marks: tuple[Any, ...]

    @property
    def is_said(self) -> bool:
        """True if a command line must give it; a path always, as the default may depend on the current folder."""
        return self.value != self.default or isinstance(self.value, Path)

    @property
    def is_positional(self) -> bool:
        return any(mark is Positional for mark in self.marks)

    @property
    def name(self) -> str:
        """Its name on a command line, after the two hyphens."""
        named = [name for mark in self.marks if (name := getattr(mark, "name", None))]
        return named[0] if named else self.key.rpartition(".")[2].replace("_", "-")

    def is_said_by(self, words: Sequence[str]) -> bool:
        """Check that words, possibly from a foreign file, give this option and no other."""
        if UseAppendAction in self.marks:
            names, values = words[::2], words[1::2]
            return set(names) == {f"--{self.name}"} and len(names) == len(values) and not any(map(_is_option, values))
        said = words if self.is_positional else words[1:]
        ours = self.is_positional or words[:1] in ([f"--{self.name}"], [f"--no-{self.name}"])
        return ours and not any(map(_is_option, said))

    def words(self) -> list[str]:
        """Return the words of a command line that give it."""
        name = self.name
        if isinstance(self.value, bool):
            return [f"--{name}" if self.value else f"--no-{name}"]
        if UseAppendAction in self.marks:
            return [word for one in self.value for word in (f"--{name}", str(one))]
        return [*([] if self.is_positional else [f"--{name}"]), *self._values()]

    def _values(self) -> list[str]:
        if isinstance(self.value, Path):
            return [str(self.value.expanduser().absolute())]
        kinds = [mark for mark in self.marks if isinstance(mark, PrimitiveConstructorSpec)]
        return [str(self.value)] if not kinds else list(kinds[0].str_from_instance(self.value))


def _is_option(word: str) -> bool:
    return word.startswith("--")


def options_of(record: Any, within: str = "") -> Iterator[_Option]:
    """Yield the options that a dataclass declares, also inside its fields; positional ones come first."""
    hints = get_type_hints(type(record), include_extras=True)
    found = []
    for one in fields(record):
        value, marks = getattr(record, one.name), getattr(hints[one.name], "__metadata__", ())
        if is_dataclass(value) and not any(isinstance(mark, PrimitiveConstructorSpec) for mark in marks):
            found += options_of(value, f"{within}{one.name}.")
        else:
            default = one.default if one.default_factory is MISSING else one.default_factory()
            found.append(_Option(f"{within}{one.name}", value, default, marks))
    yield from sorted(found, key=lambda option: not option.is_positional)


def words(record: Any) -> list[str]:
    """Return the command line that :func:`parse` turns into these options, with absolute paths."""
    return [word for option in options_of(record) if option.is_said for word in option.words()]


# tyro frames its messages; where stdout is no terminal (here it is a buffer), with rules of hyphens alone.


def _without_frames(help_text: str) -> str:
    """Return tyro's lists of options, each under its title."""
    titled = re.sub(r"^ ?(\S.*?) *\n *-+ *$", r"\1:", help_text, flags=re.MULTILINE)
    return _refilled(re.sub(r"^ *-{3,} *\n| +$", "", titled, flags=re.MULTILINE).strip())


def _refilled(listing: str) -> str:
    """Fill the column of explanations, in which tyro keeps the line breaks of indented docstrings."""
    first = listing.find("show this help")
    column, width = first - listing.rfind("\n", 0, first) - 1, max(map(len, listing.split("\n")))
    margin = f"\n{' ' * column}"
    rows: list[tuple[str, list[str]]] = []
    for line in listing.split("\n"):
        name, text = line[:column], line[column:]
        if text and not name.strip():
            rows[-1][1].append(text)
        elif text and name.endswith("  "):
            rows.append((name, [text]))
        else:  # a title, or an option whose name leaves no room for the explanation
            rows.append((line + margin, []))
    filled = [(name, textwrap.wrap(" ".join(texts), width - column, break_on_hyphens=False)) for name, texts in rows]
    return "\n".join((name + margin.join(lines)).rstrip() for name, lines in filled)


def _in_one_line(complaint: str) -> tuple[str, str]:
    """Return a complaint in one line, and the question "did you mean …?" if tyro knows a similar option.

    tyro names the mistake between its title's rule and the next, then similar options, then the help command.
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
        return f"{choice[2]}: there is no {choice[1]}; there are: {choice[3].replace(chr(39), '').rstrip(', ')}", ""
    if bare := re.match("Missing value for argument '(.*?)'", line):
        return f"{bare[1]} needs a value", ""
    return line.removeprefix("Error parsing "), ""
