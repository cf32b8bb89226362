from __future__ import annotations

import os
import xml.etree.ElementTree as ElementTree

import pytest
import trimesh

from vcage.base.workers import map_in_processes
from vcage.sim.render import SEEN
from vcage.sim.robots import package_file
from vcage.sim.urdf import physics_urdf, render_urdf

PANDA = "mani_skill:assets/robots/panda/panda_v2.urdf"


def faces(urdf, shadows=False):
    visuals = ElementTree.parse(urdf).getroot().iterfind(".//visual")
    meshes = [v.find("geometry/mesh").attrib["filename"] for v in visuals if (v.get("name") != SEEN) == shadows]
    return sum(len(mesh.faces) for name in meshes for mesh in trimesh.load_scene(name).geometry.values())


def test_the_copy_for_physics_has_collisions_and_no_visuals():
    root = ElementTree.parse(physics_urdf(package_file(PANDA))).getroot()
    assert root.findall(".//visual") == []
    assert len(root.findall(".//collision")) > 8


def rendered_in(cache: str) -> list[str]:
    os.environ["VCAGE_CACHE"] = cache
    folder = render_urdf(package_file(PANDA), 0.1).parent
    return sorted(path.name for path in folder.iterdir())


@pytest.mark.slow
def test_two_processes_that_lack_a_copy_do_not_disturb_each_other(tmp_path):
    first, second = map_in_processes(rendered_in, [str(tmp_path)] * 2, 2)
    assert first == second and "hand.glb" in first


def test_the_copy_for_rendering_keeps_about_the_requested_share():
    source = package_file(PANDA)
    share = faces(render_urdf(source, 0.1)) / faces(render_urdf(source, 1.0), shadows=True)
    assert 0.08 < share < 0.13


def test_every_mesh_has_a_twin_of_few_triangles_that_throws_its_shadow():
    half = render_urdf(package_file(PANDA), 0.5)
    assert 0 < faces(half, shadows=True) < 0.1 * faces(half)


def test_decimated_meshes_keep_their_size_and_colours():
    source = package_file(PANDA)
    for name in ("link5.glb", "hand.glb"):
        original = trimesh.load_scene(source.parent / "franka_description/meshes/visual" / name)
        small = trimesh.load_scene(render_urdf(source, 0.1).parent / name)
        assert abs(original.bounds - small.bounds).max() < 0.004
        assert set(small.geometry) == set(original.geometry)
        for key, mesh in small.geometry.items():
            colour = original.geometry[key].visual.material.baseColorFactor
            assert (mesh.visual.material.baseColorFactor == colour).all()


def test_copies_are_made_once():
    source = package_file(PANDA)
    first = render_urdf(source, 0.1)
    before = first.stat().st_mtime_ns
    assert render_urdf(source, 0.1).stat().st_mtime_ns == before
