"""The part of URDF that describes an object: links with meshes, and the joints between them."""

from __future__ import annotations

import os.path
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh
from scipy.spatial.transform import Rotation

from vcage.base.errors import DamagedFile, mismatch
from vcage.base.inside import path_complaint
from vcage.base.placeholders import require_fetched
from vcage.objects.importers.looks import load_surfaces

MOVING = ("revolute", "continuous", "prismatic")


@dataclass(frozen=True)
class Shape:
    """A mesh or a simple solid of a link.

    Args:
        origin: (4, 4) in the link's frame.
        source: the file of a mesh, or a simple solid.
        scale: (3,) of the mesh.
        root: folder of the URDF, to which names in the mesh may lead.
    """

    origin: np.ndarray
    source: Path | trimesh.Trimesh
    scale: np.ndarray
    root: Path

    def surfaces(self) -> list[trimesh.Trimesh]:
        """Surfaces in the shape's own frame, before :attr:`scale`."""
        return load_surfaces(self.source, self.root) if isinstance(self.source, Path) else [self.source]


@dataclass(frozen=True)
class UrdfJoint:
    """A joint as written; ``lower`` and ``upper`` are None without a limit."""

    name: str
    kind: str
    parent: str
    child: str
    origin: np.ndarray
    axis: np.ndarray
    lower: float | None
    upper: float | None
    damping: float | None
    friction: float | None


@dataclass(frozen=True)
class Urdf:
    """A tree of links.

    Args:
        path: of the file.
        root: the link that no joint carries.
        visuals, collisions: shapes by link.
        joints: in the order in which SAPIEN numbers them: level by level from the root, as written within a level.
    """

    path: Path
    root: str
    visuals: dict[str, list[Shape]]
    collisions: dict[str, list[Shape]]
    joints: list[UrdfJoint]

    @property
    def moving(self) -> list[UrdfJoint]:
        """The joints that move, in SAPIEN's order."""
        return [joint for joint in self.joints if joint.kind in MOVING]


def read_urdf(path: Path) -> Urdf:
    """Read an object's URDF; every mesh it names exists.

    Raises:
        DamagedFile: it is not XML, or no regular file.
        SchemaMismatch: it is no tree, or a link, joint or mesh is invalid; names it.
    """
    require_fetched(path)
    try:
        robot = ElementTree.parse(path).getroot()
    except (OSError, ElementTree.ParseError) as error:
        raise DamagedFile(
            f"{path} is not a URDF that can be read: {error}", hint="download the object again"
        ) from error
    links = {link.get("name", ""): link for link in robot.findall("link")}
    joints = [_joint(path, element, links) for element in robot.findall("joint")]
    root = _root(path, list(links), joints)
    shapes = {
        kind: {name: [_shape(path, name, kind, x) for x in link.findall(kind)] for name, link in links.items()}
        for kind in ("visual", "collision")
    }
    return Urdf(path, root, shapes["visual"], shapes["collision"], _by_level(path, root, joints))


def _root(path: Path, links: Sequence[str], joints: Sequence[UrdfJoint]) -> str:
    children = [joint.child for joint in joints]
    roots = [name for name in links if name not in children]
    if len(roots) != 1 or len(set(children)) != len(children):
        raise mismatch(path, "link", f"got the roots {roots}; expected one link that no joint carries, and a tree")
    return roots[0]


def _by_level(path: Path, root: str, joints: Sequence[UrdfJoint]) -> list[UrdfJoint]:
    order, level = [], [root]
    while level:
        found = [joint for parent in level for joint in joints if joint.parent == parent]
        order += found
        level = [joint.child for joint in found]
    if len(order) != len(joints):
        lost = sorted({joint.name for joint in joints} - {joint.name for joint in order})
        raise mismatch(path, "joint", f"{lost} hang on no link that the root carries")
    return order


