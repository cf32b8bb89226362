"""Objects with moving parts, made of boxes: a cabinet of two drawers, a chest with a hinged lid, a spring button."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import trimesh

from vcage.base.geometry import Pose, world_aabb
from vcage.objects.asset import Asset
from vcage.schema.asset import (
    Annotation,
    ContactPoint,
    FunctionalPoint,
    Joint,
    MovingLink,
    PhysicalModel,
    Variant,
    Words,
)
from vcage.schema.base import PoseRecord
from vcage.schema.scene import ObjectRecord
from vcage.tasks.scene_objects import SceneObject

Box = tuple[Sequence[float], Sequence[float]]

TRAVEL = 0.12
"""How far a drawer opens, metres."""

LID_RANGE = 1.9
"""How far the lid turns, radians."""

FORWARD_DOWN = (0.0, 0.70710678, -0.70710678)


def drawer_cabinet(folder: Path) -> PhysicalModel:
    """24 × 18 × 22 cm, with the drawers ``drawer_lower`` and ``drawer_upper`` and a vertical fin on each."""
    w, d, h, t = 0.12, 0.09, 0.22, 0.008
    shell = [
        ((-w, -d, 0), (w, d, 0.05)),
        ((-w, -d, h - t), (w, d, h)),
        ((-w, -d, 0.05), (-w + t, d, h - t)),
        ((w - t, -d, 0.05), (w, d, h - t)),
        ((-w + t, d - t, 0.05), (w - t, d, h - t)),
    ]
    joint = Joint(kind="slide", origin=(0, 0, 0), axis=(0, -1, 0), lower=0, upper=TRAVEL, damping=8.0, friction=3.0)
    links = [
        _link(folder, name, _drawer(w - t - 0.002, d, bottom), joint, 0.25)
        for name, bottom in (("drawer_lower", 0.052), ("drawer_upper", 0.132))
    ]
    return _model(folder, "cabinet", shell, 2.5, links)


def drawer_handle(name: str = "drawer_upper") -> ContactPoint:
    """The middle of a drawer's fin."""
    z = {"drawer_lower": 0.052, "drawer_upper": 0.132}[name] + 0.04
    return ContactPoint(
        id=0, name=f"handle of {name}", position=(0, -0.118, z), approach=FORWARD_DOWN, closing=(1, 0, 0), link=name
    )


def drawer_floor(name: str = "drawer_upper") -> FunctionalPoint:
    """The middle of a drawer's floor."""
    z = {"drawer_lower": 0.052, "drawer_upper": 0.132}[name] + 0.006
    return FunctionalPoint(id=0, name=f"in {name}", holds="in", position=(0, 0, z), link=name)


def lidded_chest(folder: Path) -> PhysicalModel:
    """20 × 16 × 10 cm and a lid that is hinged at the back, with a fin at its front."""
    w, d, h, t = 0.10, 0.08, 0.10, 0.008
    tray = [
        ((-w, -d, 0), (w, d, t)),
        ((-w, -d, t), (-w + t, d, h)),
        ((w - t, -d, t), (w, d, h)),
        ((-w + t, -d, t), (w - t, -d + t, h)),
        ((-w + t, d - t, t), (w - t, d, h)),
    ]
    lid = [((-w, -d, h + 0.001), (w, d, h + 0.011)), ((-0.006, -d, h + 0.011), (0.006, -d + 0.035, h + 0.045))]
    hinge = Joint(
        kind="turn", origin=(0, d, h + 0.006), axis=(-1, 0, 0), lower=0, upper=LID_RANGE, damping=20.0, friction=0.3
    )
    return _model(folder, "chest", tray, 1.5, [_link(folder, "lid", lid, hinge, 0.12)])


def lid_handle() -> ContactPoint:
    """The middle of the lid's fin."""
    return ContactPoint(
        id=0,
        name="fin of the lid",
        position=(0, -0.066, 0.13),
        approach=(0, 0.34202014, -0.93969262),
        closing=(1, 0, 0),
        link="lid",
    )


