"""An untrained ACT policy for a served environment, saved as ``lerobot-eval`` reads one.

    python -m untrained ADDRESS FOLDER

Its weights are random: what is shown is that lerobot can act in the environment, not that it succeeds.
"""

from __future__ import annotations

import sys

import torch
from lerobot.configs import FeatureType
from lerobot.envs.utils import env_to_policy_features
from lerobot.policies.act.configuration_act import ACTConfig
from lerobot.policies.act.modeling_act import ACTPolicy
from lerobot.policies.factory import make_pre_post_processors
from lerobot_env_vcage.lerobot_config import VcageEnv


def save_untrained(address: str, folder: str) -> None:
    """Save the policy and its processors into a folder."""
    features = env_to_policy_features(VcageEnv(address=address))
    given = {name: feature for name, feature in features.items() if feature.type is not FeatureType.ACTION}
    wanted = {name: feature for name, feature in features.items() if feature.type is FeatureType.ACTION}
    size = {"dim_model": 64, "dim_feedforward": 64, "n_heads": 4, "n_encoder_layers": 1}
    config = ACTConfig(
        input_features=given,
        output_features=wanted,
        chunk_size=8,
        n_action_steps=8,
        device="cpu",
        push_to_hub=False,
        pretrained_backbone_weights=None,
        **size,
    )
    scales = {name: {"mean": torch.zeros(f.shape), "std": torch.ones(f.shape)} for name, f in features.items()}
    before, after = make_pre_post_processors(config, dataset_stats=scales)
    for part in (ACTPolicy(config), before, after):
        part.save_pretrained(folder)


if __name__ == "__main__":
    save_untrained(*sys.argv[1:])
