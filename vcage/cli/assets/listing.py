"""List the objects of the library: words, sizes, and what they can do.

examples:
  vcage assets list
  vcage assets list --scene kitchen
  vcage assets list --json | jq .scenes
"""

from __future__ import annotations

import argparse
import logging

from vcage.cli.output import Result

logger = logging.getLogger(__name__)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage assets list``."""
    parser.add_argument("--scene", metavar="TAG", help="only what belongs to a scene: kitchen, office_desk…")
    parser.add_argument("--json", action="store_true", help="only one JSON line: kinds per scene and per source")


def execute(args: argparse.Namespace) -> Result:
    """List."""
    from vcage.base.errors import UnknownName
    from vcage.objects.catalogue import catalogue_text
    from vcage.objects.library import Library
    from vcage.objects.summary import count_kinds

    library = Library.load()
    annotations = [library.annotation(name) for name in library.names]
    if args.scene is not None:
        tags = {tag for annotation in annotations for tag in annotation.words.scene_tags}
        if args.scene not in tags:
            raise UnknownName("scene", args.scene, tags)
        annotations = [a for a in annotations if args.scene in a.words.scene_tags]
    if library.left_out:
        logger.warning("%d kinds are left out, their packages are not here: vcage setup assets", len(library.left_out))
    facts = {**count_kinds(annotations), "left_out": len(library.left_out)}
    if args.json:
        return Result(facts=facts)
    return Result(text=catalogue_text(library.entry(a.name) for a in annotations), facts=facts)
