"""The scenes of V-CAGE runs, served by ``vcage serve``, as environments of lerobot, Gymnasium and vla-eval.

Importing it makes ``--env.type=vcage`` known to lerobot, where lerobot is installed.
"""

from importlib.util import find_spec

from lerobot_env_vcage.environment import RemoteEnv, ServerError

__all__ = ["RemoteEnv", "ServerError"]

if find_spec("lerobot") is not None:
    from lerobot_env_vcage import lerobot_config  # noqa: F401
