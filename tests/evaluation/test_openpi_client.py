"""The real openpi-client: its policy against our server, its frames against ours, and its environment's loop."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from openpi_client import msgpack_numpy
from openpi_client.action_chunk_broker import ActionChunkBroker
from openpi_client.image_tools import resize_with_pad
from openpi_client.websocket_client_policy import WebsocketClientPolicy

from tests.evaluation.policy_server import policy_server
from vcage.evaluation.payload import Payload, payload
from vcage.evaluation.remote_policy import RemotePolicy
from vcage.evaluation.wire import pack, unpack

OBSERVATION = {
    "pixels": {name: np.full((480, 640, 3), shade, np.uint8) for shade, name in enumerate(("cam_high", "front"))},
    "agent_pos": np.arange(14, dtype=np.float32),
    "environment_state": np.ones(9, np.float32),
    "instruction": "Put the block on the plate.",
}


def states_of(observation: Mapping[str, Any]) -> Mapping[str, Any]:
    """Answers five times the state that it was sent, under either name, and the prompt."""
    state = observation["state"] if "state" in observation else observation["observation/state"]
    return {"actions": np.stack([state * n for n in range(5)]), "prompt": observation["prompt"]}


@pytest.mark.parametrize("kind", ["aloha", "generic"])
def test_openpis_client_is_answered_by_our_server_as_ours_is(kind: Payload) -> None:
    sent = payload(OBSERVATION, kind)
    with policy_server(states_of) as address:
        real = WebsocketClientPolicy(address)
        assert real.get_server_metadata() == {"name": "test"}
        theirs, ours = real.infer(sent), RemotePolicy(address).infer(sent)
    np.testing.assert_array_equal(theirs["actions"], np.outer(np.arange(5), OBSERVATION["agent_pos"]))
    assert theirs["prompt"] == ours["prompt"] == OBSERVATION["instruction"]
    np.testing.assert_array_equal(theirs["actions"], ours["actions"])


@pytest.mark.parametrize("kind", ["aloha", "generic"])
def test_a_server_with_openpis_own_frames_reads_what_we_send(kind: Payload) -> None:
    seen: dict[str, Any] = {}

    def look(observation: Mapping[str, Any]) -> Mapping[str, Any]:
        seen.update(observation)
        return states_of(observation)

    with policy_server(look, frames=(msgpack_numpy.packb, msgpack_numpy.unpackb)) as address:
        assert RemotePolicy(address).infer(payload(OBSERVATION, kind))["actions"].shape == (5, 14)
    if kind == "aloha":
        assert sorted(seen) == ["images", "prompt", "state"] and list(seen["images"]) == ["cam_high"]
        assert seen["images"]["cam_high"].shape == (3, 480, 640) and seen["images"]["cam_high"].dtype == np.uint8
    else:
        assert sorted(seen) == [
            "observation/cam_high",
            "observation/environment_state",
            "observation/front",
            "observation/state",
            "prompt",
        ]
        assert resize_with_pad(seen["observation/front"], 224, 224).shape == (224, 224, 3)
    assert seen["prompt"] == OBSERVATION["instruction"]


def test_frames_are_openpis_byte_for_byte() -> None:
    message = {"a": np.eye(3, dtype=np.float32), "b": np.float64(0.5), "c": [1, "zwei", None], "d": {"e": np.uint8(7)}}
    assert pack(message) == msgpack_numpy.packb(message)
    np.testing.assert_array_equal(unpack(msgpack_numpy.packb(message))["a"], np.eye(3))


def test_an_error_of_our_server_is_one_to_openpis_client() -> None:
    def broken(_observation: Mapping[str, Any]) -> Mapping[str, Any]:
        raise KeyError("images")

    with policy_server(broken) as address, pytest.raises(RuntimeError, match="KeyError: 'images'"):
        WebsocketClientPolicy(address).infer({"prompt": "x"})


def test_openpis_broker_carries_chunks_of_our_server_out_one_by_one() -> None:
    with policy_server(lambda observation: {"actions": states_of(observation)["actions"]}) as address:
        broker = ActionChunkBroker(WebsocketClientPolicy(address), action_horizon=3)
        rows = [broker.infer(payload(OBSERVATION, "aloha"))["actions"] for _ in range(4)]
    np.testing.assert_array_equal(rows, np.outer([0, 1, 2, 0], OBSERVATION["agent_pos"]))
