"""A model on this machine for agents' clients: it calls tools as a script says, and then says that all is done.

It speaks, as server-sent events, what the clients do: ``/chat/completions``, ``/responses`` and ``/messages``.
"""

from __future__ import annotations

import base64
import json
import threading
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import cv2
import numpy as np

from vcage.base.pictures import rgb_of_decoded

TEXT = "done"


@dataclass(frozen=True)
class Call:
    """A tool, and its arguments."""

    tool: str
    arguments: dict[str, Any]


@dataclass(frozen=True)
class Seen:
    """What a client shows its model of a tool's result."""

    text: str
    pictures: list[np.ndarray]
    """(H, W, 3) uint8 RGB."""


Script = Generator[Call, Seen, None]
"""Yields a call, and is sent what the model sees of its result; all is done where it ends."""


class ScriptedModel(ThreadingHTTPServer):
    """Listens on a free port of the loopback interface."""

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        self.asked: list[str] = []
        self.transcript: list[Call | Seen] = []
        self.fault: Exception | None = None
        """What the script failed with."""
        self._script: Script | None = None
        self._called: Call | None = None
        self._lock = threading.Lock()

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server_port}"

    @property
    def called(self) -> str:
        """The id of the call whose result is waited for."""
        return f"call{len(self.transcript):06}"

    def play(self, script: Script) -> None:
        """Follow a script, from the next request on."""
        self._script = script

    def answer(self, asked: dict[str, Any]) -> Call | None:
        """The next call; None where the script has ended, or none is meant (only a title is asked for)."""
        with self._lock:
            if self._script is None or not asked.get("tools"):
                return None
            if self._called is None:
                return self._go_on(None)
            seen = _seen(asked.get("messages") or asked.get("input") or [], self.called)
            return self._called if seen is None else self._go_on(seen)  # where it is asked again

    def _go_on(self, seen: Seen | None) -> Call | None:
        assert self._script is not None
        self.transcript += [] if seen is None else [seen]
        try:
            self._called = next(self._script) if seen is None else self._script.send(seen)
            self.transcript.append(self._called)
        except StopIteration:
            self._script = None
        except Exception as error:  # it fails in the thread of a request: readers of `fault` learn it
            self._script, self.fault = None, error
        return None if self._script is None else self._called


@contextmanager
def scripted_model() -> Iterator[ScriptedModel]:
    """A server that listens inside the block."""
    with ScriptedModel() as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        try:
            yield server
        finally:
            server.shutdown()


def _seen(conversation: Sequence[dict[str, Any]], called: str) -> Seen | None:
    """The result of a call, and the pictures that came in it or behind it; None where it is not there."""
    for number, item in enumerate(conversation):
        content = item.get("content")
        for part in [item, *(content if isinstance(content, list) else [])]:
            shown = part.get("content", part.get("output"))
            if called in (part.get("tool_call_id"), part.get("tool_use_id"), part.get("call_id")) and shown is not None:
                return Seen(_text(shown), list(_pictures(conversation[number:])))
    return None


def _text(shown: Any) -> str:
    return shown if isinstance(shown, str) else "\n".join(part["text"] for part in shown if "text" in part)


def _pictures(shown: Any) -> Iterator[np.ndarray]:
    """Those anywhere in a part of a conversation, as each of the three protocols writes them."""
    if isinstance(shown, dict):
        address = shown.get("image_url")
        data = address["url"] if isinstance(address, dict) else address
        if shown.get("type") == "image":
            data = shown["source"]["data"]
        if data is not None:
            raw = np.frombuffer(base64.b64decode(data.rpartition(",")[2]), np.uint8)
            yield rgb_of_decoded(cv2.imdecode(raw, cv2.IMREAD_UNCHANGED))
            return
    for part in shown.values() if isinstance(shown, dict) else shown if isinstance(shown, list) else ():
        yield from _pictures(part)


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server: ScriptedModel

    def log_message(self, *_: object) -> None:
        """Say nothing."""

    def do_GET(self) -> None:
        self._answer("application/json", json.dumps({"object": "list", "data": [], "models": []}))

    def do_POST(self) -> None:
        body = self.rfile.read(int(self.headers.get("Content-Length") or 0))
        asked = body.decode(errors="replace")
        self.server.asked.append(asked)
        call = self.server.answer(json.loads(asked) if asked else {})
        events = next(make for end, make in SPOKEN.items() if end in self.path)(call, self.server.called)
        self._answer("text/event-stream", "".join(_event(event) for event in events))

    def _answer(self, kind: str, text: str) -> None:
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(text.encode())))
        self.end_headers()
        self.wfile.write(text.encode())


