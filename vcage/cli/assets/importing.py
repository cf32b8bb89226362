"""Import objects of other projects: RoboTwin's folders as they are downloaded, or shapes of the YCB package.

  robotwin DIR    an object's folder (003_plate), or the folder 'objects' with all of them
  ycb [NAME ...]  objects of the YCB set by name (default: all there are)

An object that cannot be used is refused with the file and field at fault; the others are imported.

examples:
  vcage assets import robotwin ~/RoboTwin/assets/objects/003_plate
  vcage assets import robotwin ~/RoboTwin/assets/objects --force
  vcage assets import ycb mustard_bottle
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vcage.base.errors import InputFileError, UsageError, VcageError
from vcage.cli.arguments import folder
from vcage.cli.output import Result
from vcage.cli.progress import progress

if TYPE_CHECKING:
    from vcage.objects.importers import Imported


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage assets import``."""
    parser.add_argument("source", choices=["robotwin", "ycb"], help="where the objects come from")
    parser.add_argument("what", nargs="*", metavar="DIR|NAME", help="the folder of RoboTwin, or names of YCB")
    parser.add_argument(
        "--into", type=folder, metavar="DIR", help="folder for the objects (default: where vcage looks for them)"
    )
    parser.add_argument("--force", action="store_true", help="replace what was imported before")


def execute(args: argparse.Namespace) -> Result:
    """Import.

    Raises:
        UsageError: the folder is not given, or options that the source does not have.
        InputFileError: the folder holds no object.
    """
    return report(_robotwin(args) if args.source == "robotwin" else _ycb(args), args.into)


def _robotwin(args: argparse.Namespace) -> list[Imported]:
    from vcage.objects.importers.robotwin import import_robotwin

    if len(args.what) != 1:
        raise UsageError(
            f"import robotwin takes one folder, got {len(args.what)}",
            hint="vcage assets import robotwin ~/RoboTwin/assets/objects",
        )
    with progress("importing") as show:
        return import_robotwin(folder(args.what[0]), args.into, show, force=args.force)


def _ycb(args: argparse.Namespace) -> list[Imported]:
    from vcage.objects.importers.ycb import import_ycb

    with progress("importing") as show:
        return import_ycb(args.what, args.into, show, force=args.force)


def report(entries: list[Imported], into: Path | None) -> Result:
    """One line per object with its warnings; an error only when nothing was imported.

    Args:
        into: where the objects went, when that is not where other commands look for them.
    """
    from vcage.objects.library import imported_objects

    lines = []
    for entry in entries:
        lines.append(f"{entry.name}: {'imported' if entry.error is None else f'refused: {entry.error.as_line()}'}")
        lines += [f"  warning: {warning}" for warning in entry.warnings]
    refused = [_refusal(entry.name, entry.error) for entry in entries if entry.error is not None]
    imported = [entry.name for entry in entries if entry.error is None]
    return Result(
        output=into or imported_objects(),
        summary={
            "imported": imported,
            "warnings": sum(len(entry.warnings) for entry in entries),
            "refused": refused,
        },
        next="vcage assets gallery " + " ".join(imported[:8]) if imported and into is None else "",
        text="\n".join(lines),
        error=None if imported or not entries else _nothing(entries, refused),
    )


def _refusal(name: str, error: VcageError) -> dict[str, Any]:
    return {"name": name, "code": error.code, "message": error.message, "details": error.details}


def _nothing(entries: list[Imported], refused: list[dict[str, Any]]) -> VcageError:
    first = entries[0].error
    if len(entries) == 1 and first is not None:
        return first
    return InputFileError(
        f"none of {len(entries)} objects could be imported; the first: {refused[0]['message']}",
        hint="each is named on stdout with what is wrong",
        details={"refused": refused},
    )
