"""``--env.type=vcage`` of lerobot 0.6."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

from gymnasium.vector import AsyncVectorEnv, AutoresetMode, SyncVectorEnv, VectorEnv
from lerobot.configs import FeatureType, PolicyFeature
from lerobot.envs.configs import EnvConfig
from lerobot.utils.constants import ACTION, OBS_ENV_STATE, OBS_IMAGES, OBS_STATE

from lerobot_env_vcage.environment import ADDRESS, RemoteEnv


@EnvConfig.register_subclass("vcage")
@dataclass
class VcageEnv(EnvConfig):
    """The environments that ``vcage serve`` offers.

    Args:
        address: of the server, which is asked for the sizes of observations and actions.
    """

    task: str | None = "Run-v0"
    address: str = ADDRESS

    def __post_init__(self) -> None:
        if self.features:
            return
        probe = RemoteEnv(self.address)
        self.fps = int(probe.description["fps"])
        self.features, self.features_map = _features(probe)
        probe.close()

    @property
    def gym_kwargs(self) -> dict[str, Any]:
        """Arguments of the environment."""
        return {"address": self.address}

    def create_envs(self, n_envs: int, use_async_envs: bool = False) -> dict[str, dict[int, VectorEnv]]:
        """One task, as so many environments."""
        made = [partial(RemoteEnv, self.address)] * n_envs
        if use_async_envs and n_envs > 1:
            vector = AsyncVectorEnv(made, context="forkserver", autoreset_mode=AutoresetMode.SAME_STEP)
        else:
            vector = SyncVectorEnv(made, autoreset_mode=AutoresetMode.SAME_STEP)
        return {self.type: {0: vector}}


def _features(env: RemoteEnv) -> tuple[dict[str, PolicyFeature], dict[str, str]]:
    """Features of an environment, and the names that policies have for them."""
    numbers = len(env.description["action_names"])
    features = {
        ACTION: PolicyFeature(type=FeatureType.ACTION, shape=(numbers,)),
        "agent_pos": PolicyFeature(type=FeatureType.STATE, shape=(numbers,)),
    }
    names = {ACTION: ACTION, "agent_pos": OBS_STATE}
    if state := env.description["state_names"]:
        features["environment_state"] = PolicyFeature(type=FeatureType.ENV, shape=(len(state),))
        names["environment_state"] = OBS_ENV_STATE
    for camera, shape in env.description["cameras"].items():
        features[f"pixels/{camera}"] = PolicyFeature(type=FeatureType.VISUAL, shape=tuple(shape))
        names[f"pixels/{camera}"] = f"{OBS_IMAGES}.{camera}"
    return features, names