def _joint(path: Path, element: ElementTree.Element, links: dict[str, ElementTree.Element]) -> UrdfJoint:
    name, kind = element.get("name", ""), element.get("type", "")
    if kind not in (*MOVING, "fixed"):
        raise mismatch(path, f"joint {name}", f"type {kind!r}; expected one of {', '.join((*MOVING, 'fixed'))}")
    ends = []
    for end in ("parent", "child"):
        found = element.find(end)
        link = "" if found is None else found.get("link", "")
        if link not in links:
            raise mismatch(path, f"joint {name}.{end}", f"{link!r} is no link; expected one of {', '.join(links)}")
        ends.append(link)
    axis = _vector(path, f"joint {name}.axis", element.find("axis"), "xyz", (1.0, 0.0, 0.0))
    length = float(np.linalg.norm(axis))
    if length < 1e-9:
        raise mismatch(path, f"joint {name}.axis", "got 0 0 0; expected a direction")
    origin = _origin(path, f"joint {name}", element.find("origin"))
    limits = [_limit(path, f"joint {name}.limit.{end}", element.find("limit"), end) for end in ("lower", "upper")]
    dynamics = [
        _limit(path, f"joint {name}.dynamics.{x}", element.find("dynamics"), x) for x in ("damping", "friction")
    ]
    return UrdfJoint(name, kind, ends[0], ends[1], origin, axis / length, *limits, *dynamics)


def _limit(path: Path, field: str, element: ElementTree.Element | None, name: str) -> float | None:
    text = None if element is None else element.get(name)
    return None if text is None else float(_numbers(path, field, text, 1)[0])


def _shape(path: Path, link: str, kind: str, element: ElementTree.Element) -> Shape:
    field = f"link {link}.{kind}"
    origin, geometry = _origin(path, field, element.find("origin")), element.find("geometry")
    mesh = None if geometry is None else geometry.find("mesh")
    if mesh is None:
        return Shape(origin, _solid(path, field, geometry), np.ones(3), path.parent)
    name = mesh.get("filename", "")
    inside = name.removeprefix("package://").removeprefix("file://")
    if complaint := path_complaint(inside):
        raise mismatch(path, f"{field}.mesh", complaint, "leave the object out")
    file = path.parent / inside
    if not os.path.lexists(file):
        raise mismatch(path, f"{field}.mesh", f"{name!r} is missing; expected the file {file}", "download it again")
    return Shape(origin, file, _vector(path, f"{field}.mesh", mesh, "scale", (1.0, 1.0, 1.0)), path.parent)


def _solid(path: Path, field: str, geometry: ElementTree.Element | None) -> trimesh.Trimesh:
    for element in [] if geometry is None else geometry:
        if element.tag == "box":
            return trimesh.creation.box(_vector(path, f"{field}.box", element, "size", None))
        if element.tag == "sphere":
            return trimesh.creation.icosphere(2, float(_numbers(path, field, element.get("radius", ""), 1)[0]))
        if element.tag == "cylinder":
            radius, length = (_numbers(path, field, element.get(x, ""), 1)[0] for x in ("radius", "length"))
            return trimesh.creation.cylinder(float(radius), float(length))
    raise mismatch(path, f"{field}.geometry", "expected a mesh, box, sphere or cylinder")


def _origin(path: Path, field: str, element: ElementTree.Element | None) -> np.ndarray:
    """(4, 4) of an ``<origin>``, unscaled."""
    matrix = np.eye(4)
    matrix[:3, 3] = _vector(path, f"{field}.origin", element, "xyz", (0.0, 0.0, 0.0))
    angles = _vector(path, f"{field}.origin", element, "rpy", (0.0, 0.0, 0.0))
    matrix[:3, :3] = Rotation.from_euler("xyz", angles).as_matrix()
    return matrix


def _vector(
    path: Path, field: str, element: ElementTree.Element | None, name: str, default: Sequence[float] | None
) -> np.ndarray:
    text = None if element is None else element.get(name)
    if text is None and default is not None:
        return np.array(default)
    return _numbers(path, f"{field}.{name}", text or "", 3)


def _numbers(path: Path, field: str, text: str, count: int) -> np.ndarray:
    try:
        values = np.array([float(x) for x in text.split()])
    except ValueError:
        values = np.zeros(0)
    if len(values) != count or not np.isfinite(values).all():
        raise mismatch(path, field, f"got {text!r}; expected {count} number{'s' if count > 1 else ''}")
    return values
