"""Find each object again in the target picture: position and rotation in the world.

Reads place/ and inpaint/. Writes match/matches.json and match/overlay.png.

examples:
  vcage match --run runs/stationery
  vcage match --run runs/stationery --threshold 0.7 --force
  vcage match --run runs/stationery --detector grounding-dino --embedder dinov2:~/models/dinov2-small --force
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence

from vcage.cli.output import Result
from vcage.cli.stages.common import add_common, execute_stage, number
from vcage.models.registry import DETECTORS, EMBEDDERS, split_weights
from vcage.stages.settings import Settings


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage match``."""
    add_own_arguments(parser)
    add_common(parser)


def add_own_arguments(parser: argparse.ArgumentParser) -> None:
    """How objects are found and told apart."""
    parser.add_argument(
        "--detector",
        type=one_of("detector", DETECTORS),
        default=Settings.detector,
        metavar="NAME[:WEIGHTS]",
        help=f"what finds objects in the target picture: {', '.join(DETECTORS)} (default: %(default)s); weights are "
        "a hub id or a folder",
    )
    parser.add_argument(
        "--embedder",
        type=one_of("embedder", EMBEDDERS),
        default=Settings.embedder,
        metavar="NAME[:WEIGHTS]",
        help=f"what tells them apart: {', '.join(EMBEDDERS)} (default: %(default)s)",
    )
    parser.add_argument(
        "--threshold",
        type=number(0, 1),
        default=Settings.threshold,
        metavar="τ",
        help="smallest cosine similarity of a match (default: %(default)s)",
    )


def one_of(role: str, names: Sequence[str]) -> Callable[[str], str]:
    """For ``type=`` of an option: one of the names, and what comes after a colon."""

    def parse(text: str) -> str:
        if split_weights(text)[0] not in names:
            raise argparse.ArgumentTypeError(f"no {role} is called {text!r}; there are: {', '.join(names)}")
        return text

    return parse


def execute(args: argparse.Namespace) -> Result:
    """Run the stage."""
    return execute_stage("match", args, args.run)
