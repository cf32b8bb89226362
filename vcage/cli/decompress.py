"""``vcage decompress``."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional, arg

from vcage.base.options import FOLDER, Flag
from vcage.cli.arguments import Command
from vcage.cli.output import Result
from vcage.cli.progress import progress


@dataclass(frozen=True, kw_only=True)
class Decompress(Command):
    """Put the pictures of compressed recordings back: HDF5 as it was laid out before, as many frames, in order.

    INPUT is what `vcage compress` wrote: an HDF5 file whose videos lie beside it, or a folder of them. Arrays of pixels
    come back as arrays, encoded pictures as PNG in the same kind of data set, so that they lose nothing more and every
    reader of the layout sees what it saw before; where the file keeps their lengths, it keeps those of the PNGs then.
    The pictures are those of the videos: what compression lost stays lost.

    examples:
      vcage decompress small --out restored
      vcage decompress small/episode0.hdf5 --out restored --storage raw
    """

    input: Annotated[Path, FOLDER, Positional, arg(metavar="INPUT")]
    """a compressed HDF5 file, or a folder of them"""
    out: Annotated[Path, FOLDER]
    """the folder to write; it must be new"""
    storage: Literal["same", "raw"] = "same"
    """pictures as they were stored before, or all as arrays of RGB"""
    force: Flag = False
    """replace what an earlier call wrote"""

    def execute(self) -> Result:
        """Put the pictures back."""
        from vcage.datasets.packing.unpacking import unpack_all

        with progress("decompress") as show:
            files = unpack_all(self.input, self.out, storage=self.storage, force=self.force, progress=show)
        return Result(output=self.out, summary={"files": [str(file) for file in files]})
