"""The options of ``vcage run`` that a plan gives to all jobs, checked as the command line checks them."""

from __future__ import annotations

import contextlib
import io
import re
from collections.abc import Iterator, Mapping
from dataclasses import fields
from typing import Any

import tyro

from vcage.base.commands import vcage_command
from vcage.base.errors import UnknownName, UsageError
from vcage.datasets.packing.settings import CompressionSettings
from vcage.models import agent
from vcage.stages.chain import ChainOptions

ELSEWHERE = {
    "instruction": "tasks",
    "goals": "tasks",
    "starts": "tasks",
    "objects": "tasks",
    "template": "tasks (scene)",
    "all_subtasks": "tasks",
    "robot": "robots",
    "layout": "layouts",
    "randomise": "looks",
    "seed": "seed and seeds",
    "episodes": "episodes and episodes_per_job",
    "workers": "--workers of the command",
    "most_calls": "limits.calls",
    "most_usd": "limits.usd",
}
"""Option of the chain → the place in a plan, or on the command line, where it is given instead."""

REFUSED = ("crf_of", "force", "replay", "script", "target")
"""Options that concern one run."""


def options_of_plan(given: Mapping[str, Any]) -> ChainOptions:
    """Parse the further options of a plan.

    Args:
        given: name as in Python or on the command line → value.

    Raises:
        UnknownName: there is no such option.
        UsageError: an option belongs to another field, a value is wrong, or an agent or a record is to answer.
    """
    known = {name: default for name, default in _names(ChainOptions) if name not in REFUSED}
    words = []
    for key, value in given.items():
        name = str(key).replace("-", "_")
        if name in ELSEWHERE:
            raise UsageError(f"{key} does not belong here", hint=f"give it as {ELSEWHERE[name]}")
        if name not in known:
            raise UnknownName("option", str(key), known.keys() - ELSEWHERE.keys())
        own = _words(name, value) if value != known[name] else []
        if _parsed(own).instruction is not None:  # the words after the one that the option takes
            raise UsageError(f"{key} takes one value, not {value!r}", hint="give one")
        words += own
    options = _parsed(words)
    for role in ("models", "reasoner", "editor", "critic"):
        if (who := getattr(options, role)) in (agent.PROVIDER, "replay"):
            raise UsageError(f"{who} cannot answer in a campaign", hint="name a provider, or offline")
    return options


def _names(kind: type) -> Iterator[tuple[str, Any]]:
    """Name and default of the options that a dataclass declares, those of its compression among them."""
    for field in fields(kind):
        if field.name == "compression":
            yield from _names(CompressionSettings)
        else:
            yield field.name, field.default


def _words(name: str, value: Any) -> list[str]:
    """The words of a command line that give an option."""
    flag = f"--{name.replace('_', '-')}"
    if isinstance(value, bool):
        return [flag if value else f"--no-{flag[2:]}"]
    return [flag, *map(str, value if isinstance(value, list) else [value])]


def _parsed(words: list[str]) -> ChainOptions:
    complaint = io.StringIO()
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(complaint):
            return tyro.cli(ChainOptions, args=words)
    except SystemExit:
        parts = re.split(r"\n *-{3,} *\n", complaint.getvalue())
        message = " ".join(parts[min(1, len(parts) - 1)].split())
        raise UsageError(message, hint="see", command=vcage_command("run", "--help")) from None
