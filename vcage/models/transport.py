"""The one way out: every request to a model endpoint leaves the process through :class:`Transport`."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Mapping, Sequence
from email.utils import parsedate_to_datetime
from typing import Any

import requests

from vcage.base.errors import ConfigurationError, EndpointFailed, ModelRefused

LOG = logging.getLogger(__name__)

TIMEOUT = (10.0, 180.0)
"""Seconds to connect, and to wait for bytes of the answer."""

ATTEMPTS = 4
LONGEST_WAIT = 60.0
"""A ``Retry-After`` beyond this is not waited for, seconds."""

FilePart = tuple[str, tuple[str, bytes, str]]
"""A multipart file: field name, (file name, content, type)."""

_CONFIGURATION = {
    400: ("the endpoint does not accept the request", "check the model id and the base URL"),
    401: ("the endpoint does not accept the key", "check the key"),
    402: ("the account has no credit", "top up the account, or use another provider"),
    403: ("the key may not use this model", "check the key's permissions and the model id"),
    404: ("the endpoint has no such model or path", "check the model id and the base URL"),
    413: ("the request is too large for the endpoint", "use smaller pictures"),
    422: ("the endpoint does not accept the request", "check the model id"),
}


class Transport:
    """Requests with time-outs, bounded retries, and errors that say what to do; keys never show.

    Args:
        base_url: scheme, host and path prefix, e.g. ``https://generativelanguage.googleapis.com``.
        headers: sent with every request; their values count as secrets.
        attempts: how often a passing fault is tried in all.
        sleep: waits between attempts; tests pass their own.
    """

    def __init__(
        self,
        base_url: str,
        headers: Mapping[str, str],
        *,
        attempts: int = ATTEMPTS,
        timeout: tuple[float, float] = TIMEOUT,
        sleep: Callable[[float], None] = time.sleep,
    ):
        if not base_url.startswith(("http://", "https://")):
            raise ConfigurationError(f"{base_url!r} is not a base URL", hint="it starts with http:// or https://")
        self.base_url = base_url.rstrip("/")
        self._attempts = attempts
        self._timeout = timeout
        self._sleep = sleep
        self._secrets = [part for value in headers.values() for part in value.split() if len(part) > 7]
        self._session = requests.Session()
        self._session.headers.update(headers)

    def get_json(self, path: str) -> dict[str, Any]:
        """GET the JSON object at a path, once: whoever looks can go on without; raises as :meth:`post_json`."""
        return self._send("GET", path, 1)

    def post_json(self, path: str, body: Mapping[str, Any]) -> dict[str, Any]:
        """POST a JSON body and return the JSON object of the answer.

        Raises:
            EndpointFailed: time-outs, broken connections, 429 and 5xx after all attempts, or an answer without JSON.
            ConfigurationError: the endpoint says that key, model or request are wrong.
            ModelRefused: it declines for another reason (other 4xx).
        """
        return self._send("POST", path, self._attempts, json=body)

    def post_multipart(self, path: str, fields: Mapping[str, str], files: Sequence[FilePart]) -> dict[str, Any]:
        """POST a form with files and return the JSON object of the answer; raises as :meth:`post_json`.

        Args:
            path: below the base URL.
            fields: name → text.
            files: the parts that are files.
        """
        return self._send("POST", path, self._attempts, data=dict(fields), files=list(files))

    def _send(self, method: str, path: str, attempts: int, **content: Any) -> dict[str, Any]:
        url = f"{self.base_url}/{path.lstrip('/')}"
        problem, wait = "", 0.0
        for attempt in range(attempts):
            if attempt:
                LOG.warning("%s; trying again in %.0f s", problem, wait)
                self._sleep(wait)
            wait = min(2.0**attempt, LONGEST_WAIT)
            try:
                response = self._session.request(method, url, timeout=self._timeout, allow_redirects=False, **content)
            except (requests.ConnectionError, requests.Timeout, requests.exceptions.ChunkedEncodingError) as error:
                problem = f"{url} does not answer: {type(error).__name__}"
                continue
            except requests.RequestException as error:
                raise ConfigurationError(self._redact(f"{url}: {error}"), hint="check the base URL") from None
            if response.status_code < 300:
                return self._json(url, response)
            problem = self._problem(url, response)
            if not (response.status_code in (408, 429) or response.status_code >= 500):
                raise self._final(response.status_code, problem)
            asked = _retry_after(response)
            if asked is not None and asked > LONGEST_WAIT:
                break
            wait = wait if asked is None else asked
        raise EndpointFailed(problem, hint="run the same command again later", details={"url": url})

    def _json(self, url: str, response: requests.Response) -> dict[str, Any]:
        try:
            data = response.json()
        except ValueError:
            data = None
        if not isinstance(data, dict):
            raise EndpointFailed(
                f"{url} answered without a JSON object: {self._redact(response.text[:120])!r}",
                hint="check that the base URL is that of the API",
            )
        return data

    def _problem(self, url: str, response: requests.Response) -> str:
        try:
            error = response.json()["error"]
            detail = str(error["message"] if isinstance(error, dict) else error)
        except (ValueError, KeyError, TypeError):
            detail = response.text
        return self._redact(f"{url} answered {response.status_code}: {' '.join(detail.split())[:300]}")

    def _final(self, status: int, problem: str) -> ConfigurationError | ModelRefused:
        details = {"status": status}
        if status in _CONFIGURATION or 300 <= status < 400:
            what, hint = _CONFIGURATION.get(status, ("the endpoint redirects", "check the base URL"))
            return ConfigurationError(f"{what}: {problem}", hint=hint, details=details)
        return ModelRefused(problem, hint="change the instruction or the model", details=details)

    def _redact(self, text: str) -> str:
        for secret in self._secrets:
            text = text.replace(secret, "***")
        return text


def _retry_after(response: requests.Response) -> float | None:
    """Seconds that the endpoint asks to wait; it says so as a number or as a date."""
    value = response.headers.get("Retry-After")
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
