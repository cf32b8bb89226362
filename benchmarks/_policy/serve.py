"""``python -m benchmarks._policy.serve WEIGHTS``: a trained policy behind openpi's protocol, on loopback.

Its address is the first line on stdout.
"""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable, Mapping
from copy import copy
from pathlib import Path
from typing import Any

from websockets.exceptions import ConnectionClosed
from websockets.sync.server import Server, ServerConnection, serve

from vcage.evaluation.wire import pack, unpack

Infer = Callable[[Mapping[str, Any]], Mapping[str, Any]]


class Drop(Exception):
    """Raised by a policy: the connection is cut without an answer, as when a server is killed."""


def policy_server(
    begin: Callable[[], Infer], name: str, frames: tuple[Callable[[Any], Any], Callable[[Any], Any]] = (pack, unpack)
) -> Server:
    """A server of a policy on a free port of loopback, by the rules of openpi's; call ``serve_forever`` of it.

    Args:
        begin: the policy for a connection: it may remember what it was asked there.
        name: of the policy, told to clients.
        frames: packs and unpacks messages.
    """
    packed, unpacked = frames

    def talk(connection: ServerConnection) -> None:
        connection.send(packed({"name": name}))
        try:
            infer = begin()
            while True:
                connection.send(packed(infer(unpacked(connection.recv(decode=False)))))
        except ConnectionClosed:
            return
        except Drop:
            connection.socket.close()
        except Exception:  # any: openpi's servers tell the client what went wrong, and close
            connection.send(traceback.format_exc())
            connection.close(1011, "Internal server error. Traceback included in previous frame.")

    return serve(talk, "127.0.0.1", 0, compression=None, max_size=None, ping_interval=None)


def address_of(server: Server) -> str:
    """The address for clients."""
    return f"ws://127.0.0.1:{server.socket.getsockname()[1]}"


def main(weights: Path) -> None:
    """Serve a trained policy until this process ends."""
    import torch

    from benchmarks._policy.policy import Policy

    torch.set_num_threads(1)
    policy = Policy.read(weights)
    with policy_server(lambda: copy(policy).infer, "vcage benchmark") as server:
        print(address_of(server), flush=True)
        server.serve_forever()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
