"""URDF copies in the cache: one without visuals for physics, one with decimated visuals for rendering.

Physics needs a file without visuals: SAPIEN makes render materials while parsing and aborts without a rendering
device. Rendering time depends on the number of triangles (see the render benchmark), visible or throwing shadows. A
shadow needs far fewer, so every mesh has an invisible twin that throws it.
"""

from __future__ import annotations

import copy
import functools
import hashlib
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vcage.base.files import atomic_folder, cache_dir, sha256_file
from vcage.base.hold import one_at_a_time
from vcage.sim.render import SEEN, UNSEEN

if TYPE_CHECKING:
    import trimesh

RECIPE = 2
"""Raised when the output of these functions changes, so that older cached copies are not used."""


def physics_urdf(source: Path) -> Path:
    """The URDF without visuals; collision meshes by absolute path."""
    return _cached(source, "physics", None)


def render_urdf(source: Path, faces: float) -> Path:
    """The whole URDF, with the share ``faces`` of the triangles of its visual meshes (1: as they came).

    With less than 1, every visual mesh has a twin, invisible, that throws its shadow; the mesh itself, whose name is
    then :data:`vcage.sim.render.SEEN`, need throw none.
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
                    _replace_mesh(visual, part, folder, ".glb", functools.partial(decimate, share=faces))
    return ElementTree.tostring(root, encoding="utf-8")


def _shadow_of(visual: ElementTree.Element, part: Path, folder: Path) -> ElementTree.Element:
    """The visual's twin that throws its shadow; its mesh of few triangles is written to ``part``."""
    twin = copy.deepcopy(visual)
    visual.set("name", SEEN)
    for material in twin.findall("material"):
        twin.remove(material)
    colour = ElementTree.SubElement(ElementTree.SubElement(twin, "material", name="unseen"), "color")
    colour.set("rgba", " ".join(str(value) for value in UNSEEN))
    _replace_mesh(twin, part, folder, ".shadow.glb", _write_shadow)
    return twin


def _replace_mesh(
    visual: ElementTree.Element, part: Path, folder: Path, ending: str, write: Callable[[Path, Path], None]
) -> None:
    """Let a visual name a lighter mesh, which ``write`` makes of its own one into ``part`` unless it is there."""
    mesh = visual.find("geometry/mesh")
    assert mesh is not None
    source = Path(mesh.attrib["filename"])
    target = part / f"{source.stem}{ending}"
    if not target.exists():
        write(source, target)
    mesh.set("filename", str(folder / target.name))


def _write_shadow(source: Path, target: Path, faces: int = 120) -> None:
    """Write a GLB with about ``faces`` triangles for the whole of ``source``.

    So few are enough: the edge of a shadow is three texels of 5 mm wide.
    """
    import trimesh

    whole = trimesh.load_scene(source).to_mesh()
    target.write_bytes(trimesh.Scene(_reduced(whole, faces)).export(file_type="glb", include_normals=True))


def decimate(source: Path, target: Path, share: float, least_faces: int = 200) -> None:
    """Write a GLB with about ``share`` of the triangles of each mesh of ``source``, with its materials.

    The shading stays smooth except at edges sharper than 30 degrees.

    Args:
        source: a mesh file.
        target: the GLB.
        share: of the triangles, in (0, 1].
        least_faces: of a mesh of one material: a finger tip fills much of a wrist camera's picture.
    """
    import trimesh

    scene = trimesh.load_scene(source)
    small = trimesh.Scene()
    for name in scene.graph.nodes_geometry:
        transform, geometry = scene.graph[name]
        mesh = scene.geometry[str(geometry)]
        reduced = _reduced(mesh, max(least_faces, int(np.ceil(len(mesh.faces) * share))))
        shaded = trimesh.graph.smooth_shade(reduced, angle=np.radians(30))
        shaded.visual = trimesh.visual.TextureVisuals(material=mesh.visual.material)
        small.add_geometry(shaded, node_name=name, geom_name=str(geometry), transform=transform)
    target.write_bytes(small.export(file_type="glb", include_normals=True))


def _reduced(mesh: trimesh.Trimesh, faces: int, aggression: int = 3) -> trimesh.Trimesh:
    """A mesh with about ``faces`` triangles at most: vertices are welded, then edges collapse.

    M. Garland and P. Heckbert, Surface Simplification Using Quadric Error Metrics, SIGGRAPH 1997.

    Args:
        aggression: of fast-simplification, 0 (careful) to 10. At its default of 7, pictures of the Panda with a tenth
            of its triangles differ three times as much from those of the whole as with 3 and a thirtieth, and shadows
            get holes; at 1 it stops at four times as many triangles.
    """
    import trimesh

    welded = trimesh.Trimesh(mesh.vertices, mesh.faces, process=True)
    if len(welded.faces) <= faces:
        return welded
    return welded.simplify_quadric_decimation(face_count=faces, aggression=aggression)
