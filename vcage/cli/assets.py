"""``vcage assets …``: what can be done with the library of objects."""

from __future__ import annotations

import logging
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from tyro.conf import Positional, arg

from vcage.base.commands import vcage_command
from vcage.base.errors import InputFileError, NoRenderer, UnknownName, UsageError, VcageError
from vcage.base.options import FOLDER, NATURAL, POSITIVE, UNSAID, Flag, folder, several
from vcage.cli.arguments import Command
from vcage.cli.output import Result
from vcage.cli.progress import progress

if TYPE_CHECKING:
    from vcage.objects.importers import Imported

logger = logging.getLogger(__name__)

NAMES = several("NAME ...", least=0)


@dataclass(frozen=True, kw_only=True)
class ListAssets(Command):
    """List the objects of the library: words, sizes, and abilities.

    Of folders that VCAGE_ASSETS names only the annotations are read: an object has a size once something has built it.

    examples:
      vcage assets list
      vcage assets list --scene kitchen
      vcage assets list --json | jq .scenes
    """

    scene: Annotated[str | None, arg(metavar="TAG"), UNSAID] = None
    """only what belongs to a scene: kitchen, office_desk…"""
    json: Flag = False
    """only one JSON line: kinds per scene and per source"""

    def execute(self) -> Result:
        """List."""
        from vcage.objects.catalogue import catalogue_text, count_kinds
        from vcage.objects.library import Library

        library = Library.load()
        annotations = [library.annotation(name) for name in library.names]
        if self.scene is not None:
            tags = {tag for annotation in annotations for tag in annotation.words.scene_tags}
            if self.scene not in tags:
                raise UnknownName("scene", self.scene, tags)
            annotations = [a for a in annotations if self.scene in a.words.scene_tags]
        left_out = len(library.left_out)
        if left_out:
            logger.warning(
                "%d kinds are left out, their packages are missing: %s", left_out, vcage_command("setup", "assets")
            )
        facts = {**count_kinds(annotations), "left_out": left_out}
        if self.json:
            return Result(facts=facts)
        names = {annotation.name for annotation in annotations}
        return Result(text=catalogue_text(entry for entry in library.listing() if entry.name in names), facts=facts)


@dataclass(frozen=True, kw_only=True)
class SearchAssets(Command):
    """Find objects of the library by name, purpose, or meaning.

    With the extra `search` installed (pip install 'vcage[search]') sentences are compared by their meaning, else by
    their words.

    examples:
      vcage assets search something to drink from
      vcage assets search torch --top 3
    """

    words: Annotated[tuple[str, ...], Positional, several("WORDS ..."), UNSAID]
    """what to look for"""
    top: Annotated[int, POSITIVE] = 10
    """how many to show"""

    def execute(self) -> Result:
        """Search."""
        from vcage.models.search import best_search
        from vcage.objects.library import Library

        engine = best_search()
        query = " ".join(self.words)
        found = [pair for pair in engine.search(query, Library.load().listing(), self.top) if pair[1] > 0]
        lines = [f"{score:5.2f}  {entry.name}: {entry.words.description}" for entry, score in found]
        return Result(
            text="\n".join(lines) or "nothing found",
            facts={
                "query": query,
                "provider": engine.provider,
                "found": [{"name": entry.name, "score": round(score, 4)} for entry, score in found],
            },
        )


@dataclass(frozen=True, kw_only=True)
class DrawGallery(Command):
    """Draw the objects of the library on one page: from three sides and from above, at one scale, with their points.

    examples:
      vcage assets gallery --out runs/gallery
      vcage assets gallery mug bowl
    """

    names: Annotated[tuple[str, ...], Positional, NAMES, UNSAID] = ()
    """objects to draw (default: all)"""
    out: Annotated[Path, FOLDER] = Path("runs/gallery")
    """folder"""

    def execute(self) -> Result:
        """Draw."""
        from vcage.apps.gallery.page import write_gallery
        from vcage.objects.library import Library

        library = Library.load()
        with progress("drawing") as show:
            page = write_gallery(library, self.out, list(self.names), show)
        return Result(output=page, summary={"kinds": len(set(self.names) or library.names)})


SHOWN = ("objects", "variants", "contact_points", "functional_points", "joints", "tries", "failed")


class AssetsUnproven(InputFileError):
    """Objects of the library failed their validation."""

    code = "assets_unproven"


