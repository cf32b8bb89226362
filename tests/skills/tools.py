"""What a scripted agent does, by the tools of a client."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import Any, TypeVar

from tests.scripted_agent import Act, Look, Read, Run
from tests.skills.scripted_model import Call, Seen

T = TypeVar("T")


@dataclass(frozen=True)
class Tools:
    """A client's own tools."""

    run: Callable[[str], Call]
    read: Callable[[str], Call]
    look: Callable[[str], Call]
    write: Callable[[str, str], Call]
    poll: Callable[[str], Call | None] = lambda _: None
    """What a command has printed → the call that waits for it, where it is still at work."""
    plain: Callable[[str], str] = lambda text: text
    """What reading shows → the text of the file."""

    def carry_out(self, acts: Generator[Act, Any, T]) -> Generator[Call, Seen, T]:
        """The calls that do what an agent does, which is told what they show."""
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
            while (waits := self.poll(printed[-1])) is not None:
                printed.append((yield waits).text)
            return "\n".join(printed)
        if isinstance(act, Read):
            return self.plain((yield self.read(str(act.path))).text)
        if isinstance(act, Look):
            shown = yield self.look(str(act.path))
            assert len(shown.pictures) == 1, shown.text
            return shown.pictures[0]
        yield self.write(str(act.path), act.text)
        return None


def _poll_openclaw(printed: str) -> Call | None:
    running = re.search(r"still running \(session ([\w-]+)", printed)
    return running and Call("process", {"action": "poll", "sessionId": running[1], "timeout": 30_000})


def _poll_codex(printed: str) -> Call | None:
    running = re.search(r"running with session ID (\d+)", printed)
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
    run=lambda command: Call("exec_command", {"cmd": command, "yield_time_ms": 30_000}),
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
    run=lambda command: Call("exec", {"command": command}),
    read=lambda path: Call("read", {"path": path}),
    look=lambda path: Call("read", {"path": path}),
    write=lambda path, text: Call("write", {"path": path, "content": text}),
    poll=_poll_openclaw,
)

TOOLS = {"claude": CLAUDE, "codex": CODEX, "pi": PI, "openclaw": OPENCLAW}
"""Client → its tools."""
