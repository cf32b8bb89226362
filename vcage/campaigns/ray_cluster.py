"""A connection to a Ray cluster, or a cluster of this machine alone, by its loopback.

Ray waits for minutes where nothing answers, takes the signals of its program, and reports on its users: none of that
happens here.
"""

from __future__ import annotations

import importlib
import logging
import os
import re
import signal
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vcage.base.commands import pip_command
from vcage.base.errors import ClusterLost, MissingDependency

logger = logging.getLogger(__name__)

AUTO = "auto"
"""In place of an address: the cluster that runs on this machine, or else one that is started for the campaign."""

LOCAL_ONLY = "RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER"
"""Ray's variable that makes 127.0.0.1 the address of this machine, in place of one that others can reach."""

EARLY_WORKERS = "RAY_prestart_worker_first_driver"
"""Ray's variable for processes, one for each processor, that a new cluster starts unasked; no actor takes one."""

OBJECT_STORE_BYTES = 100_000_000
"""Nothing but paths and records goes through it; Ray's default is a third of the memory."""


@dataclass(frozen=True)
class RaySettings:
    """Settings of the driver.

    Args:
        look_every_s: longest time between two looks at the cluster.
        restarts: of an actor by Ray, before another takes its place.
        freed_within_s: time within which a lost actor should release its job.
        look_for_freed_s: time between two looks for the release.
        rest_s: pause of an actor whose disk is full, or cannot write the folder; doubled each time,
        longest_rest_s: up to this.
        unborn: actors in a row that end before they begin, after which the driver ends.
        seen_within_s: time within which a file written by an actor should appear here.
        actor_bytes: free memory for each on a cluster of this machine alone; measured, one takes 1.41 GB at most.
        warn_after_s: time without any actor that has found a place, before a warning.
    """

    look_every_s: float = 5.0
    restarts: int = 3
    freed_within_s: float = 5.0
    look_for_freed_s: float = 0.2
    rest_s: float = 10.0
    longest_rest_s: float = 300.0
    unborn: int = 5
    seen_within_s: float = 10.0
    actor_bytes: int = 1_600_000_000
    warn_after_s: float = 60.0


SETTINGS = RaySettings()


def address_of(text: str) -> str:
    """Check an address as a user gives it.

    Raises:
        ValueError: it is neither ``auto`` nor ``HOST:PORT``.
    """
    found = re.fullmatch(r"[^\s:/]+:(\d{1,5})", text)
    if text != AUTO and (found is None or int(found[1]) > 65535):
        raise ValueError(f"{text!r} is no address; expected {AUTO}, or HOST:PORT as `ray start --head` prints it")
    return text


@contextmanager
def connected(address: str, cpus: int) -> Iterator[Any]:
    """Connect to a cluster inside the block; yields the module ``ray``.

    Args:
        address: see :func:`address_of`.
        cpus: of a cluster that is started here.

    Raises:
        MissingDependency: Ray is not installed.
        ClusterLost: no cluster answers at the address, or this machine is no node of it.
    """
    found = _running() if address == AUTO else _answering(address)
    os.environ["RAY_USAGE_STATS_ENABLED"] = "0"
    os.environ[EARLY_WORKERS] = "0"
    if found is None or found.startswith("127."):
        os.environ[LOCAL_ONLY] = "0"
    handlers = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGINT)}
    ray = _ray()
    started = {"num_cpus": cpus, "include_dashboard": False, "object_store_memory": OBJECT_STORE_BYTES}
    try:
        try:
            _join(ray, found, {} if found else started)
        except (ConnectionError, RuntimeError, ValueError) as error:
            raise _not_joined(found, error) from error
        finally:
            for number, handler in handlers.items():
                signal.signal(number, handler)
        logger.info("Ray cluster: %s", found or "of this machine")
        yield ray
    finally:
        ray.shutdown()


