"""The name of the environment in Gymnasium, which calls this when it is imported (entry point ``gymnasium.envs``)."""

from __future__ import annotations

ENVIRONMENT = "vcage/Run-v0"


def register() -> None:
    """Register the environment; nothing of the simulator is imported before one is made."""
    from gymnasium.envs import registration

    if ENVIRONMENT not in registration.registry:
        registration.register(ENVIRONMENT, entry_point="vcage.evaluation.environment:make_env")
