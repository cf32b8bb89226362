"""Draw the objects of the library on one page: from three sides and from above, at one scale, with their points.

examples:
  vcage assets gallery --out runs/gallery
  vcage assets gallery mug bowl
"""

from __future__ import annotations

import argparse
from pathlib import Path

from vcage.cli.arguments import folder
from vcage.cli.output import Result
from vcage.cli.progress import progress


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage assets gallery``."""
    parser.add_argument("names", nargs="*", metavar="NAME", help="objects to draw (default: all)")
    parser.add_argument(
        "--out", type=folder, default=Path("runs/gallery"), metavar="DIR", help="folder (default: %(default)s)"
    )


def execute(args: argparse.Namespace) -> Result:
    """Draw."""
    from vcage.apps.gallery.page import write_gallery
    from vcage.objects.library import Library

    library = Library.load()
    with progress("drawing") as show:
        page = write_gallery(library, args.out, args.names, show)
    return Result(output=page, summary={"kinds": len(set(args.names) or library.names)})
