"""Put the pictures of compressed recordings back: HDF5 as it was laid out before, as many frames, in order.

INPUT is what `vcage compress` wrote: an HDF5 file whose videos lie beside it, or a folder of them. Arrays of pixels
come back as arrays, encoded pictures as PNG in the same kind of data set, so that they lose nothing more and every
reader of the layout sees what it saw before. The pictures are those of the videos: what compression lost stays lost.

examples:
  vcage decompress small --out restored
  vcage decompress small/episode0.hdf5 --out restored --storage raw
"""

from __future__ import annotations

import argparse

from vcage.cli.arguments import folder
from vcage.cli.output import Result
from vcage.cli.progress import progress


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage decompress``."""
    parser.add_argument("input", type=folder, metavar="INPUT", help="a compressed HDF5 file, or a folder of them")
    parser.add_argument("--out", required=True, type=folder, metavar="DIR", help="the folder to write; it must be new")
    parser.add_argument(
        "--storage",
        choices=("same", "raw"),
        default="same",
        help="pictures as they were stored before, or all as arrays of RGB (default: %(default)s)",
    )
    parser.add_argument("--force", action="store_true", help="replace what an earlier call wrote")


def execute(args: argparse.Namespace) -> Result:
    """Put the pictures back."""
    from vcage.datasets.packing.unpacking import unpack_all

    with progress("decompress") as show:
        files = unpack_all(args.input, args.out, storage=args.storage, force=args.force, progress=show)
    return Result(output=args.out, summary={"files": [str(file) for file in files]})
