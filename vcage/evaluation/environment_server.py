"""The environments of a run behind a socket, for programs that cannot share this one's packages.

Messages are openpi's frames (:mod:`vcage.evaluation.wire`). The server begins with a map that describes the
environment (:func:`description`). Then it answers each request:

- ``{"call": "reset", "seed": 5}``, or with ``"options": {"episode": 0}``: ``observation`` and ``info``;
- ``{"call": "step", "action": (D,)}``: ``observation``, ``reward``, ``terminated``, ``truncated`` and ``info``;
- ``{"call": "render"}``: ``picture``, (H, W, 3) uint8 or none.

An error is answered by ``{"error": {"code", "message", "hint"}}``; the connection stays open. Each connection has an
environment and a process of its own, as a vector environment needs.
"""

from __future__ import annotations

import logging
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

import gymnasium
from pydantic import BaseModel, NonNegativeInt, ValidationError
from websockets.exceptions import ConnectionClosed
from websockets.frames import CloseCode
from websockets.sync.server import Server, ServerConnection
from websockets.sync.server import serve as listen

from vcage.base.errors import UsageError, VcageError
from vcage.base.workers import Processes
from vcage.evaluation.environment import RunEnv
from vcage.evaluation.environment_options import EnvironmentOptions
from vcage.evaluation.wire import pack, unpack

logger = logging.getLogger(__name__)


class _Recorded(BaseModel, extra="forbid"):
    """The recorded episode whose start is wanted; none for a drawn start."""

    episode: int | None = None


class _Request(BaseModel, extra="forbid"):
    """A request of a client."""

    call: Literal["reset", "step", "render"]
    seed: NonNegativeInt | None = None
    options: _Recorded | None = None
    action: Any = None


@dataclass
class Served:
    """Counts of a server's work so far.

    Attributes:
        connections: that were accepted.
        episodes: that were begun.
        actions: that were carried out.
    """

    connections: int = 0
    episodes: int = 0
    actions: int = 0

    def __str__(self) -> str:
        counted = {"connection": self.connections, "episode": self.episodes, "action": self.actions}
        return ", ".join(f"{count} {what}{'s' * (count != 1)}" for what, count in counted.items())


SENT = "send {'call': 'reset', 'seed': 0}, {'call': 'step', 'action': …} or {'call': 'render'} as openpi's frames"

Task = tuple[Path, EnvironmentOptions, bytes]
"""Run, options, and the frame of a request; an empty one asks for the description."""


@contextmanager
def environment_server(
    run: Path, options: EnvironmentOptions, host: str, port: int, served: Served | None = None
) -> Iterator[Server]:
    """Serve the environments of a run: call ``serve_forever`` of what is entered. At the end connections are closed.

    Args:
        run: folder of the run.
        options: of the environments.
        host: of the interface to listen on.
        port: 0 takes a free one.
        served: counts what is done.

    Raises:
        MissingStage, UnknownName, NoRenderer: see :class:`~vcage.evaluation.environment.RunEnv`.
        UsageError: the port is taken, or there is no such interface.
    """
    served, counting, connected = served or Served(), threading.Lock(), set[ServerConnection]()
    first, _ = answer((run, options, b""))  # before anyone connects, so that what is wrong with the run is said here

    def count(connections: int = 0, episodes: int = 0, actions: int = 0) -> None:
        with counting:
            served.connections += connections
            served.episodes += episodes
            served.actions += actions

    def talk(connection: ServerConnection) -> None:
        client = "{}:{}".format(*connection.remote_address[:2])
        logger.info("%s is connected", client)
        count(connections=1)
        connected.add(connection)
        with Processes(answer, 1) as process:
            try:
                connection.send(first)
                while True:
                    process.submit((run, options, connection.recv(decode=False)))
                    frame, call = next(process.results())
                    count(episodes=call == "reset", actions=call == "step")
                    connection.send(frame)
            except ConnectionClosed:
                logger.info("%s is gone", client)
            finally:
                connected.discard(connection)

    try:
        listening = listen(talk, host, port, compression=None, max_size=None, ping_interval=None)
    except (OSError, OverflowError) as error:
        reason = getattr(error, "strerror", None) or error
        raise UsageError(f"{host}:{port} cannot be served: {reason}", hint="give another --port or --host") from error
    with listening as server:
        try:
            yield server
        finally:
            for connection in list(connected):  # earlier versions of websockets wait for clients to go
                connection.close(CloseCode.GOING_AWAY)


def description(env: RunEnv) -> dict[str, Any]:
    """The facts that a client needs before it acts: the task, and names, sizes and limits of its numbers."""
    observed, acted = env.observation_space, env.action_space
    assert isinstance(observed, gymnasium.spaces.Dict)
    assert isinstance(acted, gymnasium.spaces.Box)
    pictures = observed.spaces.get("pixels")
    cameras = pictures.spaces if isinstance(pictures, gymnasium.spaces.Dict) else {}
    return {
        "task_description": env.task_description,
        "fps": env.fps,
        "max_episode_steps": env.get_wrapper_attr("_max_episode_steps"),
        "action_names": env.joint_names,
        "action_low": acted.low,
        "action_high": acted.high,
        "cameras": {name: list(space.shape or ()) for name, space in cameras.items()},
        "state_names": env.state_layout.names if env.options.environment_state else [],
    }


def answer(task: Task) -> tuple[bytes, str]:
    """The frame that answers a request, in the process of one connection, and the call that was done (empty: none)."""
    run, options, frame = task
    env = _environment(run, options)
    if not frame:
        return pack(description(env)), ""
    try:
        request = _Request.model_validate(unpack(frame))
        return pack(_answered(env, request)), request.call
    except ValidationError as error:
        first = error.errors()[0]
        found = UsageError(f"request: {'.'.join(map(str, first['loc']))}: {first['msg']}", hint=SENT)
    except ValueError as error:
        found = UsageError(str(error), hint=SENT)
    except VcageError as error:
        found = error
    return pack({"error": {"code": found.code, "message": found.message, "hint": found.way_out}}), ""


@lru_cache(maxsize=1)
def _environment(run: Path, options: EnvironmentOptions) -> RunEnv:
    """The environment of this process."""
    return RunEnv(run, options)


def _answered(env: RunEnv, request: _Request) -> dict[str, Any]:
    if request.call == "render":
        return {"picture": env.render()}
    if request.call == "reset":
        options = request.options.model_dump() if request.options else None
        observation, info = env.reset(seed=request.seed, options=options)
        return {"observation": observation, "info": info}
    if request.action is None:
        raise UsageError("the step has no action", hint="send {'call': 'step', 'action': …}")
    observation, reward, terminated, truncated, info = env.step(request.action)
    ended = {"reward": reward, "terminated": terminated, "truncated": truncated}
    return {"observation": observation, **ended, "info": info}
