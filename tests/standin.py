"""A loopback server that answers in the Gemini and OpenAI shapes, so that clients are tested without a network.

It checks the key (401, 403) and the shape of the request (400) as the vendors do, answers structured questions from
the request's own schema and prompt, and picture requests with a picture made from the one sent. Special answers can
be queued; they are sent first, one per request.

    with StandIn() as server:
        server.queue(server_error(), text_answer("```json\n{}\n```"))
        Transport(server.url, {"x-goog-api-key": server.key}).post_json(...)
"""

from __future__ import annotations

import base64
import contextlib
import email
import email.policy
import json
import re
import threading
from collections.abc import Iterator
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import cv2
import numpy as np

from tests.standin_answers import answer_question

GEMINI_USAGE = {"promptTokenCount": 70, "candidatesTokenCount": 5, "thoughtsTokenCount": 2, "totalTokenCount": 77}
OPENAI_USAGE = {"prompt_tokens": 70, "completion_tokens": 7, "total_tokens": 77}


@dataclass(frozen=True)
class Special:
    """An answer that replaces the usual one: raw bytes, or a text or parts in the shape that was asked for."""

    status: int = 200
    headers: dict[str, str] = field(default_factory=dict)
    body: bytes | None = None
    text: str | None = None
    finish: str = "STOP"
    picture: str | None = None
    """Base64 to send as the picture; ``""`` for none at all."""
    refusal: str | None = None


def rate_limited(seconds: float) -> Special:
    body = json.dumps({"error": {"code": 429, "message": "slow down"}}).encode()
    return Special(status=429, headers={"Retry-After": str(seconds)}, body=body)


def server_error(status: int = 500) -> Special:
    return Special(status=status, body=json.dumps({"error": {"message": "internal"}}).encode())


def raw_answer(body: bytes, status: int = 200) -> Special:
    return Special(status=status, body=body)


def text_answer(text: str, finish: str = "STOP") -> Special:
    return Special(text=text, finish=finish)


def no_picture(reason: str = "NO_IMAGE") -> Special:
    return Special(picture="", finish=reason)


class StandIn:
    """The server; ``url`` is the base URL for Gemini, ``url + "/v1"`` that for OpenAI and OpenRouter."""

    key = "stand-in-key-0123456789"

    def __init__(self) -> None:
        self.requests: list[tuple[str, dict[str, Any]]] = []
        self._specials: list[Special] = []
        self._lock = threading.Lock()
        self._server = ThreadingHTTPServer(("127.0.0.1", 0), _handler(self))
        self._thread = threading.Thread(target=self._server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self._server.server_address[1]}"

    def queue(self, *answers: Special) -> None:
        """Send these first, in order."""
        with self._lock:
            self._specials += answers

    def next_special(self) -> Special | None:
        with self._lock:
            return self._specials.pop(0) if self._specials else None

    def __enter__(self) -> StandIn:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()


class _Refused(Exception):
    def __init__(self, status: int, message: str):
        super().__init__(message)
        self.status = status


def _handler(server: StandIn) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            data = self.rfile.read(int(self.headers.get("Content-Length", 0)))
            try:
                status, headers, body = self._answer(data)
            except _Refused as refused:
                status, headers = refused.status, {}
                body = json.dumps({"error": {"code": refused.status, "message": str(refused)}}).encode()
            with contextlib.suppress(BrokenPipeError):
                self.send_response(status)
                for name, value in {"Content-Type": "application/json", **headers}.items():
                    self.send_header(name, value)
                self.send_header("Content-Length", str(len(body)))
                self.end_headers()
                self.wfile.write(body)

        def _answer(self, data: bytes) -> tuple[int, dict[str, str], bytes]:
            gemini = re.fullmatch(r"/v1(?:beta)?/models/([\w.\-]+):generateContent", self.path)
            _check_key(self.headers, server.key, bool(gemini))
            request = _form(self.headers, data) if "multipart" in self.headers["Content-Type"] else _json(data)
            server.requests.append((self.path, request))
            special = server.next_special()
            if special is not None and special.body is not None:
                return special.status, special.headers, special.body
            shapes = {"/v1/chat/completions": _chat, "/v1/images/edits": _edit}
            shape = _gemini if gemini else shapes.get(self.path)
            if shape is None:
                raise _Refused(404, f"no such path or model: {self.path}")
            return 200, {}, json.dumps(shape(request, special or Special())).encode()

        def log_message(self, *_: object) -> None:
            """Keep the test's output clean."""

    return Handler


def _check_key(headers: Any, key: str, gemini: bool) -> None:
    sent = headers.get("x-goog-api-key") if gemini else headers.get("Authorization")
    if not sent:
        raise _Refused(403 if gemini else 401, "no key was sent")
    if sent != (key if gemini else f"Bearer {key}"):
        raise _Refused(401, f"wrong key: {sent}")


def _json(data: bytes) -> dict[str, Any]:
    try:
        request = json.loads(data)
    except ValueError as error:
        raise _Refused(400, f"not JSON: {error}") from error
    _require(isinstance(request, dict), "the body is not an object")
    return request


