"""Cases on disk: one folder per target picture, written and read in the layout of ``docs/match-pictures.md``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np

from benchmarks._match.truth import Truth
from vcage.base.errors import InputFileError, VcageError
from vcage.base.files import atomic_folder, whole, write_bytes
from vcage.base.pictures import picture_header, read_labels, read_picture, write_labels, write_picture
from vcage.schema.plan import Plan
from vcage.schema.scene import Scene

REFERENCES = "references"
"""Folder beside the cases: what the objects look like from straight above, for those who use their symmetry."""

DOCUMENT = "docs/match-pictures.md"

FILES = ("scene.json", "source.png", "segmentation.png", "background.png", "target.png", "truth.json")
"""Files of a case; ``plan.json`` may be there too."""


@dataclass(frozen=True)
class Case:
    """A target picture, what the matcher may know, and the truth.

    Args:
        name: its folder, relative to the folder of all cases.
        scene: M, the objects and where they stood.
        source, background: (H, W, 3) uint8 top views of the scene and of the empty table.
        segmentation: (H, W) int, values of ``scene.segmentation_ids``.
        target: (H', W', 3) uint8, the editor's answer, of any size.
        truth: where everything is in the target picture.
        plan: L, where there is one.
        references: (h, w, 4) uint8 RGBA by object id, from straight above; may be empty.
    """

    name: str
    scene: Scene
    source: np.ndarray = field(repr=False)
    segmentation: np.ndarray = field(repr=False)
    background: np.ndarray = field(repr=False)
    target: np.ndarray = field(repr=False)
    truth: Truth
    plan: Plan | None = None
    references: Mapping[str, np.ndarray] = field(default_factory=dict, repr=False)


# --- writing -------------------------------------------------------------------------------------------


def write_case(root: Path, case: Case) -> Path:
    """Write a case under ``root``; its references go beside all cases, once for every look."""
    folder = root / case.name
    with atomic_folder(folder) as part:
        case.scene.write(part / "scene.json")
        write_picture(part / "source.png", case.source)
        write_picture(part / "background.png", case.background)
        write_picture(part / "target.png", case.target)
        write_labels(part / "segmentation.png", case.segmentation)
        case.truth.write(part / "truth.json")
        if case.plan is not None:
            case.plan.write(part / "plan.json")
    for object_id, picture in case.references.items():
        path = _reference_path(root, case.scene, object_id)
        if not path.is_file():
            write_bytes(path, cv2.imencode(".png", cv2.cvtColor(picture, cv2.COLOR_RGBA2BGRA))[1].tobytes())
    return folder


def _reference_path(root: Path, scene: Scene, object_id: str) -> Path:
    record = scene.object(object_id)
    return root / REFERENCES / f"{record.asset}-{record.variant}.png"


# --- reading -------------------------------------------------------------------------------------------


def case_folders(root: Path) -> list[Path]:
    """Every folder under ``root`` that holds any file of a case, sorted by path.

    Raises:
        InputFileError: there is none.
    """
    found = {path.parent for name in FILES for path in root.rglob(name) if all(map(whole, path.parents))}
    if not found:
        raise InputFileError(f"{root} holds no case", hint=f"give the folder that holds the cases; see {DOCUMENT}")
    return sorted(found)


def read_case(folder: Path, root: Path | None = None) -> Case:
    """One case.

    Args:
        folder: of the case.
        root: folder of all cases, which holds the references; two levels up by default.

    Raises:
        InputFileError: a file is missing or damaged, or they do not belong together; names the case and the file.
    """
    folder = Path(folder)
    root = folder.parent.parent if root is None else Path(root)
    name = folder.relative_to(root).as_posix()
    missing = [file for file in FILES if not (folder / file).is_file()]
    if missing:
        raise _damaged(name, f"{', '.join(missing)} missing in {folder}")
    try:
        scene = Scene.read(folder / "scene.json")
        case = Case(
            name=name,
            scene=scene,
            source=read_picture(folder / "source.png"),
            segmentation=read_labels(folder / "segmentation.png"),
            background=read_picture(folder / "background.png"),
            target=read_picture(folder / "target.png"),
            truth=Truth.read(folder / "truth.json"),
            plan=Plan.read(folder / "plan.json") if (folder / "plan.json").is_file() else None,
            references=_read_references(root, scene),
        )
    except VcageError as error:
        raise _damaged(name, error.message) from error
    complaint = _complaint(case)
    if complaint:
        raise _damaged(name, complaint)
    return case


def _damaged(name: str, why: str) -> InputFileError:
    return InputFileError(
        f"case {name}: {why}",
        hint=f"fix the case as {DOCUMENT} says, or move its folder away",
        details={"case": name},
    )


def _read_references(root: Path, scene: Scene) -> dict[str, np.ndarray]:
    paths = {o.id: _reference_path(root, scene, o.id) for o in scene.objects}
    pictures = {object_id: read_raw(path) for object_id, path in paths.items() if path.is_file()}
    for object_id, picture in pictures.items():
        if picture.ndim != 3 or picture.shape[2] != 4:
            raise InputFileError(f"{paths[object_id]} has no alpha channel", hint="write it as RGBA")
    return pictures


def read_raw(path: Path) -> np.ndarray:
    """A picture with the channels that it has: (H, W) grey, (H, W, 3) RGB or (H, W, 4) RGBA, uint8.

    Raises:
        InputFileError: it is missing, too large, or not a picture of 8 bits.
    """
    picture_header(path)
    picture = cv2.imdecode(np.frombuffer(path.read_bytes(), np.uint8), cv2.IMREAD_UNCHANGED)
    if picture is None or picture.dtype != np.uint8:
        raise InputFileError(f"{path} is not a picture of 8 bits a channel", hint="write it as PNG")
    if picture.ndim == 3:
        picture = cv2.cvtColor(picture, cv2.COLOR_BGRA2RGBA if picture.shape[2] == 4 else cv2.COLOR_BGR2RGB)
    return picture


def _complaint(case: Case) -> str:
    """Name what does not fit together in a case; empty when all does."""
    size = (case.scene.top_camera.height, case.scene.top_camera.width)
    for name, picture in (
        ("source.png", case.source),
        ("segmentation.png", case.segmentation),
        ("background.png", case.background),
    ):
        if picture.shape[:2] != size:
            return f"{name} has {picture.shape[1]} x {picture.shape[0]} pixels, the top camera {size[1]} x {size[0]}"
    ids, known = {o.id for o in case.scene.objects}, {o.id for o in case.truth.objects}
    if ids != known:
        return f"scene.json and truth.json name different objects: {', '.join(sorted(ids ^ known))}"
    unlabelled = sorted(ids - set(case.scene.segmentation_ids))
    if unlabelled:
        return f"scene.json has no segmentation_ids of {', '.join(unlabelled)}"
    return ""
