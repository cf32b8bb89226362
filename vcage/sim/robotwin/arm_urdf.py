"""The URDF of one arm for our simulator, made from that of an embodiment.

Our fingers are driven to one position together, so the axis of a finger that runs the other way is reversed. A URDF
with two arms becomes one for each arm; the body that carries both stays with the first. Joints that are neither arm
nor finger become fixed. Meshes stay in their folders and are named by absolute path.
"""

from __future__ import annotations

import copy
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vcage.base.errors import DamagedFile
from vcage.base.problems import Problem, require_none
from vcage.sim.robotwin.embodiment import ArmConfig, Embodiment

FULL_TURN = 2 * np.pi
"""Range to either side of a continuous joint, radians."""

Element = ElementTree.Element


@dataclass(frozen=True)
class ArmFiles:
    """The files of an arm.

    Args:
        urdf: text.
        srdf: text, if there is one.
        meshes: text of the OBJ files beside it, by name.
    """

    urdf: bytes
    srdf: bytes | None
    meshes: dict[str, str]


def read_robot(embodiment: Embodiment) -> Element:
    """The URDF of an embodiment, with every joint of the config found in it.

    Raises:
        DamagedFile: it is not XML.
        SchemaMismatch: joints of the config are not in it, on another arm or without limits, or meshes that it names
            are missing; names all of them.
    """
    root = _parse(embodiment.urdf_path)
    problems: list[Problem] = []
    for mesh in root.iter("mesh"):
        found = _mesh_file(embodiment, mesh.get("filename", ""))
        if isinstance(found, Problem):
            problems.append(found)
        mesh.set("filename", str(found))
    joints = {joint.get("name", ""): joint for joint in root.findall("joint")}
    for i, arm in enumerate(embodiment.arms.values()):
        problems += _misplaced_joints(embodiment, root, joints, i)
        moved = [joints[name] for name in (*arm.joints, *(finger for finger, _ in arm.fingers)) if name in joints]
        problems += [problem for joint in moved for problem in _limit_problems(embodiment.urdf_path, joint)]
    require_none(problems)
    return root


def _misplaced_joints(
    embodiment: Embodiment, root: Element, joints: dict[str, Element], side: int
) -> Iterator[Problem]:
    """Joints of an arm's config that are not in the URDF, or not on the arm."""
    arm = list(embodiment.arms.values())[side]
    wanted = [(f"arm_joints_name.{side}.{k}", name) for k, name in enumerate(arm.joints)]
    wanted += [(f"ee_joints.{side}", arm.ee_joint), *((f"gripper_name.{side}", name) for name, _ in arm.fingers)]
    own = links_of_arm(root, arm) if arm.joints[0] in joints else None
    for field, name in wanted:
        if name not in joints:
            text = f"{name!r} is no joint of {embodiment.urdf_path}; expected one of {', '.join(joints)}"
            yield Problem(embodiment.path, field, text)
        elif own is not None and _end(joints[name], "child") not in own:
            text = f"{name!r} does not hang on the arm that begins with {arm.joints[0]!r}"
            yield Problem(embodiment.path, field, f"{text}; expected one that does")


def _limit_problems(path: Path, joint: Element) -> Iterator[Problem]:
    name, kind, limit = joint.get("name"), joint.get("type"), joint.find("limit")
    if kind not in ("revolute", "prismatic", "continuous"):
        yield Problem(path, f"joint {name}.type", f"got {kind!r}; expected a joint that moves")
    if kind not in ("revolute", "prismatic"):
        return
    ends = [None if limit is None else limit.get(end) for end in ("lower", "upper")]
    try:
        lower, upper = (float(end or "") for end in ends)
    except ValueError:
        lower, upper = 0.0, 0.0
    if not lower < upper:
        yield Problem(path, f"joint {name}.limit", f"got lower {ends[0]}, upper {ends[1]}; expected lower < upper")


def arm_files(root: Element, embodiment: Embodiment, side: str, visuals: bool = True) -> ArmFiles:
    """The files of one arm.

    Args:
        root: of :func:`read_robot`; it is not changed.
        visuals: keep the visual shapes.
    """
    root, arm = copy.deepcopy(root), embodiment.arms[side]
    if embodiment.dual_arm:
        _separate(root, embodiment, side)
    turned = dict(arm.fingers)
    for joint in root.findall("joint"):
        for mimic in joint.findall("mimic"):  # every finger is driven by itself
            joint.remove(mimic)
        name = joint.get("name", "")
        if joint.get("type") != "fixed" and name not in (*arm.joints, *turned):
            joint.set("type", "fixed")
        elif joint.get("type") == "continuous":
            _limit(joint)
        if turned.get(name, False):
            _reverse(joint)
    meshes = _solids_as_meshes(root)
    for link in root.findall("link") if not visuals else []:
        for visual in link.findall("visual"):
            link.remove(visual)
    return ArmFiles(ElementTree.tostring(root, encoding="utf-8"), _pairs(root, embodiment.srdf_path), meshes)


def held_joints(root: Element, embodiment: Embodiment) -> list[str]:
    """Names of movable joints that are neither arm nor finger."""
    own = {name for arm in embodiment.arms.values() for name in (*arm.joints, *(f for f, _ in arm.fingers))}
    return [j.get("name", "") for j in root.findall("joint") if j.get("type") != "fixed" and j.get("name") not in own]