def _form(headers: Any, data: bytes) -> dict[str, Any]:
    head = f"Content-Type: {headers['Content-Type']}\r\n\r\n".encode()
    message = email.message_from_bytes(head + data, policy=email.policy.HTTP)
    form: dict[str, Any] = {}
    for part in message.iter_parts():
        name = part.get_param("name", header="content-disposition")
        content = part.get_payload(decode=True)
        if part.get_filename():
            form.setdefault(name, []).append(content)
        else:
            form[name] = content.decode()
    return form


def _require(condition: object, message: str) -> None:
    if not condition:
        raise _Refused(400, message)


# --- Gemini --------------------------------------------------------------------------------------------


def _gemini(request: dict[str, Any], special: Special) -> dict[str, Any]:
    contents = request.get("contents")
    _require(isinstance(contents, list) and contents, "contents: missing")
    for content in contents:
        _require(content.get("role") in ("user", "model"), "contents.role: unknown")
        _require(
            all(("text" in p) != ("inlineData" in p) for p in content["parts"]), "contents.parts: text or inlineData"
        )
    config = request.get("generationConfig", {})
    text = "\n".join(p["text"] for c in contents[:1] for p in c["parts"] if "text" in p)
    pictures = [_decode(p["inlineData"]["data"]) for c in contents for p in c["parts"] if "inlineData" in p]
    if "IMAGE" in config.get("responseModalities", []):
        _require(pictures, "contents: no picture to edit")
        data = _encode(_edited(pictures[0])) if special.picture is None else special.picture
        parts = [{"text": "Here it is."}] + ([{"inlineData": {"mimeType": "image/png", "data": data}}] if data else [])
    else:
        _require(config.get("responseMimeType") == "application/json", "responseMimeType: expected application/json")
        _require("responseJsonSchema" in config, "responseJsonSchema: missing")
        parts = [{"text": _text(special, config["responseJsonSchema"], text, pictures)}]
    candidate = {"content": {"role": "model", "parts": parts}, "finishReason": special.finish, "index": 0}
    return {"candidates": [candidate], "modelVersion": "standin-2026", "usageMetadata": GEMINI_USAGE}


def _text(special: Special, schema: dict[str, Any], prompt: str, pictures: list[np.ndarray]) -> str:
    return special.text if special.text is not None else json.dumps(answer_question(schema, prompt, pictures))


# --- OpenAI and OpenRouter -----------------------------------------------------------------------------


def _chat(request: dict[str, Any], special: Special) -> dict[str, Any]:
    _require(isinstance(request.get("model"), str), "model: missing")
    _require(isinstance(request.get("messages"), list) and request["messages"], "messages: missing")
    parts = list(_chat_parts(request["messages"]))
    pictures = [_decode(p["image_url"]["url"].partition(",")[2]) for p in parts if p["type"] == "image_url"]
    message: dict[str, Any] = {"role": "assistant", "content": "Here it is.", "refusal": special.refusal}
    if "image" in request.get("modalities", []):
        data = _encode(_edited(pictures[0])) if special.picture is None else special.picture
        if data:
            message["images"] = [{"type": "image_url", "image_url": {"url": f"data:image/png;base64,{data}"}}]
    elif special.refusal is None:
        form = request.get("response_format", {})
        _require(
            form.get("type") == "json_schema" and "schema" in form.get("json_schema", {}), "response_format: missing"
        )
        message["content"] = _text(special, form["json_schema"]["schema"], parts[0]["text"], pictures)
    finish = {"STOP": "stop", "MAX_TOKENS": "length"}.get(special.finish, special.finish)
    told = {"object": "chat.completion", "model": "standin-2026", "usage": OPENAI_USAGE}
    return told | {"choices": [{"index": 0, "message": message, "finish_reason": finish}]}


def _chat_parts(messages: list[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    for message in messages:
        _require(message.get("role") in ("system", "user", "assistant"), "messages.role: unknown")
        content = message.get("content")
        yield from [{"type": "text", "text": content}] if isinstance(content, str) else content


def _edit(request: dict[str, Any], special: Special) -> dict[str, Any]:
    _require(request.get("model") and request.get("prompt"), "model, prompt: missing")
    _require(request.get("image[]"), "image[]: missing")
    picture = _decode(base64.b64encode(request["image[]"][0]).decode())
    data = _encode(_edited(picture)) if special.picture is None else special.picture
    return {"created": 0, "data": [{"b64_json": data}] if data else []}


# --- pictures ------------------------------------------------------------------------------------------


def _decode(data: str) -> np.ndarray:
    picture = cv2.imdecode(np.frombuffer(base64.b64decode(data), np.uint8), cv2.IMREAD_COLOR)
    _require(picture is not None, "a picture cannot be decoded")
    return picture


def _encode(picture: np.ndarray) -> str:
    return base64.b64encode(cv2.imencode(".png", picture)[1].tobytes()).decode()


def _edited(picture: np.ndarray) -> np.ndarray:
    """The picture a little larger and brighter: image models keep neither size nor exact colours."""
    larger = cv2.resize(picture, None, fx=1.25, fy=1.25, interpolation=cv2.INTER_CUBIC)
    return np.clip(larger.astype(np.float32) * 1.02 + 1, 0, 255).astype(np.uint8)
