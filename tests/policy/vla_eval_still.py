"""vla-eval runs two episodes of a served environment with a model that stays where it is.

python -m vla_eval_still ADDRESS FOLDER
"""

from __future__ import annotations

import json
import sys
from typing import Any

import numpy as np
from vla_eval.api import evaluate
from vla_eval.model_servers.predict import PredictModelServer
from vla_eval.specs import DimSpec


class Still(PredictModelServer):
    """Answers each observation with the joints that it shows."""

    def predict(self, obs: dict[str, Any], ctx: Any) -> dict[str, Any]:
        """The present joints."""
        return {"actions": np.asarray(obs["state"], np.float32)}

    def get_action_spec(self) -> dict[str, DimSpec]:
        """Joints."""
        return {"joints": DimSpec("joints", 0, "absolute_joint_positions")}

    def get_observation_spec(self) -> dict[str, DimSpec]:
        """Joints."""
        return {"state": DimSpec("state", 0, "joint_positions")}


if __name__ == "__main__":
    address, folder = sys.argv[1:]
    benchmark = {
        "benchmark": "lerobot_env_vcage.vla_eval_benchmark:VcageBenchmark",
        "episodes_per_task": 2,
        "params": {"address": address},
    }
    found = evaluate(Still(), {"output_dir": folder, "benchmarks": [benchmark], "render": "cpu"}, docker=False)
    print(json.dumps([episode["metrics"] for task in found[0]["tasks"] for episode in task["episodes"]]))
