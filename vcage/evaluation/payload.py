"""Observations in the words of policies: openpi's ALOHA configuration, and a generic one."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, Literal

import numpy as np

from vcage.base.errors import UsageError

Payload = Literal["aloha", "generic"]

ALOHA_NUMBERS = 14
"""Numbers of ALOHA's state: two arms of six joints and a gripper."""

ALOHA_CAMERAS = ("cam_high", "cam_low", "cam_left_wrist", "cam_right_wrist")
"""Cameras that openpi's ALOHA configuration knows; it refuses others."""


def require_possible(kind: Payload, numbers: int, cameras: Collection[str]) -> None:
    """Require that observations can be sent with the fields of a kind.

    Args:
        kind: of the fields.
        numbers: of a state.
        cameras: whose pictures are observed.

    Raises:
        UsageError: ``aloha`` is asked for a robot of another size, or without its first camera.
    """
    if kind != "aloha":
        return
    if numbers != ALOHA_NUMBERS:
        raise UsageError(
            f"a state of {numbers} numbers is not ALOHA's, which has {ALOHA_NUMBERS}", hint="--payload generic"
        )
    if ALOHA_CAMERAS[0] not in cameras:
        raise UsageError(
            f"openpi's ALOHA configuration needs pictures of {ALOHA_CAMERAS[0]}; there are "
            f"{', '.join(cameras) or 'none'}",
            hint="observe it, or take --payload generic",
        )


def names_in(sent: Mapping[str, Any]) -> list[str]:
    """Names of the fields of a payload, and of their fields: ``images/cam_high``."""
    fields = ([f"{name}/{n}" for n in value] if isinstance(value, Mapping) else [name] for name, value in sent.items())
    return [name for names in fields for name in names]


def payload(observation: Mapping[str, Any], kind: Payload) -> dict[str, Any]:
    """The fields that a policy is sent.

    ``aloha``: ``state`` (14,), ``images`` (camera → (3, H, W) uint8), ``prompt``.
    ``generic``: ``observation/state`` (D,), ``observation/<camera>`` ((H, W, 3) uint8),
    ``observation/environment_state``, ``prompt``.

    Args:
        observation: one that :func:`require_possible` allows.
        kind: of the fields.
    """
    pictures = observation.get("pixels", {})
    if kind == "aloha":
        state = np.asarray(observation["agent_pos"])
        images = {n: np.ascontiguousarray(p.transpose(2, 0, 1)) for n, p in pictures.items() if n in ALOHA_CAMERAS}
        return {"state": state, "images": images, "prompt": observation["instruction"]}
    named = {f"observation/{name}": picture for name, picture in pictures.items()}
    if "environment_state" in observation:
        named["observation/environment_state"] = observation["environment_state"]
    return {"observation/state": observation["agent_pos"], **named, "prompt": observation["instruction"]}