def _event(event: Any) -> str:
    name = f"event: {event['type']}\n" if isinstance(event, dict) and "type" in event else ""
    return f"{name}data: {event if isinstance(event, str) else json.dumps(event)}\n\n"


def _chat(call: Call | None, called: str) -> list[Any]:
    head = {"id": f"answer-{called}", "object": "chat.completion.chunk", "created": 1, "model": "mock"}
    delta: dict[str, Any] = {"role": "assistant", "content": TEXT}
    if call is not None:
        function = {"name": call.tool, "arguments": json.dumps(call.arguments)}
        asked = {"index": 0, "id": called, "type": "function", "function": function}
        delta = {"role": "assistant", "tool_calls": [asked]}
    said = {"index": 0, "delta": delta, "finish_reason": None}
    usage = {"prompt_tokens": 1, "completion_tokens": 1, "total_tokens": 2}
    end = {"index": 0, "delta": {}, "finish_reason": "stop" if call is None else "tool_calls"}
    return [{**head, "choices": [said]}, {**head, "choices": [end], "usage": usage}, "[DONE]"]


def _responses(call: Call | None, called: str) -> list[Any]:
    content = [{"type": "output_text", "text": TEXT, "annotations": []}]
    item: dict[str, Any] = {"type": "message", "role": "assistant", "content": content}
    if call is not None:
        item = {"type": "function_call", "call_id": called, "name": call.tool, "arguments": json.dumps(call.arguments)}
    item |= {"id": f"item-{called}", "status": "completed"}
    usage = {"input_tokens": 1, "output_tokens": 1, "total_tokens": 2}
    whole = {"id": f"answer-{called}", "object": "response", "created_at": 1, "model": "mock", "usage": usage}
    return [
        {"type": "response.created", "response": {**whole, "status": "in_progress", "output": []}},
        {"type": "response.output_item.done", "output_index": 0, "item": item},
        {"type": "response.completed", "response": {**whole, "status": "completed", "output": [item]}},
    ]


def _messages(call: Call | None, called: str) -> list[Any]:
    block: dict[str, Any] = {"type": "text", "text": ""}
    delta = {"type": "text_delta", "text": TEXT}
    if call is not None:
        block = {"type": "tool_use", "id": called, "name": call.tool, "input": {}}
        delta = {"type": "input_json_delta", "partial_json": json.dumps(call.arguments)}
    end = "end_turn" if call is None else "tool_use"
    usage = {"input_tokens": 1, "output_tokens": 1}
    head = {"id": f"answer-{called}", "type": "message", "role": "assistant", "model": "mock"}
    begun = {**head, "content": [], "usage": usage}
    return [
        {"type": "message_start", "message": {**begun, "stop_reason": None, "stop_sequence": None}},
        {"type": "content_block_start", "index": 0, "content_block": block},
        {"type": "content_block_delta", "index": 0, "delta": delta},
        {"type": "content_block_stop", "index": 0},
        {"type": "message_delta", "delta": {"stop_reason": end, "stop_sequence": None}, "usage": usage},
        {"type": "message_stop"},
    ]


SPOKEN = {"/chat/completions": _chat, "/responses": _responses, "/messages": _messages}
"""How an address ends → the events of the answer."""