@dataclass(frozen=True, kw_only=True)
class ValidateAssets(Command):
    """Prove the objects of the library by use: measure, stand, grasp, fill and open each of them in the simulator.

    Per variant: the mesh is light and its hulls cover it; it stands still; at each contact point the robot grasps,
    lifts 15 cm, holds and shakes it; a probe released over each functional point stays there; the robot opens and
    closes each joint. A point or joint passes when at most one of its tries fails. Writes proof.json and a page; what
    is proven already and did not change is not tried again.

    examples:
      vcage assets validate
      vcage assets validate mug cabinet_two_drawers
      vcage assets validate --quick --workers 2
    """

    names: Annotated[tuple[str, ...], Positional, NAMES, UNSAID] = ()
    """objects to prove (default: all)"""
    quick: Flag = False
    """only the first variant of each, three tries instead of ten"""
    workers: Annotated[int, POSITIVE, arg(help_behavior_hint="(default: one for each core)")] = os.cpu_count() or 1
    """processes"""
    seed: Annotated[int, NATURAL] = 0
    """of all places"""
    robot: Annotated[str | None, arg(metavar="ROBOT"), UNSAID] = None
    """the robot for the proof (default: aloha_agilex)"""
    out: Annotated[Path, FOLDER] = Path("runs/proof")
    """folder"""
    force: Flag = False
    """repeat finished proofs"""
    no_page: Flag = False
    """only proof.json: no pictures are drawn"""

    def execute(self) -> Result:
        """Validate, and draw the page."""
        from vcage.apps.proof.page import write_page
        from vcage.apps.proof.prove import PROOF, Trial, validate
        from vcage.objects.library import Library

        trial = Trial(robot=self.robot, seed=self.seed, quick=self.quick)
        with progress("proving") as show:
            proof = validate(list(self.names), self.out, trial, workers=self.workers, force=self.force, progress=show)
        output = self.out / PROOF
        if not self.no_page:
            try:
                with progress("drawing") as show:
                    output = write_page(proof, Library.load(), self.out, show)
            except NoRenderer as error:
                logger.warning("no page was drawn: %s", error.as_line())
        facts = proof.model_dump(include=set(SHOWN))
        error = None
        if proof.failed:
            few = "; ".join(proof.failed[:5]) + (" …" if len(proof.failed) > 5 else "")
            error = AssetsUnproven(
                f"{len(proof.failed)} {'check' if len(proof.failed) == 1 else 'checks'} failed: {few}",
                hint=f"see {output}, then fix these objects or leave them out",
            )
        return Result(output=output, schema=proof.SCHEMA, facts={name: facts[name] for name in SHOWN}, error=error)


@dataclass(frozen=True, kw_only=True)
class ImportAssets(Command):
    """Import objects of other projects: RoboTwin's folders as they are downloaded, or shapes of the YCB package.

      robotwin DIR    an object's folder (003_plate), or the folder 'objects' with all of them
      ycb [NAME ...]  objects of the YCB set by name (default: all there are)

    An object that cannot be used is refused with the file and field at fault; the others are imported.

    examples:
      vcage assets import robotwin ~/RoboTwin/assets/objects/003_plate
      vcage assets import robotwin ~/RoboTwin/assets/objects --force
      vcage assets import ycb mustard_bottle
    """

    source: Annotated[Literal["robotwin", "ycb"], Positional]
    """where the objects come from"""
    what: Annotated[tuple[str, ...], Positional, several("DIR|NAME ...", least=0), UNSAID] = ()
    """the folder of RoboTwin, or names of YCB"""
    into: Annotated[Path | None, FOLDER, UNSAID] = None
    """folder for the objects (default: where vcage looks for them)"""
    robot: Annotated[str | None, arg(metavar="ROBOT"), UNSAID] = None
    """the robot whose gripper the grasps of YCB's shapes are for (default: aloha_agilex)"""
    force: Flag = False
    """replace an earlier import"""

    def execute(self) -> Result:
        """Import.

        Raises:
            UsageError: the folder is not given, or options that the source does not have.
            InputFileError: the folder holds no object.
        """
        from vcage.objects.importers.robotwin import import_robotwin
        from vcage.objects.importers.ycb import import_ycb
        from vcage.sim.robots import load_robot, load_template

        if self.source == "robotwin" and len(self.what) != 1:
            raise UsageError(
                f"import robotwin takes one folder, got {len(self.what)}",
                hint="see",
                command=vcage_command("assets", "import", "--help"),
            )
        with progress("importing") as show:
            if self.source == "ycb":
                robot = load_robot(load_template("table", self.robot).robot)
                gripper = next(iter(robot.arms.values())).gripper
                entries = import_ycb(list(self.what), gripper, self.into, show, force=self.force)
            else:
                entries = import_robotwin(folder(self.what[0]), self.into, show, force=self.force)
        return report(entries, self.into)


def report(entries: list[Imported], into: Path | None) -> Result:
    """Report one line per object with its warnings; an error only if nothing was imported.

    Args:
        into: where the objects went, when that is not where other commands look for them.
    """
    from vcage.objects.library import imported_objects

    lines, imported, refused = [], [], []
    for entry in entries:
        error = entry.error
        lines.append(f"{entry.name}: {'imported' if error is None else f'refused: {error.as_line()}'}")
        lines += [f"  warning: {warning}" for warning in entry.warnings]
        if error is None:
            imported.append(entry.name)
        else:
            details = {"code": error.code, "message": error.message, "details": error.details}
            refused.append({"name": entry.name, **details})
    warnings = sum(len(entry.warnings) for entry in entries)
    return Result(
        output=into or imported_objects(),
        summary={"imported": imported, "warnings": warnings, "refused": refused},
        next=vcage_command("assets", "gallery", *imported[:8]) if imported and into is None else "",
        text="\n".join(lines),
        error=None if imported or not entries else _nothing(entries, refused),
    )


def _nothing(entries: list[Imported], refused: list[dict[str, Any]]) -> VcageError:
    """Return the error where no object could be imported."""
    first = entries[0].error
    if len(entries) == 1 and first is not None:
        return first
    return InputFileError(
        f"none of {len(entries)} objects could be imported; the first: {refused[0]['message']}",
        hint="stdout names each with its fault",
        details={"refused": refused},
    )
