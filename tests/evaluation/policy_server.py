"""A server that follows the rules of openpi's policy server, and can break them on purpose."""

from __future__ import annotations

import threading
import time
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection, serve

from vcage.evaluation.wire import pack, unpack

Infer = Callable[[Mapping[str, Any]], Mapping[str, Any]]


class Drop(Exception):
    """Raised by a policy of a test: the connection is cut without an answer."""


@contextmanager
def policy_server(
    infer: Infer,
    first_answer_s: float = 0.0,
    frames: tuple[Callable[[Any], Any], Callable[[Any], Any]] = (pack, unpack),
) -> Iterator[str]:
    """Serve a policy on loopback; the address.

    Args:
        infer: the policy.
        first_answer_s: how long its first answer takes.
        frames: packs and unpacks messages.
    """
    packed, unpacked = frames
    begun = threading.Event()

    def talk(connection: ServerConnection) -> None:
        connection.send(packed({"name": "test"}))
        while True:
            try:
                observation = unpacked(connection.recv())
                if not begun.is_set():
                    begun.set()
                    time.sleep(first_answer_s)
                connection.send(packed(infer(observation)))
            except ConnectionClosed:
                return
            except Drop:
                connection.socket.close()
                return
            except Exception:  # as openpi does: the traceback as text, then an internal error
                connection.send(traceback.format_exc())
                connection.close(1011, "Internal server error. Traceback included in previous frame.")
                return

    with serve(talk, "127.0.0.1", 0, compression=None, max_size=None) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        yield f"ws://127.0.0.1:{server.socket.getsockname()[1]}"
        server.shutdown()
        thread.join()
