"""URDF copies in the cache: one without visuals for physics, one with decimated visuals for rendering.

Physics needs a file without visuals, because SAPIEN makes render materials while parsing, which aborts where
there is no rendering device. Rendering time is ruled by the triangle count (see the render benchmark).
"""

from __future__ import annotations

import hashlib
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np

from vcage.base.files import atomic_folder, cache_dir, sha256_file
from vcage.base.hold import one_at_a_time

RECIPE = 1
"""Raised when these functions change what they write, so that older cached copies are not used."""


def physics_urdf(source: Path) -> Path:
    """The URDF without visuals; collision meshes by absolute path."""
    return _cached(source, "physics", None)


def render_urdf(source: Path, faces: float) -> Path:
    """The whole URDF, with the share ``faces`` of the triangles of its visual meshes (1: the originals)."""
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
        for mesh in root.iterfind(".//visual//mesh"):
            path = Path(mesh.attrib["filename"])
            small = part / f"{path.stem}.glb"
            if not small.exists():
                decimate(path, small, faces)
            mesh.set("filename", str(folder / small.name))
    return ElementTree.tostring(root, encoding="utf-8")


def decimate(source: Path, target: Path, share: float) -> None:
    """Write a GLB with about ``share`` of the triangles of each mesh of ``source``, with its materials.

    Quadric edge collapse (Garland and Heckbert, 1997) after welding vertices; the shading stays smooth except at
    edges sharper than 30 degrees.

    Args:
        source: a mesh file.
        target: the GLB.
        share: of the triangles, in (0, 1].
    """
    import trimesh

    scene = trimesh.load_scene(source)
    small = trimesh.Scene()
    for name in scene.graph.nodes_geometry:
        transform, geometry = scene.graph[name]
        mesh = scene.geometry[str(geometry)]
        welded = trimesh.Trimesh(mesh.vertices, mesh.faces, process=True)
        count = max(32, int(np.ceil(len(welded.faces) * share)))
        reduced = welded.simplify_quadric_decimation(face_count=count) if len(welded.faces) > count else welded
        shaded = trimesh.graph.smooth_shade(reduced, angle=np.radians(30))
        shaded.visual = trimesh.visual.TextureVisuals(material=mesh.visual.material)
        small.add_geometry(shaded, node_name=name, geom_name=str(geometry), transform=transform)
    target.write_bytes(small.export(file_type="glb", include_normals=True))
