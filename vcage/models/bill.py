"""The bill of many runs that share their exchanges: one line for each question that was asked online.

It is a file of JSON lines to which all processes append, each while it holds a lock: ``asked`` before a question
leaves, then ``answered`` with its cost, or ``failed``. So questions that were under way when their process was killed
count.
"""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from vcage.base.files import make_folder
from vcage.base.hold import one_at_a_time


@dataclass
class Spent:
    """Sums of a bill.

    Args:
        calls: questions that were asked, without those that got no answer.
        usd: US dollars for the answers whose cost is known.
        tokens_in, tokens_out: as far as the answers count them.
    """

    calls: int = 0
    usd: float = 0.0
    tokens_in: int = 0
    tokens_out: int = 0

    def add(self, line: dict[str, Any]) -> None:
        """Count one line."""
        self.calls += {"asked": 1, "failed": -1}.get(line["what"], 0)
        self.usd += line.get("usd") or 0.0
        self.tokens_in += line.get("tokens_in") or 0
        self.tokens_out += line.get("tokens_out") or 0


@dataclass
class Bill:
    """A file of lines; what was read once is not read again.

    Args:
        path: of the file, which need not exist yet.
    """

    path: Path
    by_provider: dict[str, Spent] = field(default_factory=dict)
    _read: int = 0

    def refresh(self) -> dict[str, Spent]:
        """Sums by provider; a line that is being written is left for the next time."""
        try:
            with open(self.path, "rb") as handle:
                handle.seek(self._read)
                data = handle.read()
        except FileNotFoundError:
            return self.by_provider
        whole = data[: data.rfind(b"\n") + 1]
        self._read += len(whole)
        for text in whole.splitlines():
            if line := _line(text):
                self.by_provider.setdefault(line["provider"], Spent()).add(line)
        return self.by_provider

    def count(self) -> int:
        """Questions asked before the last one, of all providers."""
        return sum(spent.calls for spent in self.refresh().values()) - 1

    def append(self, what: str, provider: str, question: str, **facts: Any) -> None:
        """Add a line; call it while :meth:`locked` is held."""
        line = json.dumps({"what": what, "provider": provider, "question": question, **facts}) + "\n"
        with open(self.path, "ab") as handle:
            if handle.tell() and not self._ends_whole():
                handle.write(b"\n")  # a process was killed in the middle of its line
            handle.write(line.encode())
            handle.flush()
            os.fsync(handle.fileno())

    def locked(self) -> Any:
        """Wait for the other processes that append."""
        make_folder(self.path.parent)
        return one_at_a_time(self.path)

    def _ends_whole(self) -> bool:
        with open(self.path, "rb") as handle:
            handle.seek(-1, os.SEEK_END)
            return handle.read(1) == b"\n"


def _line(text: bytes) -> dict[str, Any] | None:
    """A line of the bill; None for the rest of one that was cut off."""
    try:
        line = json.loads(text)
    except ValueError:
        return None
    return line if isinstance(line, dict) and {"what", "provider"} <= line.keys() else None
