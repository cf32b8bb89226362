"""An environment of ``vcage serve`` as a Gymnasium environment, without the engine's packages."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray
from websockets.exceptions import InvalidHandshake, InvalidURI
from websockets.sync.client import ClientConnection, connect

from lerobot_env_vcage.frames import pack, unpack

ADDRESS = "ws://127.0.0.1:8100"
"""Where ``vcage serve`` listens by default."""


class ServerError(RuntimeError):
    """The server cannot be reached, or refuses a call; says why, and the way out."""


class RemoteEnv(gymnasium.Env[dict[str, Any], NDArray[np.float32]]):
    """The task of a run; each environment has a connection, and so a world, of its own.

    Observations: ``agent_pos`` (D,), ``pixels`` (camera → (H, W, 3) uint8) and ``environment_state`` (N,), as far as
    the server was started with them. Actions: (D,) absolute targets of joints (rad) and grippers (0 closed, 1 open).
    :attr:`task_description` is the instruction of the present episode.

    Args:
        address: of the server.

    Raises:
        ServerError: nothing answers there.
    """

    def __init__(self, address: str = ADDRESS, render_mode: str | None = "rgb_array"):
        self.address, self.render_mode = address, render_mode
        self._open = ExitStack()
        self._connection = self._open.enter_context(_connection(address))
        self.description: Mapping[str, Any] = unpack(self._connection.recv())
        self.metadata = {"render_modes": ["rgb_array"], "render_fps": self.description["fps"]}
        self.task = self.task_description = self.description["task_description"]
        self._max_episode_steps = int(self.description["max_episode_steps"])
        self.observation_space = observation_space(self.description)
        self.action_space = gymnasium.spaces.Box(self.description["action_low"], self.description["action_high"])

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[dict[str, Any], dict]:
        """Begin the episode of a seed; ``options={"episode": k}`` begins as the k-th recorded one did."""
        super().reset(seed=seed)
        if seed is None:  # drawn here, so that a run of episodes depends on the first seed alone
            seed = int(self.np_random.integers(2**31))
        found = self._asked({"call": "reset", "seed": seed, "options": _plain(options or {})})
        self.task_description = str(found["observation"]["instruction"])
        return self._observation(found), _info(found)

    def step(self, action: NDArray[np.float32]) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        """Carry an action out."""
        found = self._asked({"call": "step", "action": np.asarray(action, np.float32)})
        ended = bool(found["terminated"]), bool(found["truncated"])
        return self._observation(found), float(found["reward"]), *ended, _info(found)

    def render(self) -> NDArray[np.uint8] | None:
        """(H, W, 3) the picture of the first camera; black where the server draws none."""
        picture = self._asked({"call": "render"})["picture"]
        return np.zeros((64, 64, 3), np.uint8) if picture is None else picture

    def close(self) -> None:
        """Close the connection; the server ends its process."""
        self._open.close()

    def _asked(self, request: Mapping[str, Any]) -> Mapping[str, Any]:
        self._connection.send(pack(request))
        answer = unpack(self._connection.recv())
        if error := answer.get("error"):
            raise ServerError(f"{error['message']}; {error['hint']}")
        return answer

    def _observation(self, found: Mapping[str, Any]) -> dict[str, Any]:
        return {name: found["observation"][name] for name in self.observation_space}


def observation_space(description: Mapping[str, Any]) -> gymnasium.spaces.Dict:
    """The space of observations that a server describes."""
    spaces: dict[str, gymnasium.Space[Any]] = {"agent_pos": _numbers(len(description["action_names"]))}
    if description["state_names"]:
        spaces["environment_state"] = _numbers(len(description["state_names"]))
    if cameras := description["cameras"]:
        pictures = {name: gymnasium.spaces.Box(0, 255, tuple(shape), np.uint8) for name, shape in cameras.items()}
        spaces["pixels"] = gymnasium.spaces.Dict(pictures)
    return gymnasium.spaces.Dict(spaces)


def _numbers(count: int) -> gymnasium.spaces.Box:
    return gymnasium.spaces.Box(-np.inf, np.inf, (count,), np.float32)


@contextmanager
def _connection(address: str) -> Iterator[ClientConnection]:
    with ExitStack() as stack:
        try:
            # Neither pings, which a server that draws a scene answers late, nor a proxy.
            opened = connect(address, compression=None, max_size=None, ping_interval=None, proxy=None)
            connection = stack.enter_context(opened)
        except (OSError, InvalidHandshake, InvalidURI) as error:
            raise ServerError(f"no environments at {address} ({error}): start `vcage serve RUN`") from error
        yield connection


def _plain(options: Mapping[str, Any]) -> dict[str, Any]:
    """The options that the server knows; lerobot adds one of its own."""
    return {name: value for name, value in options.items() if name == "episode"}


def _info(found: Mapping[str, Any]) -> dict[str, Any]:
    """The facts that vector environments can stack."""
    return {name: found["info"][name] for name in ("success", "is_success", "seconds")}
