"""V-CAGE: an instruction in plain language goes in, a verified robot-manipulation dataset comes out.

What most programs need is here by name, and imported when it is first used; every name has an example in its
docstring, and the programs in ``examples/`` show them at work.
"""

from __future__ import annotations

import importlib
import sys
from typing import TYPE_CHECKING, Any

from vcage.base.version import __version__ as __version__

if TYPE_CHECKING:
    from vcage.apps.appending import append_to
    from vcage.apps.replay import replay_episode
    from vcage.apps.report.page import write_report
    from vcage.base.files import RunFolder
    from vcage.datasets.packing.pack import Order, pack
    from vcage.datasets.packing.settings import CompressionSettings
    from vcage.datasets.reader import EpisodeReader
    from vcage.episodes.second_judge import judge_pair
    from vcage.evaluation.environment import make_env
    from vcage.objects.library import Library
    from vcage.runs.context import StageContext
    from vcage.runs.running import run_stage
    from vcage.schema.episodes import Episodes
    from vcage.schema.scene import Scene
    from vcage.sim.world import World
    from vcage.stages.chain import ChainOptions, run_chain

__all__ = [
    "ChainOptions",
    "CompressionSettings",
    "EpisodeReader",
    "Episodes",
    "Library",
    "Order",
    "RunFolder",
    "Scene",
    "StageContext",
    "World",
    "append_to",
    "judge_pair",
    "make_env",
    "pack",
    "replay_episode",
    "run_chain",
    "run_stage",
    "write_report",
]

_PLACES = {
    "ChainOptions": "vcage.stages.chain",
    "CompressionSettings": "vcage.datasets.packing.settings",
    "EpisodeReader": "vcage.datasets.reader",
    "Episodes": "vcage.schema.episodes",
    "Library": "vcage.objects.library",
    "Order": "vcage.datasets.packing.pack",
    "RunFolder": "vcage.base.files",
    "Scene": "vcage.schema.scene",
    "StageContext": "vcage.runs.context",
    "World": "vcage.sim.world",
    "append_to": "vcage.apps.appending",
    "judge_pair": "vcage.episodes.second_judge",
    "make_env": "vcage.evaluation.environment",
    "pack": "vcage.datasets.packing.pack",
    "replay_episode": "vcage.apps.replay",
    "run_chain": "vcage.stages.chain",
    "run_stage": "vcage.runs.running",
    "write_report": "vcage.apps.report.page",
}
"""Name → its module. The simulator and the video codec take seconds to import, and many programs need neither."""

if "gymnasium" in sys.modules:  # which takes half a second to import
    importlib.import_module("vcage.evaluation.gymnasium_ids")


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = found = getattr(importlib.import_module(_PLACES[name]), name)
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *_PLACES})
