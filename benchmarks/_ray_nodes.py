"""Nodes of a Ray cluster on the loopback of this machine, begun by ``ray start`` as docs/campaigns.md says."""

from __future__ import annotations

import contextlib
import os
import secrets
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

import numpy as np
import psutil

from vcage.campaigns.ray_cluster import OBJECT_STORE_BYTES

RAY = [sys.executable, "-m", "ray.scripts.scripts"]
"""Ray's command, of this environment."""

ADDRESS = "127.0.0.1"


@dataclass
class RayNodes:
    """A head and other nodes, each a tree of processes below this one.

    Args:
        workers: nodes beside the head.
        cpus: processors of each node.
        hidden: from other machines; else they have this machine's address, as those of a cluster have.
        begin_within_s: after which a node should answer.
    """

    workers: int = 1
    cpus: int = 1
    hidden: bool = True
    begin_within_s: float = 60.0
    _folder: Path = field(default_factory=lambda: Path(tempfile.mkdtemp(prefix="ray-", dir="/tmp")))  # sockets: short
    _token: str = field(default_factory=lambda: secrets.token_hex(32))
    _port: int = 0
    _head: subprocess.Popen[bytes] | None = None
    _others: list[subprocess.Popen[bytes]] = field(default_factory=list)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for node in (*self._others, self._head):
            if node is not None:
                _kill_tree(node)
        shutil.rmtree(self._folder, ignore_errors=True)

    @property
    def address(self) -> str:
        """``HOST:PORT`` of the head."""
        return f"{ADDRESS}:{self._port}"

    @property
    def environment(self) -> dict[str, str]:
        """Variables for all processes of this cluster, that no other cluster of this machine is touched."""
        token = {"RAY_AUTH_MODE": "token", "RAY_AUTH_TOKEN": self._token}
        return {"RAY_TMPDIR": str(self._folder), "RAY_USAGE_STATS_ENABLED": "0", **token}

    def start(self) -> None:
        """Start the head, or another where it was lost, and as many nodes as are missing.

        Raises:
            TimeoutError: the head does not answer.
        """
        if self._head is None or not self._answers():
            self._others.clear()  # they belong to a head that is lost, and end by themselves
            self._port = _free_port()
            self._head = self._started("--head", f"--port={self._port}", "--include-dashboard=false")
            self._await_head()
        self._others = [node for node in self._others if node.poll() is None]
        while len(self._others) < self.workers:
            self._others.append(self._started(f"--address={self.address}"))

    def kill_node(self, rng: np.random.Generator) -> set[int] | None:
        """Kill all processes of a node but the head, as a power failure does; their ids, or None if there is none."""
        if not self._others:
            return None
        return _kill_tree(self._others.pop(int(rng.integers(len(self._others)))))

    def kill_head(self) -> bool:
        """Kill the server that knows the cluster; False if there is none."""
        for one in psutil.Process(self._head.pid).children(recursive=True) if self._head else ():
            with contextlib.suppress(psutil.NoSuchProcess):
                if one.name() == "gcs_server":
                    one.kill()
                    return True
        return False

    def _started(self, *options: str) -> subprocess.Popen[bytes]:
        common = [
            *([f"--node-ip-address={ADDRESS}"] if self.hidden else []),
            f"--num-cpus={self.cpus}",
            "--disable-usage-stats",
            "--block",
        ]
        return subprocess.Popen(
            [*RAY, "start", *options, *common, f"--object-store-memory={OBJECT_STORE_BYTES}"],
            env=_environment() | self.environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )

    def _await_head(self) -> None:
        end = time.monotonic() + self.begin_within_s
        while not self._answers():
            if time.monotonic() > end:
                raise TimeoutError(f"the head of a Ray cluster at {self.address} does not answer")
            time.sleep(0.2)

    def _answers(self) -> bool:
        with contextlib.suppress(OSError):
            socket.create_connection((ADDRESS, self._port), 1.0).close()
            return True
        return False


def _environment() -> dict[str, str]:
    return {name: value for name, value in os.environ.items() if not name.startswith("RAY_")}


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind((ADDRESS, 0))
        return probe.getsockname()[1]


def _kill_tree(node: subprocess.Popen[bytes]) -> set[int]:
    """Kill a process and all below it."""
    try:
        tree = [psutil.Process(node.pid), *psutil.Process(node.pid).children(recursive=True)]
    except psutil.NoSuchProcess:
        tree = []
    for one in tree:
        with contextlib.suppress(psutil.NoSuchProcess):
            one.kill()
    node.wait()
    return {one.pid for one in tree}
