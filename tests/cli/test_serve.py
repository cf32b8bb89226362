"""``vcage serve`` as a user calls it: Ctrl-C is its end, and no error."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from functools import partial

from websockets.sync.client import connect

from tests.run_folders import Finished
from vcage.evaluation.wire import pack, unpack


def test_ctrl_c_ends_it_with_a_line_on_what_was_served(finished: Finished) -> None:
    command = [sys.executable, "-m", "vcage.cli.main", "serve", str(finished.run.root), "--port", "0", "--no-pictures"]
    # A background job of a shell ignores SIGINT, and so would its children.
    heeds = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, preexec_fn=heeds) as server:
        assert server.stderr is not None and server.stdout is not None
        address = next(line for line in server.stderr if line.startswith("listening at ")).split()[-1]
        with connect(address, compression=None, proxy=None) as connection:
            unpack(connection.recv(decode=False))
            connection.send(pack({"call": "reset", "seed": 1}))
            position = unpack(connection.recv(decode=False))["observation"]["agent_pos"]
            for action in (position, position, "up"):
                connection.send(pack({"call": "step", "action": action}))
                connection.recv(decode=False)
            server.send_signal(signal.SIGINT)  # while a client is there
            assert server.wait(timeout=60) == 0
        lines = server.stderr.read().splitlines()
        assert lines[-1] == "served 1 connection, 1 episode, 2 actions"
        record = json.loads(server.stdout.read().splitlines()[-1])
        assert record["ok"] and record["summary"] == {"served": {"connections": 1, "episodes": 1, "actions": 2}}
