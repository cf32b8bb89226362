"""``python -m benchmarks._policy.serve WEIGHTS``: a trained policy behind openpi's protocol, on loopback.

Its address is the first line on stdout.
"""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection
from websockets.sync.server import serve as serve_sockets

from benchmarks._policy.policy import Policy
from vcage.evaluation.wire import pack, unpack


def serve(infer: Callable[[Mapping[str, Any]], Mapping[str, Any]], port: int = 0) -> None:
    """Serve a policy until this process ends; port 0 takes a free one."""

    def talk(connection: ServerConnection) -> None:
        connection.send(pack({"policy": "vcage benchmark"}))
        try:
            while True:
                connection.send(pack(infer(unpack(connection.recv(decode=False)))))
        except ConnectionClosed:
            return
        except Exception:  # any: openpi's servers tell the client what went wrong, and close
            connection.send(traceback.format_exc())
            connection.close(1011, "Internal server error. Traceback included in previous frame.")

    with serve_sockets(talk, "127.0.0.1", port, compression=None, max_size=None, ping_interval=None) as server:
        print(f"ws://127.0.0.1:{server.socket.getsockname()[1]}", flush=True)
        server.serve_forever()


if __name__ == "__main__":
    import torch

    torch.set_num_threads(1)
    serve(Policy.read(Path(sys.argv[1])).infer)