def links_of_arm(root: Element, arm: ArmConfig) -> set[str]:
    """Names of the links that the arm's first joint moves."""
    first = next(joint for joint in root.findall("joint") if joint.get("name") == arm.joints[0])
    return links_below(root, [_end(first, "child")])


# --- the steps ---------------------------------------------------------------------------------------------


def _parse(path: Path) -> Element:
    try:
        return ElementTree.parse(path).getroot()
    except (OSError, ElementTree.ParseError) as error:
        raise DamagedFile(f"{path} is not XML that can be read: {error}", hint="download the robot again") from error


def _mesh_file(embodiment: Embodiment, name: str) -> Path | Problem:
    """The file of a mesh; a package is searched from the URDF's folder up to that of the config."""
    plain = Path(name.removeprefix("package://").removeprefix("file://"))
    inside = Path(*plain.parts[1:]) if name.startswith("package://") and len(plain.parts) > 1 else plain
    places = [embodiment.urdf_path.parent, *embodiment.urdf_path.parent.parents, embodiment.path.parent]
    stop = len(embodiment.path.parent.resolve().parents)
    places = [place.resolve() for place in places if len(place.resolve().parents) >= stop]
    for place in places:
        for candidate in (place / plain, place / inside):
            if candidate.is_file():
                return candidate
    text = f"{name!r} is missing; expected the file {places[0] / plain}"
    return Problem(embodiment.urdf_path, "mesh.filename", text, hint="download the robot again")


def _separate(root: Element, embodiment: Embodiment, side: str) -> None:
    """Remove the other arms; all but the first arm lose the shape of the body that carries them."""
    for other, arm in embodiment.arms.items():
        if other != side:
            gone = links_of_arm(root, arm)
            for joint in [j for j in root.findall("joint") if _end(j, "child") in gone]:
                root.remove(joint)
            for link in [x for x in root.findall("link") if x.get("name") in gone]:
                root.remove(link)
    if side == next(iter(embodiment.arms)):
        return
    own = links_of_arm(root, embodiment.arms[side])
    for link in root.findall("link"):
        for shape in [x for x in link if x.tag in ("visual", "collision")] if link.get("name") not in own else []:
            link.remove(shape)


def _limit(joint: Element) -> None:
    joint.set("type", "revolute")
    limit = joint.find("limit")
    limit = ElementTree.SubElement(joint, "limit", effort="100", velocity="3") if limit is None else limit
    limit.set("lower", str(-FULL_TURN))
    limit.set("upper", str(FULL_TURN))


def _reverse(joint: Element) -> None:
    axis, limit = joint.find("axis"), joint.find("limit")
    axis = ElementTree.SubElement(joint, "axis", xyz="1 0 0") if axis is None else axis
    axis.set("xyz", " ".join(f"{-float(x):g}" for x in axis.get("xyz", "1 0 0").split()))
    if limit is not None:
        lower, upper = float(limit.get("lower", "0")), float(limit.get("upper", "0"))
        limit.set("lower", str(-upper))
        limit.set("upper", str(-lower))


def _solids_as_meshes(root: Element) -> dict[str, str]:
    """Replace spheres and cylinders of collision shapes by meshes: planning handles boxes and convex meshes only."""
    import trimesh

    meshes = {}
    for geometry in root.iterfind(".//collision/geometry"):
        for solid in [x for x in geometry if x.tag in ("sphere", "cylinder", "capsule")]:
            radius, length = float(solid.get("radius", "0")), float(solid.get("length", "0"))
            if solid.tag == "sphere":
                mesh = trimesh.creation.icosphere(2, radius)
            elif solid.tag == "cylinder":
                mesh = trimesh.creation.cylinder(radius, length, sections=24)
            else:
                mesh = trimesh.creation.capsule(length, radius, count=[16, 16])
                mesh.apply_translation([0, 0, -mesh.bounds.mean(axis=0)[2]])
            name = f"{solid.tag}-{len(meshes)}.obj"
            meshes[name] = mesh.export(file_type="obj")
            geometry.remove(solid)
            ElementTree.SubElement(geometry, "mesh", filename=name)
    return meshes


def _pairs(root: Element, srdf: Path | None) -> bytes | None:
    """The SRDF without pairs of links that this arm does not have."""
    if srdf is None:
        return None
    tree, links = _parse(srdf), {link.get("name") for link in root.findall("link")}
    for pair in tree.findall("disable_collisions"):
        if pair.get("link1") not in links or pair.get("link2") not in links:
            tree.remove(pair)
    return ElementTree.tostring(tree, encoding="utf-8")


def _end(joint: Element, end: str) -> str:
    """Name of a joint's 'parent' or 'child'."""
    found = joint.find(end)
    return "" if found is None else found.get("link", "")


def links_below(root: Element, links: Iterable[str], *, fixed: bool = False) -> set[str]:
    """Links, and the links that joints hang on them, or fixed joints only."""
    joints = [joint for joint in root.findall("joint") if not fixed or joint.get("type") == "fixed"]
    found = set(links)
    while more := {_end(joint, "child") for joint in joints if _end(joint, "parent") in found} - found:
        found |= more
    return found
