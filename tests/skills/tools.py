"""What a scripted agent does, by the tools of a client."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from tests.scripted_agent import Act, Look, Read, Run
from tests.skills.scripted_model import Call, Seen
from vcage.base.pictures import read_picture

T = TypeVar("T")


@dataclass(frozen=True)
class Tools:
    """A client's own tools."""

    run: Callable[[str], Call]
    read: Callable[[str], Call]
    look: Callable[[str], Call]
    write: Callable[[str, str], Call]
    poll: Callable[[list[str]], Call | None] = lambda printed: None
    """Output of a command call by call → the call that waits for it, while it is running."""
    plain: Callable[[str], str] = lambda text: text
    """What reading shows → the text of the file."""

    def carry_out(self, acts: Generator[Act, Any, T]) -> Generator[Call, Seen, T]:
        """The calls of an agent's acts; the agent sees their results."""
        seen: Any = None
        while True:
            try:
                act = acts.send(seen)
            except StopIteration as end:
                return end.value
            seen = yield from self._do(act)

    def _do(self, act: Act) -> Generator[Call, Seen, Any]:
        if isinstance(act, Run):
            printed = [(yield self.run(act.command)).text]
            while (waits := self.poll(printed)) is not None:
                printed.append((yield waits).text)
            return "\n".join(printed)
        if isinstance(act, Read):
            text = self.plain((yield self.read(str(act.path))).text)
            assert text.strip() == act.path.read_text().strip(), "a client shows the whole of it"
            return text
        if isinstance(act, Look):
            shown = yield self.look(str(act.path))
            assert len(shown.pictures) == 1, shown.text
            assert np.array_equal(shown.pictures[0], read_picture(act.path)), "a client shows it as it is"
            return shown.pictures[0]
        yield self.write(str(act.path), act.text)
        return None


def _poll_openclaw(printed: list[str]) -> Call | None:
    if not re.search(r"^(Command|Process) still running", printed[-1], re.MULTILINE):
        return None
    session = printed[0].partition("(session ")[2].partition(",")[0]
    return Call("process", {"action": "poll", "sessionId": session, "timeout": 30_000})


def _poll_codex(printed: list[str]) -> Call | None:
    running = re.search(r"^Process running with session ID (\d+)", printed[-1], re.MULTILINE)
    return running and Call("write_stdin", {"session_id": int(running[1]), "yield_time_ms": 30_000})


def _by_shell(path: str, text: str) -> Call:
    return Call("exec_command", {"cmd": f"printf %s {shlex.quote(text)} > {shlex.quote(path)}"})


CLAUDE = Tools(
    run=lambda command: Call("Bash", {"command": command, "description": "run it", "timeout": 600_000}),
    read=lambda path: Call("Read", {"file_path": path}),
    look=lambda path: Call("Read", {"file_path": path}),
    write=lambda path, text: Call("Write", {"file_path": path, "content": text}),
    plain=lambda text: re.sub(r"^ *\d+[→\t]", "", text, flags=re.MULTILINE),
)

CODEX = Tools(
    run=lambda command: Call("exec_command", {"cmd": command, "yield_time_ms": 2_000}),
    read=lambda path: Call("exec_command", {"cmd": f"cat {shlex.quote(path)}", "max_output_tokens": 20_000}),
    look=lambda path: Call("view_image", {"path": path}),
    write=_by_shell,
    poll=_poll_codex,
    plain=lambda text: text.partition("Output:\n")[2],
)

PI = Tools(
    run=lambda command: Call("bash", {"command": command}),
    read=lambda path: Call("read", {"path": path}),
    look=lambda path: Call("read", {"path": path}),
    write=lambda path, text: Call("write", {"path": path, "content": text}),
)

OPENCLAW = Tools(
    run=lambda command: Call("exec", {"command": command, "yieldMs": 2_000}),
    read=lambda path: Call("read", {"path": path}),
    look=lambda path: Call("read", {"path": path}),
    write=lambda path, text: Call("write", {"path": path, "content": text}),
    poll=_poll_openclaw,
)

TOOLS = {"claude": CLAUDE, "codex": CODEX, "pi": PI, "openclaw": OPENCLAW}
"""Client → its tools."""