def push_button(folder: Path) -> PhysicalModel:
    """A block of 8 cm with a button that sinks in by 8 mm and comes back."""
    block = [((-0.04, -0.04, 0), (0.04, 0.04, 0.05))]
    knob = [((-0.012, -0.012, 0.052), (0.012, 0.012, 0.07))]
    joint = Joint(
        kind="slide", origin=(0, 0, 0), axis=(0, 0, -1), lower=0, upper=0.008, damping=2.0, friction=0.0, spring=200.0
    )
    return _model(folder, "button", block, 0.8, [_link(folder, "knob", knob, joint, 0.02)])


def button_top() -> ContactPoint:
    """The middle of the button's top."""
    return ContactPoint(
        id=0, name="button", position=(0, 0, 0.07), approach=(0, 0, -1), closing=(1, 0, 0), link="knob", use="press"
    )


def _drawer(w: float, d: float, bottom: float) -> list[Box]:
    """Floor, sides, back, a front that closes the shell, and a fin."""
    t, top = 0.006, bottom + 0.074
    return [
        ((-w, -d, bottom), (w, d - 0.012, bottom + t)),
        ((-w, -d, bottom + t), (-w + t, d - 0.012, top - 0.02)),
        ((w - t, -d, bottom + t), (w, d - 0.012, top - 0.02)),
        ((-w + t, d - 0.018, bottom + t), (w - t, d - 0.012, top - 0.02)),
        ((-w, -d - 0.008, bottom), (w, -d, top)),
        ((-0.006, -d - 0.04, bottom + 0.015), (0.006, -d - 0.008, bottom + 0.065)),
    ]


def _model(folder: Path, name: str, boxes: Sequence[Box], mass: float, links: list[MovingLink]) -> PhysicalModel:
    visual, hulls, corners = _files(folder, name, boxes, (150, 110, 70))
    every = np.concatenate([corners, *(_corners(folder, name, link) for link in links)])
    return PhysicalModel(
        visual=visual,
        hulls=hulls,
        lower=every.min(axis=0).tolist(),
        upper=every.max(axis=0).tolist(),
        mass=mass,
        friction=0.8,
        links=links,
    )


def _link(folder: Path, name: str, boxes: Sequence[Box], joint: Joint, mass: float) -> MovingLink:
    visual, hulls, _ = _files(folder, name, boxes, (200, 60, 40))
    return MovingLink(name=name, joint=joint, visual=visual, hulls=hulls, mass=mass)


def _corners(folder: Path, name: str, link: MovingLink) -> np.ndarray:
    return np.concatenate([trimesh.load(path).bounds for path in link.hulls])


def _files(
    folder: Path, name: str, boxes: Sequence[Box], colour: tuple[int, int, int]
) -> tuple[str, list[str], np.ndarray]:
    """Paths of the visual and the hulls, and all corners (2n, 3)."""
    parts = [trimesh.creation.box(bounds=np.array(box, dtype=float)) for box in boxes]
    hulls = []
    for i, part in enumerate(parts):
        hulls.append(str(folder / f"{name}-{i}.obj"))
        part.export(hulls[-1])
    mesh = trimesh.util.concatenate(parts)
    material = trimesh.visual.material.PBRMaterial(baseColorFactor=[*colour, 255])
    mesh.visual = trimesh.visual.TextureVisuals(material=material)
    visual = folder / f"{name}.glb"
    visual.write_bytes(mesh.export(file_type="glb"))
    return str(visual), hulls, np.concatenate([part.bounds for part in parts])


def asset_of(
    name: str, model: PhysicalModel, contacts: Sequence[ContactPoint] = (), points: Sequence[FunctionalPoint] = ()
) -> Asset:
    """An asset around a model."""
    variant = Variant(id="plain", colour="brown")
    words = Words(name=name, plural=f"{name}s", description=f"A {name}.", category="furniture")
    annotation = Annotation(
        name=name, words=words, variants=[variant], contact_points=list(contacts), functional_points=list(points)
    )
    return Asset(annotation, variant, model)


def standing(asset: Asset, pose: Pose, joints: tuple[float, ...] = ()) -> SceneObject:
    """An asset in a scene, called by its own name."""
    lower, upper = world_aabb(asset.bounds, pose).tolist()
    record = ObjectRecord(
        id=asset.name,
        asset=asset.name,
        variant=asset.variant.id,
        phrase=f"brown {asset.annotation.words.name}",
        role="context",
        pose=PoseRecord.of(pose),
        aabb=(tuple(lower), tuple(upper)),
    )
    return SceneObject(record, asset, pose, joints)
