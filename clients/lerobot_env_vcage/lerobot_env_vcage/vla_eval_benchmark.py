"""A benchmark of vla-eval 0.8: ``benchmark: "lerobot_env_vcage.vla_eval_benchmark:VcageBenchmark"``."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from vla_eval.benchmarks.base import StepBenchmark, StepResult
from vla_eval.specs import DimSpec

from lerobot_env_vcage.environment import ADDRESS, RemoteEnv

FIRST_SEED = 100_000


class VcageBenchmark(StepBenchmark):
    """The task of a run that ``vcage serve`` offers; episode n begins from seed ``first_seed`` + n.

    Args:
        address: of the server.
        first_seed: of the first episode.
    """

    render_backends: ClassVar[frozenset[str]] = frozenset({"cpu", "gpu"})

    def __init__(self, address: str = ADDRESS, first_seed: int = FIRST_SEED):
        super().__init__()
        self._env, self._first_seed = RemoteEnv(address), first_seed

    @classmethod
    def configure_render(cls, mode: str) -> dict[str, str]:
        """Nothing is drawn in this process."""
        return {}

    def get_tasks(self) -> list[dict[str, Any]]:
        """The one task."""
        return [{"name": self._env.description["task_description"]}]

    def reset(self, task: dict[str, Any]) -> dict[str, Any]:
        """Begin the episode of the task's number."""
        observation, _ = self._env.reset(seed=self._first_seed + int(task.get("episode_idx", 0)))
        return observation

    def step(self, action: dict[str, Any]) -> StepResult:
        """Carry one action out."""
        target = np.asarray(action["actions"], np.float32)
        observation, reward, terminated, truncated, info = self._env.step(target)
        return StepResult(observation, reward, terminated or truncated, info)

    def make_obs(self, raw_obs: dict[str, Any], task: dict[str, Any]) -> dict[str, Any]:
        """An observation as model servers take it."""
        found = {"task_description": self._env.task_description, "state": raw_obs["agent_pos"]}
        found["images"] = dict(raw_obs.get("pixels", {}))
        if "environment_state" in raw_obs:
            found["environment_state"] = raw_obs["environment_state"]
        return found

    def get_step_result(self, step_result: StepResult) -> dict[str, Any]:
        """True if all goals held in the end."""
        return {"success": bool(step_result.info.get("success", False))}

    def get_action_spec(self) -> dict[str, DimSpec]:
        """Absolute targets of all joints and grippers."""
        return {"joints": DimSpec("joints", self._numbers, "absolute_joint_positions")}

    def get_observation_spec(self) -> dict[str, DimSpec]:
        """Joints, pictures and the instruction."""
        images = {name: DimSpec(name, 0, "rgb_hwc_uint8") for name in self._env.description["cameras"]}
        joints = DimSpec("state", self._numbers, "joint_positions")
        return {"state": joints, "language": DimSpec("language", 0, "language"), **images}

    def get_metadata(self) -> dict[str, Any]:
        """The length of an episode."""
        return {"max_steps": self._env.get_wrapper_attr("_max_episode_steps")}

    def cleanup(self) -> None:
        """Close the connection."""
        self._env.close()

    @property
    def _numbers(self) -> int:
        return len(self._env.description["action_names"])
