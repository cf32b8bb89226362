"""The only way out: every request to a model endpoint leaves the process through :class:`Transport`."""

from __future__ import annotations

import copy
import ipaddress
import logging
import math
import re
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from email.utils import parsedate_to_datetime
from http.cookiejar import DefaultCookiePolicy
from typing import Any
from urllib.parse import urlsplit

import requests

from vcage.base.errors import ConfigurationError, EndpointFailed
from vcage.models.endpoint_answer import EndpointAnswer, final_error

LOG = logging.getLogger(__name__)


@dataclass(frozen=True)
class TransportLimits:
    """Bounds on a request.

    Args:
        connect_s, read_s: to connect, and to wait for bytes of the answer.
        total_s: for one answer with all attempts: the wait for bytes restarts with each of them.
        answer_bytes: of an answer; the largest pictures that models draw have 4096 x 4096 pixels.
        attempts: how often a passing fault is tried in all.
        wait_s: longest pause between attempts; a longer ``Retry-After`` ends the request.
    """

    connect_s: float = 10.0
    read_s: float = 180.0
    total_s: float = 300.0
    answer_bytes: int = 48_000_000
    attempts: int = 4
    wait_s: float = 60.0


FilePart = tuple[str, tuple[str, bytes, str]]
"""A multipart file: field name, (file name, content, type)."""

_USER_OF_URL = re.compile(r"//[^/\s@]+@")
"""A proxy's URL may hold user and password."""

_TRANSIENT = (
    requests.ConnectionError,
    requests.Timeout,
    requests.exceptions.ChunkedEncodingError,
    requests.exceptions.ContentDecodingError,
)
"""Errors that may be gone the next time."""


class _Transient(Exception):
    """A fault that may be gone the next time.

    Args:
        problem: in words.
        wait_s: seconds until another attempt is useful; None if unknown.
    """

    def __init__(self, problem: str, wait_s: float | None = None):
        super().__init__(problem)
        self.wait_s = wait_s


