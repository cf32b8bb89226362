"""List the objects of the library, or draw every one of them in one picture.

examples:
  vcage assets list
  vcage assets gallery --out runs/gallery
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from vcage.cli.output import Result
from vcage.cli.progress import progress

if TYPE_CHECKING:
    from vcage.assets.library import Library


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage assets``."""
    parser.add_argument("what", choices=["list", "gallery"], help="what to do")
    parser.add_argument("--out", type=Path, default=Path("runs/gallery"), metavar="DIR", help="folder of the gallery")


def execute(args: argparse.Namespace) -> Result:
    """List or draw."""
    from vcage.assets.library import Library

    library = Library.load()
    return _list(library) if args.what == "list" else _gallery(library, args.out)


def _list(library: Library) -> Result:
    from vcage.assets.catalogue import catalogue_text

    entries = library.entries()
    summary = {"kinds": len(entries), "variants": sum(len(entry.variants) for entry in entries)}
    return Result(text=catalogue_text(entries), summary=summary)


def _gallery(library: Library, out: Path) -> Result:
    from vcage.pipeline.gallery import write_gallery

    with progress("drawing") as show:
        page = write_gallery(library, out, show)
    return Result(output=page, summary={"kinds": len(library.names)})
