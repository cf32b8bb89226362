"""The name of the environment in Gymnasium. Importing this registers it, and imports nothing of the simulator.

``import vcage`` does so where Gymnasium was imported before. ``"vcage.evaluation.gymnasium_ids:vcage/Run-v0"`` names it
anywhere: Gymnasium imports the module before the colon. Since 1.0 it reads no entry points of packages.
"""

from __future__ import annotations

from gymnasium.envs import registration

ENVIRONMENT = "vcage/Run-v0"

if ENVIRONMENT not in registration.registry:
    registration.register(ENVIRONMENT, entry_point="vcage.evaluation.environment:make_env")
