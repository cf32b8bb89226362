"""URDF copies in the cache: one without visuals for physics, one with decimated visuals for rendering.

Physics needs a file without visuals: SAPIEN makes render materials while parsing and aborts without a rendering
device. Rendering time depends on the number of triangles (see the render benchmark), visible or throwing shadows. A
shadow needs far fewer, so every mesh has an invisible twin that throws it.
"""

from __future__ import annotations

import copy
import hashlib
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vcage.base.files import atomic_folder, cache_dir, sha256_file
from vcage.base.hold import one_at_a_time
from vcage.sim.shadows import SEEN, UNSEEN

if TYPE_CHECKING:
    import trimesh

RECIPE = 2
"""Raised when the output of these functions changes, so that older cached copies are not used."""


@dataclass(frozen=True)
class DecimationSettings:
    """Numbers of triangles.

    Args:
        least_faces: of a mesh of one material: a finger tip fills much of a wrist camera's picture.
        shadow_faces: of the twin that throws the shadow of a mesh; the shadow's edge is three texels of 5 mm wide.
        aggression: of fast-simplification, 0 (careful) to 10. At its default of 7, pictures of the Panda with a tenth
            of its triangles differ three times as much from those of the whole as with 3 and a thirtieth, and shadows
            get holes; at 1 it stops at four times as many triangles.
    """

    least_faces: int = 200
    shadow_faces: int = 120
    aggression: int = 3


DECIMATION = DecimationSettings()


def physics_urdf(source: Path) -> Path:
    """The URDF without visuals; collision meshes by absolute path."""
    return _cached(source, "physics", None)


def render_urdf(source: Path, faces: float) -> Path:
    """The whole URDF, with the share ``faces`` of the triangles of its visual meshes (1: as they came).

    With less than 1, every visual mesh has a twin, invisible, that throws its shadow; the mesh itself, whose name is
    then :data:`vcage.sim.shadows.SEEN`, need throw none.
    """
    return _cached(source, "render", faces)


def _cached(source: Path, kind: str, faces: float | None) -> Path:
    key = f"{RECIPE}|{kind}|{faces}|{source.resolve()}|{sha256_file(source)}"
    folder = cache_dir("robots") / f"{source.stem}-{kind}-{hashlib.sha256(key.encode()).hexdigest()[:16]}"
    target = folder / source.name
    if not target.is_file():
        with one_at_a_time(folder):
            if not target.is_file():
                with atomic_folder(folder) as part:
                    (part / source.name).write_bytes(_rewritten(source, part, folder, faces))
    return target


def _rewritten(source: Path, part: Path, folder: Path, faces: float | None) -> bytes:
    """The URDF's text for a copy that is written to ``part`` now and lies in ``folder`` later."""
    root = ElementTree.parse(source).getroot()
    for link in root.iter("link"):
        for visual in link.findall("visual"):
            if faces is None:
                link.remove(visual)
    for mesh in root.iter("mesh"):
        path = (source.parent / mesh.attrib["filename"].removeprefix("package://")).resolve()
        mesh.set("filename", str(path))
    if faces is not None and faces < 1:
        for link in root.iter("link"):
            for visual in link.findall("visual"):
                if visual.find("geometry/mesh") is not None:
                    link.append(_shadow_of(visual, part, folder))
                    _lighten(visual, part, folder, faces)
    return ElementTree.tostring(root, encoding="utf-8")


def _shadow_of(visual: ElementTree.Element, part: Path, folder: Path) -> ElementTree.Element:
    """The visual's twin that throws its shadow; its mesh of few triangles is written to ``part``."""
    twin = copy.deepcopy(visual)
    visual.set("name", SEEN)
    for material in twin.findall("material"):
        twin.remove(material)
    colour = ElementTree.SubElement(ElementTree.SubElement(twin, "material", name="unseen"), "color")
    colour.set("rgba", " ".join(str(value) for value in UNSEEN))
    mesh = _mesh_of(twin)
    path = Path(mesh.attrib["filename"])
    coarse = part / f"{path.stem}.shadow.glb"
    if not coarse.exists():
        _write_shadow(path, coarse)
    mesh.set("filename", str(folder / coarse.name))
    return twin


def _lighten(visual: ElementTree.Element, part: Path, folder: Path, faces: float) -> None:
    """Reduce a visual to the share ``faces`` of its triangles."""
    mesh = _mesh_of(visual)
    path = Path(mesh.attrib["filename"])
    small = part / f"{path.stem}.glb"
    if not small.exists():
        decimate(path, small, faces)
    mesh.set("filename", str(folder / small.name))


def _mesh_of(visual: ElementTree.Element) -> ElementTree.Element:
    mesh = visual.find("geometry/mesh")
    assert mesh is not None
    return mesh


def _write_shadow(source: Path, target: Path) -> None:
    """Write a GLB with about ``shadow_faces`` triangles for the whole of ``source``."""
    import trimesh

    whole = trimesh.load_scene(source).to_mesh()
    target.write_bytes(
        trimesh.Scene(_reduced(whole, DECIMATION.shadow_faces)).export(file_type="glb", include_normals=True)
    )


def decimate(source: Path, target: Path, share: float) -> None:
    """Write a GLB with about ``share`` of the triangles of each mesh of ``source``, with its materials.

    The shading stays smooth except at edges sharper than 30 degrees.

    Args:
        source: a mesh file.
        target: the GLB.
        share: of the triangles, in (0, 1]; a mesh keeps ``least_faces`` anyway.
    """
    import trimesh

    scene = trimesh.load_scene(source)
    small = trimesh.Scene()
    for name in scene.graph.nodes_geometry:
        transform, geometry = scene.graph[name]
        mesh = scene.geometry[str(geometry)]
        reduced = _reduced(mesh, max(DECIMATION.least_faces, int(np.ceil(len(mesh.faces) * share))))
        shaded = trimesh.graph.smooth_shade(reduced, angle=np.radians(30))
        shaded.visual = trimesh.visual.TextureVisuals(material=mesh.visual.material)
        small.add_geometry(shaded, node_name=name, geom_name=str(geometry), transform=transform)
    target.write_bytes(small.export(file_type="glb", include_normals=True))


def _reduced(mesh: trimesh.Trimesh, faces: int) -> trimesh.Trimesh:
    """A mesh with about ``faces`` triangles at most: vertices are welded, then edges collapse.

    M. Garland and P. Heckbert, Surface Simplification Using Quadric Error Metrics, SIGGRAPH 1997.
    """
    import trimesh

    welded = trimesh.Trimesh(mesh.vertices, mesh.faces, process=True)
    if len(welded.faces) <= faces:
        return welded
    return welded.simplify_quadric_decimation(face_count=faces, aggression=DECIMATION.aggression)
