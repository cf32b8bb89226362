"""Find the nearest layout without collisions, rebuild it in the simulator and let it settle.

Reads place/, inpaint/ and match/. Writes optimize/scene.json and optimize/layout.png.

examples:
  vcage optimize --run runs/stationery
  vcage optimize --run runs/stationery --margin 0.05 --force
  vcage optimize --run runs/stationery --weights displacement=5,relation=0 --force
"""

from __future__ import annotations

import argparse
from dataclasses import asdict, replace

from vcage.cli.output import Result
from vcage.cli.stages.common import add_common, execute_stage, natural, number
from vcage.layout.cost import Weights
from vcage.stages.settings import Settings

MOST_WEIGHT = 1e6
"""Beyond it the optimiser's own precision would be the result."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage optimize``."""
    parser.add_argument(
        "--margin",
        type=number(0, 0.5),
        default=Settings.margin,
        metavar="δ",
        help="gap between two objects, metres (default: %(default)s)",
    )
    parser.add_argument(
        "--restarts",
        type=natural,
        default=Settings.restarts,
        help="random restarts of the optimiser (default: %(default)s)",
    )
    parser.add_argument(
        "--weights",
        type=layout_weights,
        default=Weights(),
        metavar="TERM=λ,…",
        help="weights of the cost's terms; only their ratios matter, and a term that is not named keeps its default "
        f"({', '.join(f'{name}={value:g}' for name, value in asdict(Weights()).items())})",
    )
    add_common(parser, models=False)


def layout_weights(text: str) -> Weights:
    """``collision=1000,relation=0`` as weights, for ``type=`` of an option."""
    known = asdict(Weights())
    chosen: dict[str, float] = {}
    for part in text.split(","):
        name, _, value = part.strip().partition("=")
        if name not in known:
            raise argparse.ArgumentTypeError(f"no term is called {name!r}; there are: {', '.join(known)}")
        chosen[name] = number(0, MOST_WEIGHT)(value)
    return replace(Weights(), **chosen)


def execute(args: argparse.Namespace) -> Result:
    """Run the stage."""
    return execute_stage("optimize", args, args.run)
