"""Environments behind a socket, for the client package and for programs that send frames themselves."""

from __future__ import annotations

import importlib
import sys
import threading
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import SyncVectorEnv
from websockets.sync.client import ClientConnection, connect

from tests.run_folders import Finished
from vcage.base.errors import MissingStage, UsageError
from vcage.base.files import resource
from vcage.evaluation.environment import make_env
from vcage.evaluation.environment_options import EnvironmentOptions
from vcage.evaluation.environment_server import environment_server
from vcage.evaluation.wire import pack, unpack

STATE_ONLY = EnvironmentOptions(pictures=False, environment_state=True)


@pytest.fixture(scope="module")
def address(finished: Finished) -> Iterator[str]:
    with environment_server(finished.run.root, STATE_ONLY, "127.0.0.1", 0) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        yield f"ws://127.0.0.1:{server.socket.getsockname()[1]}"
        server.shutdown()
        thread.join()


@pytest.fixture(scope="module")
def connection(address: str) -> Iterator[ClientConnection]:
    """One for all requests that do nothing, as each connection starts a process."""
    with connect(address, compression=None, proxy=None) as one:
        one.recv(decode=False)
        yield one


@pytest.fixture(scope="module")
def client() -> Iterator[ModuleType]:
    folder = str(resource("clients", "lerobot_env_vcage"))
    sys.path.insert(0, folder)
    yield importlib.import_module("lerobot_env_vcage.environment")
    sys.path.remove(folder)


def test_the_client_sees_and_does_what_the_environment_does(
    address: str, client: ModuleType, finished: Finished
) -> None:
    here = make_env(finished.run.root, finished.context, pictures=False, environment_state=True)
    with closing(client.RemoteEnv(address)) as env:
        near, _ = here.reset(seed=4)
        far, info = env.reset(seed=4)
        assert np.array_equal(far["environment_state"], near["environment_state"])
        assert env.task_description == near["instruction"]
        assert info == {"success": False, "is_success": False, "seconds": 0.0}
        action = near["agent_pos"] + 0.05
        assert np.array_equal(env.step(action)[0]["agent_pos"], here.step(action)[0]["agent_pos"])


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_gymnasium_finds_no_fault_with_the_client(address: str, client: ModuleType) -> None:
    with closing(client.RemoteEnv(address)) as env:
        check_env(env, skip_render_check=True)


def test_each_connection_has_a_world_of_its_own(address: str, client: ModuleType) -> None:
    with closing(SyncVectorEnv([lambda: client.RemoteEnv(address)] * 2)) as many:
        seen, _ = many.reset(seed=[5, 6])
        assert not np.array_equal(*seen["environment_state"])


def test_a_recorded_episode_can_be_begun_from_afar(address: str, client: ModuleType) -> None:
    with closing(client.RemoteEnv(address)) as env:
        one, other = (env.reset(options={"episode": 0})[0] for _ in range(2))
        assert np.array_equal(one["environment_state"], other["environment_state"])
        with pytest.raises(client.ServerError, match="unknown accepted episode '99'"):
            env.reset(options={"episode": 99})


@pytest.mark.parametrize(
    ("sent", "message"),
    [
        ({"call": "explode"}, "request: call: Input should be 'reset', 'step' or 'render'"),
        ({}, "request: call: Field required"),
        ([1, 2], "request: "),
        ({"call": "reset", "sed": 5}, "request: sed: Extra inputs are not permitted"),
        ({"call": "step"}, "the step has no action"),
        ({"call": "step", "action": np.zeros(3)}, "no episode has begun"),
        ({"call": "reset", "seed": -1}, "seed"),
        ({"call": "reset", "seed": "five"}, "seed"),
        ({"call": "reset", "options": [1]}, "options"),
        ({"call": "step", "action": "up"}, "no episode has begun"),
    ],
)
def test_a_wrong_request_is_named_and_the_connection_stays(
    connection: ClientConnection, sent: Any, message: str
) -> None:
    for frame in (pack(sent), b"\xc1 is no MessagePack"):
        connection.send(frame)
        error = unpack(connection.recv(decode=False))["error"]
        assert error["code"] and error["hint"]
        if frame == pack(sent):
            assert message in error["message"]


def test_a_client_without_a_server_says_what_to_start(client: ModuleType) -> None:
    with pytest.raises(client.ServerError, match=r"no environments at ws://127\.0\.0\.1:9 .*: start `vcage serve RUN`"):
        client.RemoteEnv("ws://127.0.0.1:9")


def test_a_run_without_episodes_is_refused_before_anyone_connects(finished: Finished, tmp_path: Path) -> None:
    with pytest.raises(MissingStage), environment_server(tmp_path, STATE_ONLY, "127.0.0.1", 0):
        pass


def test_a_taken_port_is_named(finished: Finished, address: str) -> None:
    port = int(address.rpartition(":")[2])
    taken = pytest.raises(UsageError, match=f"127.0.0.1:{port} cannot be served: Address already in use")
    with taken, environment_server(finished.run.root, STATE_ONLY, "127.0.0.1", port):
        pass


@pytest.mark.parametrize(("host", "port"), [("127.0.0.1", 70_000), ("no-such-host.invalid", 0)])
def test_an_address_that_cannot_be_is_named(finished: Finished, host: str, port: int) -> None:
    wrong = pytest.raises(UsageError, match=f"{host}:{port} cannot be served: ")
    with wrong, environment_server(finished.run.root, STATE_ONLY, host, port):
        pass
