"""A policy behind a socket, as openpi serves it: metadata first, then an answer to each observation.

Source: ``websocket_policy_server.py`` and ``websocket_client_policy.py`` of
https://github.com/Physical-Intelligence/openpi (the protocol, not the code).
"""

from __future__ import annotations

import logging
import time
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any
from urllib.parse import urlparse

from websockets.exceptions import ConnectionClosed, InvalidHandshake, InvalidURI
from websockets.sync.client import ClientConnection, connect

from vcage.base.errors import EndpointFailed, UsageError
from vcage.evaluation.policy import PolicyFailed
from vcage.evaluation.wire import pack, unpack

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class RemoteSettings:
    """Patience with a server.

    Args:
        connect_s: until it listens; a server loads its weights first.
        answer_s: for an answer; the first compiles the model.
        tries: connections for one answer, as a connection may drop.
        pause_s: between two tries to connect.
    """

    connect_s: float = 60.0
    answer_s: float = 300.0
    tries: int = 3
    pause_s: float = 0.5


class RemotePolicy:
    """Asks a policy server. Each episode has a connection of its own, so that a server may reset with it.

    Args:
        address: ``ws://HOST:PORT``.
        settings: patience.
        key: for the header ``Authorization: Api-Key``, which a proxy may ask for.

    Raises:
        UsageError: that is no such address.
    """

    def __init__(self, address: str, settings: RemoteSettings | None = None, key: str | None = None):
        found = urlparse(address)
        if found.scheme not in ("ws", "wss") or not found.hostname:
            raise UsageError(f"{address!r} is no address of a server", hint="give ws://HOST:PORT")
        self.address, self.settings = address, settings or RemoteSettings()
        self.metadata: Mapping[str, Any] = {}
        self._headers = {"Authorization": f"Api-Key {key}"} if key else {}
        self._connection: ClientConnection | None = None
        self._open = ExitStack()

    def reset(self) -> None:
        """Close the connection: the next observation opens another."""
        self._connection = None
        self._open.close()

    def infer(self, observation: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return the server's answer.

        Raises:
            EndpointFailed: it cannot be reached, drops every connection, or is too slow.
            PolicyFailed: it reports an error, or answers no map.
        """
        frame, failure = pack(observation), ""
        for _ in range(self.settings.tries):
            try:
                return self._answer(frame)
            except ConnectionClosed as error:
                failure = str(error)
                logger.warning("%s dropped the connection (%s)", self.address, failure)
                self.reset()
        raise EndpointFailed(
            f"{self.address} dropped the connection {self.settings.tries} times: {failure}", hint="see the server's log"
        )

    def _answer(self, frame: bytes) -> Mapping[str, Any]:
        if self._connection is None:
            self._connection = self._connected()
        self._connection.send(frame)
        answer = self._message(self._connection)
        if not isinstance(answer, Mapping):
            raise PolicyFailed(f"{self.address} answers a {type(answer).__name__}; expected a map")
        return answer

    def _connected(self) -> ClientConnection:
        """A connection whose first message, the metadata, was read."""
        until, told = time.monotonic() + self.settings.connect_s, False
        while True:
            try:
                # Neither pings nor a proxy: a server that compiles answers no ping, and loopback needs no proxy.
                opened = connect(
                    self.address,
                    compression=None,
                    max_size=None,
                    ping_interval=None,
                    proxy=None,
                    additional_headers=self._headers,
                )
                found = self._open.enter_context(opened)
                break
            except (OSError, InvalidHandshake, InvalidURI) as error:
                if time.monotonic() > until:
                    raise EndpointFailed(
                        f"{self.address} cannot be reached within {self.settings.connect_s:g} s: {error}",
                        hint="start the policy server, or check the address",
                    ) from error
                if not told:
                    logger.info("waiting for %s: %s", self.address, error)
                told = True
                time.sleep(self.settings.pause_s)
        self.metadata = self._message(found)
        return found

    def _message(self, connection: ClientConnection) -> Any:
        """The next message.

        Raises:
            EndpointFailed: none comes.
            PolicyFailed: it is text, which is the traceback of an error there; or it is no frame.
        """
        try:
            found = connection.recv(timeout=self.settings.answer_s)
        except TimeoutError:
            self.reset()
            raise EndpointFailed(
                f"{self.address} did not answer within {self.settings.answer_s:g} s", hint="see the server's log"
            ) from None
        if isinstance(found, str):
            self.reset()
            last = found.strip().splitlines()[-1:] or ["no reason"]
            raise PolicyFailed(f"{self.address} reports an error: {last[0]}", details={"traceback": found})
        try:
            return unpack(found)
        except ValueError as error:
            raise PolicyFailed(f"{self.address}: {error}") from error
