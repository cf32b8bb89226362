"""Prove the objects of the library by use: measure, stand, grasp, fill and open each of them in the simulator.

Per variant: the mesh is light and its hulls cover it; it stands still; at each contact point the robot grasps, lifts
15 cm, holds and shakes it; a probe released over each functional point stays there; the robot opens and closes each
joint. A point or joint passes when at most one of its tries fails. Writes proof.json and a page; what is proven
already and did not change is not tried again.

examples:
  vcage assets validate
  vcage assets validate mug cabinet_two_drawers
  vcage assets validate --quick --workers 2
"""

from __future__ import annotations

import argparse
import logging
import os
from pathlib import Path

from vcage.base.errors import InputFileError, NoRenderer
from vcage.cli.arguments import folder
from vcage.cli.output import Result
from vcage.cli.progress import progress
from vcage.cli.stages.common import natural, positive

logger = logging.getLogger(__name__)

SHOWN = ("objects", "variants", "contact_points", "functional_points", "joints", "tries", "failed")


class AssetsUnproven(InputFileError):
    """Objects of the library failed their validation."""

    code = "assets_unproven"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage assets validate``."""
    parser.add_argument("names", nargs="*", metavar="NAME", help="objects to prove (default: all)")
    parser.add_argument(
        "--quick", action="store_true", help="only the first variant of each, three tries instead of ten"
    )
    parser.add_argument(
        "--workers",
        type=positive,
        default=os.cpu_count() or 1,
        metavar="N",
        help="processes (default: %(default)s)",
    )
    parser.add_argument("--seed", type=natural, default=0, help="of all places (default: 0)")
    parser.add_argument(
        "--out", type=folder, default=Path("runs/proof"), metavar="DIR", help="folder (default: %(default)s)"
    )
    parser.add_argument("--force", action="store_true", help="prove again what is proven")
    parser.add_argument("--no-page", action="store_true", help="only proof.json: no pictures are drawn")


def execute(args: argparse.Namespace) -> Result:
    """Validate, and draw the page."""
    from vcage.apps.proof.page import write_page
    from vcage.apps.proof.prove import Trial
    from vcage.apps.proof.validate import PROOF, validate
    from vcage.objects.library import Library

    trial = Trial(seed=args.seed, quick=args.quick)
    with progress("proving") as show:
        proof = validate(args.names, args.out, trial, workers=args.workers, force=args.force, progress=show)
    output = args.out / PROOF
    if not args.no_page:
        try:
            with progress("drawing") as show:
                output = write_page(proof, Library.load(), args.out, show)
        except NoRenderer as error:
            logger.warning("no page was drawn: %s", error.as_line())
    facts = proof.model_dump(include=set(SHOWN))
    error = None
    if proof.failed:
        few = "; ".join(proof.failed[:5]) + (" …" if len(proof.failed) > 5 else "")
        error = AssetsUnproven(
            f"{len(proof.failed)} {'check' if len(proof.failed) == 1 else 'checks'} failed: {few}",
            hint=f"see {output}, then mend these objects or leave them out",
        )
    return Result(output=output, schema=proof.SCHEMA, facts={name: facts[name] for name in SHOWN}, error=error)