class Transport:
    """Requests with time-outs, bounded retries, and errors that state the remedy; keys never show.

    It sends no credentials but those in ``headers``: no ``.netrc``, no cookies, and it follows no redirect. It uses the
    environment's proxies (``HTTPS_PROXY``, ``NO_PROXY``) and certificates (``REQUESTS_CA_BUNDLE``); no proxy for the
    loopback interface, which a proxy could not reach.

    Args:
        base_url: scheme, host and path prefix, e.g. ``https://generativelanguage.googleapis.com``.
        headers: sent with every request; their values count as secrets.
        limits: bounds on each request.
        sleep: waits between attempts; tests pass their own.
    """

    def __init__(
        self,
        base_url: str,
        headers: Mapping[str, str],
        *,
        limits: TransportLimits = TransportLimits(),
        sleep: Callable[[float], None] = time.sleep,
    ):
        if not base_url.startswith(("http://", "https://")):
            raise ConfigurationError(f"{base_url!r} is not a base URL", hint="it starts with http:// or https://")
        self.base_url = base_url.rstrip("/")
        self._limits, self._sleep = limits, sleep
        self._secrets = [part for value in headers.values() for part in value.split() if len(part) > 7]
        self._session = requests.Session()
        self._session.headers.update(headers)
        self._session.auth = _unchanged  # without it requests looks into ~/.netrc, and replaces the key
        self._session.cookies.set_policy(DefaultCookiePolicy(allowed_domains=[]))

    def at(self, base_url: str) -> Transport:
        """The same for another base URL."""
        other = copy.copy(self)
        other.base_url = base_url.rstrip("/")
        return other

    def get_json(self, path: str) -> dict[str, Any]:
        """GET the JSON object at a path in one attempt: callers can do without; raises as :meth:`post`."""
        return self._send("GET", path, 1)

    def post(self, path: str, body: Mapping[str, Any], files: Sequence[FilePart] = ()) -> dict[str, Any]:
        """POST a JSON body, or a form where there are files, and return the JSON object of the answer.

        Args:
            path: below the base URL.
            body: of JSON, or the fields of the form, which are texts.
            files: the parts that are files.

        Raises:
            EndpointFailed: time-outs, broken connections, 429 and 5xx after all attempts, or an answer without JSON.
            ConfigurationError: the endpoint says that key, model or request are wrong.
            ModelRefused: it declines for another reason (other 4xx).
        """
        content: dict[str, Any] = {"data": dict(body), "files": list(files)} if files else {"json": body}
        return self._send("POST", path, self._limits.attempts, **content)

    def _send(self, method: str, path: str, attempts: int, **content: Any) -> dict[str, Any]:
        url = f"{self.base_url}/{path.lstrip('/')}"
        deadline = time.monotonic() + self._limits.total_s
        problem = ""
        for attempt in range(attempts):
            try:
                return self._attempt(method, url, deadline, content)
            except _Transient as fault:
                problem = str(fault)
                wait = min(2.0**attempt, self._limits.wait_s) if fault.wait_s is None else fault.wait_s
            if attempt + 1 == attempts or wait > min(self._limits.wait_s, deadline - time.monotonic()):
                break
            LOG.warning("%s; trying again in %.0f s", problem, wait)
            self._sleep(wait)
        raise EndpointFailed(problem, hint="run the same command again later", details={"url": url})

    def _attempt(self, method: str, url: str, deadline: float, content: Mapping[str, Any]) -> dict[str, Any]:
        try:
            answer = _within(deadline - time.monotonic(), lambda: self._request(method, url, content))
        except TimeoutError:
            raise _Transient(f"{url} gave no whole answer within {self._limits.total_s:.0f} s", math.inf) from None
        except _TRANSIENT as error:
            raise _Transient(f"{url} does not answer: {type(error).__name__}") from None
        except OSError as error:  # all others of requests, and a missing bundle of certificates
            raise ConfigurationError(
                self._redact(f"{url}: {error}"), hint="check the base URL, and any proxy"
            ) from None
        if answer.status < 300 and answer.body:
            return self._json(url, answer)
        if answer.transient:
            raise _Transient(self._problem(url, answer), retry_after(answer.headers.get("Retry-After")))
        raise final_error(answer, self._problem(url, answer))

    def _request(self, method: str, url: str, content: Mapping[str, Any]) -> EndpointAnswer:
        """The answer to one request, whatever its status."""
        timeout, most = (self._limits.connect_s, self._limits.read_s), self._limits.answer_bytes
        options: dict[str, Any] = {"timeout": timeout, "allow_redirects": False, "stream": True, **content}
        host = urlsplit(url).hostname or ""
        if is_loopback(host):
            options["proxies"] = {"no_proxy": host}
        with self._session.request(method, url, **options) as response:
            body = bytearray()
            for piece in response.iter_content(1 << 16):
                body += piece
                if len(body) > most:
                    raise EndpointFailed(
                        f"{url} answered with more than {most:,} bytes",
                        hint="check that the base URL is the API's, or choose another model",
                    )
            return EndpointAnswer(response.status_code, response.headers, bytes(body))

    def _json(self, url: str, answer: EndpointAnswer) -> dict[str, Any]:
        if not isinstance(answer.data, dict):
            raise EndpointFailed(
                f"{url} answered without a JSON object: {self._redact(answer.text[:120])!r}",
                hint="check that the base URL is that of the API",
            )
        return answer.data

    def _problem(self, url: str, answer: EndpointAnswer) -> str:
        detail = str(answer.error.get("message") or answer.text or "nothing")
        shown = "".join(c if c.isprintable() else " " for c in detail)
        return self._redact(f"{url} answered {answer.status}: {' '.join(shown.split())[:300]}")

    def _redact(self, text: str) -> str:
        for secret in self._secrets:
            text = text.replace(secret, "***")
        return _USER_OF_URL.sub("//***@", text)


def _unchanged(request: requests.PreparedRequest) -> requests.PreparedRequest:
    """The request, authorised by its headers alone."""
    return request


def _within(seconds: float, work: Callable[[], EndpointAnswer]) -> EndpointAnswer:
    """The result of some work.

    Raises:
        TimeoutError: it takes longer. It continues in a thread that the end of the process does not wait for: nothing
            else ends a byte-by-byte answer, and neither head nor body of an answer need ever end.
    """
    done: Future[EndpointAnswer] = Future()

    def run() -> None:
        try:
            done.set_result(work())
        except BaseException as error:
            done.set_exception(error)

    threading.Thread(target=run, daemon=True).start()
    return done.result(timeout=max(seconds, 0.0))


def is_loopback(host: str) -> bool:
    """Check if a host is this machine."""
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def retry_after(value: str | None) -> float | None:
    """Seconds that the endpoint asks to wait, given as a number or as a date."""
    if value is None:
        return None
    try:
        return max(0.0, float(value))
    except ValueError:
        pass
    try:
        return max(0.0, parsedate_to_datetime(value).timestamp() - time.time())
    except (TypeError, ValueError):
        return None
