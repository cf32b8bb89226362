"""The policy server of the benchmarks, in a thread of a test."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from benchmarks._policy import serve
from benchmarks._policy.serve import Infer, address_of
from vcage.evaluation.wire import pack, unpack


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
    waits = iter([first_answer_s])

    def late(observation: Mapping[str, Any]) -> Mapping[str, Any]:
        time.sleep(next(waits, 0.0))
        return infer(observation)

    with serve.policy_server(lambda: late, "test", frames) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        yield address_of(server)
        server.shutdown()
        thread.join()
