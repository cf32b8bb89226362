"""The HTTP server: which service a request is for, its key, its size, and how the answer is sent."""

from __future__ import annotations

import contextlib
import json
import socket
import struct
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from tests.model_server.anthropic import Anthropic
from tests.model_server.gemini import Gemini
from tests.model_server.ollama import Ollama
from tests.model_server.openai import OpenAi
from tests.model_server.openrouter import OpenRouter
from tests.model_server.service import Call, Refused, Service, form_body, json_body
from tests.model_server.special import Faults, Special

GEMINI, OPENAI, OPENROUTER, ANTHROPIC = PAID = (Gemini(), OpenAi(), OpenRouter(), Anthropic())
"""Those that take a key, and are the same for all servers."""

MOST_BYTES = 20_000_000
"""Of a request; what Gemini takes with pictures in it."""

PAUSE = 0.05
"""Seconds between the bytes of an answer that drips."""


class ModelServer:
    """All services at one port of the loopback interface.

    Args:
        key: the one that is right, for all of them.
        faults: which requests fail where nothing is queued.
        log: gets a line for each request; no key is in it.
    """

    def __init__(
        self,
        *,
        port: int = 0,
        key: str = "stand-in-key-0123456789",
        faults: Faults | None = None,
        log: Callable[[str], None] = lambda _: None,
    ) -> None:
        self.key = key
        self.ollama = Ollama()
        self.requests: list[tuple[str, dict[str, Any]]] = []
        """Path and body of those that asked a model."""
        self.failed = 0
        self.log = log
        self.ended = threading.Event()
        self._faults = faults
        self._specials: list[Special] = []
        self._lock = threading.Lock()
        self._server = ThreadingHTTPServer(("127.0.0.1", port), _handler(self))
        self._thread = threading.Thread(target=self._server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self._server.server_address[1]}"

    @property
    def base_urls(self) -> dict[str, str]:
        """By name of the service, what ``VCAGE_<NAME>_BASE_URL`` should be, and for Ollama ``VCAGE_OLLAMA_URL``."""
        return {service.name: f"{self.url}{service.base}" for service in (*PAID, self.ollama)}

    @property
    def environment(self) -> dict[str, str]:
        """Variables that send all providers here."""
        urls = self.base_urls
        found = {"VCAGE_OLLAMA_URL": urls.pop("ollama")}
        for name, url in urls.items():
            found |= {f"VCAGE_{name.upper()}_BASE_URL": url, f"VCAGE_{name.upper()}_API_KEY": self.key}
        return found

    def queue(self, *answers: Special) -> None:
        """Send these first, in order."""
        with self._lock:
            self._specials += answers

    def forget(self) -> None:
        """Begin anew: nothing is queued, and nothing was asked."""
        with self._lock:
            self._specials.clear()
            self.requests.clear()

    def special(self, path: str, body: dict[str, Any]) -> Special:
        """What to answer to a question of a model."""
        with self._lock:
            self.requests.append((path, body))
            if self._specials:
                return self._specials.pop(0)
            fault = self._faults.draw() if self._faults else None
            self.failed += fault is not None
            return fault or Special()

    def __enter__(self) -> ModelServer:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.ended.set()
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()


def service_of(path: str, headers: Mapping[str, str], ollama: Ollama) -> Service:
    """Which service a request is for; ``/v1/models`` is served by three of them, so headers tell."""
    if path.startswith(f"{ollama.base}/"):
        return ollama
    if path.startswith("/api/v1/"):
        return OPENROUTER
    if path == "/v1/messages" or "anthropic-version" in headers:
        return ANTHROPIC
    if path.startswith("/v1beta/") or ":generateContent" in path or "x-goog-api-key" in headers:
        return GEMINI
    return OPENAI


def _handler(server: ModelServer) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self._serve(b"")

        def do_POST(self) -> None:
            left = int(self.headers.get("Content-Length", 0))
            data = b""
            while left > 0 and (piece := self.rfile.read(min(left, 1 << 20))):
                left -= len(piece)
                data += piece if len(data) <= MOST_BYTES else b""
            self._serve(data)

        def _serve(self, data: bytes) -> None:
            start = time.perf_counter()
            path = self.path.partition("?")[0]
            service, special = service_of(path, self.headers, server.ollama), Special()
            try:
                service.check_key(self.headers, server.key)
                body = self._body(data)
                asks = self.command == "POST" and not path.endswith("/api/show")
                special = server.special(path, body) if asks else special
                if special.status != 200 and special.body is None:
                    raise Refused(special.status, f"the stand-in was told to fail, whatever the key {server.key}")
                reply = {} if special.body is not None else service.answer(self._call(path, body), special)
                status, sent = special.status, json.dumps(reply).encode() if special.body is None else special.body
            except Refused as refused:
                status, sent = refused.status, json.dumps(service.error(refused)).encode()
            # Whoever asked may have gone.
            with contextlib.suppress(ConnectionError):
                self._send(status, sent, special)
            seconds = time.perf_counter() - start
            told = f"{service.name} {self.command} {path} {len(data):,} B: {status}, {len(sent):,} B, {seconds:.3f} s"
            server.log(told if special == Special() else f"{told}, {_told(special)}")

        def _call(self, path: str, body: dict[str, Any]) -> Call:
            return Call(self.command, path, self.headers, body)

        def _body(self, data: bytes) -> dict[str, Any]:
            if self.command == "GET":
                return {}
            if len(data) > MOST_BYTES:
                raise Refused(413, f"Request payload size exceeds the limit: {MOST_BYTES} bytes.")
            multipart = self.headers.get("Content-Type", "").startswith("multipart/form-data")
            return (form_body if multipart else json_body)(self.headers, data)

        def _send(self, status: int, body: bytes, special: Special) -> None:
            if special.manner == "hang":
                server.ended.wait()
                return
            self.send_response(status)
            for name, value in {"Content-Type": "application/json", **special.headers}.items():
                self.send_header(name, value)
            if special.manner != "unsized":
                self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            if special.manner == "drip":
                for byte in body:
                    self.wfile.write(bytes([byte]))
                    if server.ended.wait(PAUSE):
                        return
            elif special.manner == "reset":
                self.wfile.write(body[: len(body) // 2])
                # With no time to linger, closing sends a reset.
                self.connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
                self.connection.close()
            else:
                self.wfile.write(body)

        def log_message(self, *_: object) -> None:
            """The server has a log of its own."""

    return Handler


def _told(special: Special) -> str:
    """What is special about an answer, in short."""
    plain = Special()
    short = replace(special, body=None if special.body is None else special.body[:20])
    return ", ".join(f"{n}={v!r:.40}" for n, v in vars(short).items() if v != getattr(plain, n))
