"""The services' stand-in by hand, until it is interrupted."""

from __future__ import annotations

import argparse
import contextlib
import sys
import threading
from functools import partial

from tests.model_server.server import ModelServer
from tests.model_server.special import Faults


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.model_server", description=__doc__)
    parser.add_argument("--port", type=int, default=0, help="on 127.0.0.1 (default: any that is free)")
    parser.add_argument(
        "--key", default="stand-in-key-0123456789", help="that all services take (default: %(default)s)"
    )
    parser.add_argument("--faults", type=float, default=0.0, help="share of the requests that fail (default: none)")
    parser.add_argument("--seed", type=int, default=0, help="of the faults (default: %(default)s)")
    given = parser.parse_args()
    faults = Faults(given.faults, given.seed) if given.faults else None
    with ModelServer(
        port=given.port, key=given.key, faults=faults, log=partial(print, file=sys.stderr, flush=True)
    ) as server:
        for name, value in server.environment.items():
            print(f"export {name}={value}", flush=True)
        with contextlib.suppress(KeyboardInterrupt):
            threading.Event().wait()


if __name__ == "__main__":
    main()
