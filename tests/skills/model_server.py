"""A model on this machine for agents' clients: it keeps what it is asked, calls one tool, and says that all is done.

It speaks, as server-sent events, what the clients do: ``/chat/completions``, ``/responses`` and ``/messages``.
"""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

TEXT = "done"


class ModelServer(ThreadingHTTPServer):
    """Listens on a free port of the loopback interface."""

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        self.asked: list[str] = []
        self.call: tuple[str, dict[str, str]] | None = None
        """The tool that is still to be called, and with what."""

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server_port}"


@contextmanager
def model_server() -> Iterator[ModelServer]:
    """A server that listens inside the block."""
    with ModelServer() as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        try:
            yield server
        finally:
            server.shutdown()


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server: ModelServer

    def log_message(self, *_: object) -> None:
        """Say nothing."""

    def do_GET(self) -> None:
        self._answer("application/json", json.dumps({"object": "list", "data": [], "models": []}))

    def do_POST(self) -> None:
        body = self.rfile.read(int(self.headers.get("Content-Length") or 0))
        asked = body.decode(errors="replace")
        self.server.asked.append(asked)
        call = self.server.call
        if call is not None and f'"{call[0]}"' in asked:  # not where only a title is asked for
            self.server.call = None
        else:
            call = None
        events = next(make for end, make in SPOKEN.items() if end in self.path)(call)
        self._answer("text/event-stream", "".join(_event(event) for event in events))

    def _answer(self, kind: str, text: str) -> None:
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(text.encode())))
        self.end_headers()
        self.wfile.write(text.encode())


Call = tuple[str, dict[str, str]] | None


def _event(event: Any) -> str:
    name = f"event: {event['type']}\n" if isinstance(event, dict) and "type" in event else ""
    return f"{name}data: {event if isinstance(event, str) else json.dumps(event)}\n\n"


def _chat(call: Call) -> list[Any]:
    head = {"id": "1", "object": "chat.completion.chunk", "created": 1, "model": "mock"}
    delta: dict[str, Any] = {"role": "assistant", "content": TEXT}
    if call is not None:
        function = {"name": call[0], "arguments": json.dumps(call[1])}
        delta = {"role": "assistant", "tool_calls": [{"index": 0, "id": "c", "type": "function", "function": function}]}
    said = {"index": 0, "delta": delta, "finish_reason": None}
    usage = {"prompt_tokens": 1, "completion_tokens": 1, "total_tokens": 2}
    end = {"index": 0, "delta": {}, "finish_reason": "stop" if call is None else "tool_calls"}
    return [{**head, "choices": [said]}, {**head, "choices": [end], "usage": usage}, "[DONE]"]


def _responses(call: Call) -> list[Any]:
    content = [{"type": "output_text", "text": TEXT, "annotations": []}]
    item: dict[str, Any] = {"type": "message", "role": "assistant", "content": content}
    if call is not None:
        item = {"type": "function_call", "call_id": "c", "name": call[0], "arguments": json.dumps(call[1])}
    item |= {"id": "2", "status": "completed"}
    usage = {"input_tokens": 1, "output_tokens": 1, "total_tokens": 2}
    whole = {"id": "1", "object": "response", "created_at": 1, "model": "mock", "usage": usage}
    return [
        {"type": "response.created", "response": {**whole, "status": "in_progress", "output": []}},
        {"type": "response.output_item.done", "output_index": 0, "item": item},
        {"type": "response.completed", "response": {**whole, "status": "completed", "output": [item]}},
    ]


def _messages(call: Call) -> list[Any]:
    block: dict[str, Any] = {"type": "text", "text": ""}
    delta = {"type": "text_delta", "text": TEXT}
    if call is not None:
        block = {"type": "tool_use", "id": "c", "name": call[0], "input": {}}
        delta = {"type": "input_json_delta", "partial_json": json.dumps(call[1])}
    end = "end_turn" if call is None else "tool_use"
    usage = {"input_tokens": 1, "output_tokens": 1}
    begun = {"id": "1", "type": "message", "role": "assistant", "model": "mock", "content": [], "usage": usage}
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
