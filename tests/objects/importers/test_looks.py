"""The look of a mesh file: pictures, colours, normals, and the word for a colour."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from vcage.base.errors import DamagedFile
from vcage.objects.colour_words import colour_word, word_of
from vcage.objects.importers.looks import load_surfaces, parts_of


def parts_in(path: Path, linear=None) -> list:
    return parts_of(load_surfaces(path), np.eye(3) if linear is None else linear, np.zeros(3))


def saved(path: Path, mesh: trimesh.Trimesh, **options) -> Path:
    path.write_bytes(trimesh.Scene(mesh).export(file_type="glb", **options))
    return path


def material(**fields) -> trimesh.visual.TextureVisuals:
    return trimesh.visual.TextureVisuals(material=trimesh.visual.material.PBRMaterial(**fields))


def test_a_material_without_a_picture_is_its_colour_as_seen_on_a_screen(tmp_path):
    mesh = trimesh.creation.box()
    mesh.visual = material(baseColorFactor=[128, 0, 0, 255], roughnessFactor=0.2, metallicFactor=0.7)
    (part,) = parts_in(saved(tmp_path / "a.glb", mesh))
    assert part.texture[0, 0].tolist() == [188, 0, 0]  # half of the light looks brighter than half
    assert (part.roughness, part.metallic) == (0.2, 0.7)


def test_a_picture_is_tinted_by_its_factor(tmp_path):
    mesh = trimesh.creation.box()
    image = Image.fromarray(np.full((2, 2, 3), 255, np.uint8))
    mesh.visual = trimesh.visual.TextureVisuals(
        uv=np.zeros((8, 2)),
        material=trimesh.visual.material.PBRMaterial(baseColorTexture=image, baseColorFactor=[255, 0, 255, 255]),
    )
    (part,) = parts_in(saved(tmp_path / "a.glb", mesh))
    assert part.texture[0, 0].tolist() == [255, 0, 255]


def test_colours_of_faces_become_a_picture_with_a_pixel_for_each(tmp_path):
    mesh = trimesh.creation.box()
    mesh.visual.face_colors = np.repeat([[250, 0, 0, 255], [0, 0, 250, 255]], 6, axis=0)
    mesh.export(tmp_path / "a.ply")
    (part,) = parts_in(tmp_path / "a.ply")
    assert part.texture.reshape(-1, 3).max(axis=0).tolist() == [250, 0, 250]
    assert len(part.faces) == 12


def test_without_any_colour_it_is_grey(tmp_path):
    trimesh.creation.box().export(tmp_path / "a.stl")
    assert colour_word(parts_in(tmp_path / "a.stl")) == "grey"


def test_the_normals_of_the_file_are_kept_and_follow_a_stretch(tmp_path):
    ball = trimesh.creation.icosphere(2)
    mesh = trimesh.Trimesh(ball.vertices, ball.faces, vertex_normals=ball.vertices, process=False)
    (part,) = parts_in(saved(tmp_path / "a.glb", mesh, include_normals=True), np.diag([1.0, 1.0, 0.25]))
    expected = part.vertices / [1, 1, 0.0625]
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    np.testing.assert_allclose(part.normals, expected, atol=1e-5)


def test_edges_are_sharp_where_the_file_has_no_normals(tmp_path):
    (part,) = parts_in(saved(tmp_path / "a.glb", trimesh.creation.box()))
    assert np.abs(part.normals).max(axis=1) == pytest.approx(1)


def test_a_reflection_turns_the_triangles_over(tmp_path):
    (part,) = parts_in(saved(tmp_path / "a.glb", trimesh.creation.box()), np.diag([1.0, -1.0, 1.0]))
    assert trimesh.Trimesh(part.vertices, part.faces).volume == pytest.approx(1)


def test_surfaces_lie_where_the_files_scene_puts_them(tmp_path):
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.creation.box(), transform=trimesh.transformations.translation_matrix([5, 0, 0]))
    (tmp_path / "a.glb").write_bytes(scene.export(file_type="glb"))
    (mesh,) = load_surfaces(tmp_path / "a.glb")
    assert mesh.bounds[:, 0].tolist() == [4.5, 5.5]


@pytest.mark.parametrize("content", [b"", b"glTF", b"{}"])
def test_a_file_without_a_mesh_is_named(tmp_path, content):
    (tmp_path / "a.glb").write_bytes(content)
    with pytest.raises(DamagedFile, match=r"a\.glb"):
        load_surfaces(tmp_path / "a.glb")


@pytest.mark.parametrize(
    ("colour", "word"),
    [
        ((10, 10, 12), "black"), ((250, 250, 245), "white"), ((128, 128, 130), "grey"), ((200, 30, 30), "red"),
        ((110, 70, 40), "brown"), ((240, 150, 40), "orange"), ((240, 220, 60), "yellow"), ((40, 150, 60), "green"),
        ((40, 80, 200), "blue"), ((130, 50, 190), "purple"), ((240, 120, 180), "pink"),
    ],
)  # fmt: skip
def test_colours_have_everyday_words(colour, word):
    assert word_of(np.array(colour)) == word


def test_invisible_needles_are_left_out(tmp_path):
    mesh = trimesh.creation.box()
    needle = [[0, 0, 0], [1, 0, 0], [1, 4e-8, 0]]
    both = trimesh.Trimesh(np.vstack([mesh.vertices, needle]), np.vstack([mesh.faces, [[8, 9, 10]]]), process=False)
    (part,) = parts_in(saved(tmp_path / "a.glb", both))
    assert len(part.faces) == 12