def require_head(address: str) -> None:
    """Check that the head of a cluster still answers.

    Raises:
        ClusterLost: it does not.
    """
    if not _answers(address):
        raise ClusterLost(
            f"the head of the Ray cluster at {address} does not answer any more",
            hint="start the cluster again and run the same command; what is finished is kept",
        )


def last_line(error: Exception) -> str:
    """The last line of an error of Ray's, which says the most."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    return " ".join(lines[-1:])[:300] or type(error).__name__


def _ray() -> Any:
    try:
        ray = importlib.import_module("ray")
    except ImportError as error:
        raise MissingDependency(f"Ray cannot be imported: {error}", command=pip_command("vcage[ray]")) from error
    ray._private.worker._worker_logs_enabled = False  # they would go to stdout, beside the driver's own messages
    return ray


def _not_joined(address: str | None, error: Exception) -> ClusterLost:
    """The error of a cluster that cannot be joined, or not be started where there is no address."""
    reason = " ".join(str(error).split())[:400]
    if address is None:
        return ClusterLost(
            f"cannot start a Ray cluster on this machine: {reason}", hint="look into /tmp/ray, Ray's logs"
        )
    return ClusterLost(
        f"cannot join the Ray cluster at {address}: {reason}",
        hint="make this machine a node of it, with the same versions of Python and Ray, and the same token if "
        f"it has one (RAY_AUTH_MODE=token, ~/.ray/auth_token): ray start --address={address}",
    )


def _join(ray: Any, address: str | None, started: dict[str, Any]) -> None:
    """Join a cluster, or start one.

    ``ray start --head`` uses a token as soon as its user has one, which ``ray.init`` makes with each cluster that it
    starts. Given an address, ``ray.init`` uses it only where ``RAY_AUTH_MODE`` says so.
    """

    def init() -> None:
        ray.init(
            address=address or "local",
            log_to_driver=False,
            configure_logging=False,
            # Actors draw, so one without a GPU of its own must see those of its node.
            runtime_env={"env_vars": {"RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO": "0"}},
            **started,
        )

    try:
        init()
    except ConnectionError:
        tokens = importlib.import_module("ray._private.authentication.authentication_token_setup")
        may_use_token = address is not None and tokens.AUTH_MODE_ENV_VAR not in os.environ
        if not may_use_token or not tokens.maybe_enable_token_auth_if_token_available(warn_if_disabled=False):
            raise
        init()


def _answering(address: str) -> str:
    """An address at which something listens.

    Raises:
        ClusterLost: nothing does.
    """
    host, _, port = address.rpartition(":")
    if host == "localhost" or host.startswith("127."):
        # A head that can be reached from elsewhere too goes by that address.
        reachable = f"{_own_address()}:{port}"
        address = reachable if _answers(reachable) else f"127.0.0.1:{port}"
    if not _answers(address):
        raise ClusterLost(
            f"no Ray cluster answers at {address}",
            hint=f"check the address, or start a head there: ray start --head --port={port}",
        )
    return address


def _running() -> str | None:
    """The address of the cluster that this machine belongs to; None if there is none.

    Raises:
        ClusterLost: ``RAY_ADDRESS`` names one that does not answer.
    """
    if named := os.environ.get("RAY_ADDRESS"):
        return _answering(named)
    folder = os.environ.get("RAY_TMPDIR") or os.environ.get("TMPDIR") or "/tmp"
    try:  # written by `ray start`
        address = (Path(folder) / "ray" / "ray_current_cluster").read_text(encoding="utf-8").strip()
    except OSError:
        return None
    return address if _answers(address) else None


def _answers(address: str, within_s: float = 5.0) -> bool:
    host, _, port = address.rpartition(":")
    try:
        socket.create_connection((host, int(port)), within_s).close()
    except (OSError, ValueError):
        return False
    return True


def _own_address() -> str:
    """The address of this machine by which others reach it; nothing is sent to find it."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("8.8.8.8", 80))
        except OSError:
            return "127.0.0.1"
        return probe.getsockname()[0]
