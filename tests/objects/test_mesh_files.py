"""Files named by a mesh: regular files of its object are read; pipes and files elsewhere are not."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from vcage.base.errors import DamagedFile
from vcage.objects.convex import load_convex
from vcage.objects.importers.looks import load_surfaces, parts_of
from vcage.objects.importers.urdf import read_urdf
from vcage.objects.mesh_files import MeshFiles, report_unseen_textures

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl wood\nf 1/1 2/2 3/3\n"


def obj(folder: Path, *, library: str = "look.mtl", texture: str = "wood.png") -> Path:
    """A triangle with a material; only the file of the triangle and that of the material are written."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "a.obj"
    path.write_text(f"mtllib {library}\n{TRIANGLE}")
    (folder / library).parent.mkdir(exist_ok=True)
    (folder / library).write_text(f"newmtl wood\nKd 1 1 1\nmap_Kd {texture}\n")
    return path


def gltf(folder: Path, name: str) -> Path:
    """A textured box with buffers and pictures in files; the one of the given name becomes a pipe."""
    mesh = trimesh.creation.box()
    material = trimesh.visual.material.PBRMaterial(baseColorTexture=Image.new("RGB", (4, 4)))
    mesh.visual = trimesh.visual.TextureVisuals(uv=np.zeros((len(mesh.vertices), 2)), material=material)
    files = trimesh.Scene(mesh).export(file_type="gltf")
    header = json.loads(files.pop("model.gltf"))
    header["images"].append({"uri": "image_0.png"})
    (folder / "model.gltf").write_text(json.dumps(header))
    for file, data in files.items():
        (folder / file).write_bytes(data)
    pipe(folder / name)
    return folder / "model.gltf"


def pipe(path: Path) -> Path:
    path.unlink(missing_ok=True)
    os.mkfifo(path)
    return path


@pytest.mark.parametrize(
    "read", [load_surfaces, lambda path: report_unseen_textures(path, print)], ids=["mesh", "textures"]
)
@pytest.mark.parametrize("name", ["wood.png", "look.mtl", "a.obj"])
def test_a_pipe_that_an_obj_names_is_refused_by_name(tmp_path, read, name) -> None:
    path = obj(tmp_path)
    pipe(tmp_path / name)
    with pytest.raises(DamagedFile, match=rf"a\.obj.*{name} is no regular file|a\.obj is no regular file"):
        read(path)


@pytest.mark.parametrize(
    "read", [load_surfaces, lambda path: report_unseen_textures(path, print)], ids=["mesh", "textures"]
)
@pytest.mark.parametrize("name", ["gltf_buffer_0.bin", "image_0.png"])
def test_a_pipe_that_a_gltf_names_is_refused_by_name(tmp_path, read, name) -> None:
    path = gltf(tmp_path, name)
    with pytest.raises(DamagedFile, match=rf"model\.gltf names '{name}': .* is no regular file"):
        read(path)


def test_a_picture_in_a_buffer_of_its_own_is_not_called_missing(tmp_path) -> None:
    path = gltf(tmp_path, "image_0.png")
    (tmp_path / "image_0.png").unlink()
    report_unseen_textures(path, pytest.fail)


def test_a_texture_elsewhere_in_the_object_is_read_and_one_outside_of_it_is_not(tmp_path) -> None:
    path = obj(tmp_path / "object" / "meshes", texture="../images/wood.png")
    images = tmp_path / "object" / "images"
    images.mkdir()
    Image.new("RGB", (4, 4), (1, 2, 200)).save(images / "wood.png")
    told: list[str] = []
    for root, colour in ((tmp_path / "object", [1, 2, 200]), (None, [255, 255, 255])):
        (part,) = parts_of(load_surfaces(path, root), np.eye(3), np.zeros(3))
        assert part.texture[0, 0].tolist() == colour
        report_unseen_textures(path, told.append, root)
    assert len(told) == 1 and "'../images/wood.png' is missing" in told[0]


def test_a_texture_is_looked_for_beside_its_library_of_materials(tmp_path) -> None:
    path = obj(tmp_path, library="materials/look.mtl")
    Image.new("RGB", (4, 4), (1, 2, 200)).save(tmp_path / "materials" / "wood.png")
    report_unseen_textures(path, pytest.fail)
    (part,) = parts_of(load_surfaces(path), np.eye(3), np.zeros(3))
    assert part.texture[0, 0].tolist() == [1, 2, 200]


@pytest.mark.parametrize("name", ["wo%6Fd.png", "/home/me/textures/wood.png", " wood.png "])
def test_a_file_is_found_by_the_names_that_exporters_write(tmp_path, name) -> None:
    (tmp_path / "wood.png").touch()
    assert MeshFiles(tmp_path / "a.obj").find(name) == tmp_path / "wood.png"


@pytest.mark.parametrize("name", ["/etc/passwd", "../secret", "a\0b", "", "gone.png"])
def test_an_object_elsewhere_or_missing_is_not_found(tmp_path, name) -> None:
    (tmp_path / "secret").touch()
    (tmp_path / "object").mkdir()
    assert MeshFiles(tmp_path / "object" / "a.obj").find(name) is None


@pytest.mark.parametrize("read", [load_convex, read_urdf])
def test_a_pipe_in_place_of_a_file_of_an_object_is_refused(tmp_path, read) -> None:
    with pytest.raises(DamagedFile, match="is no regular file"):
        read(pipe(tmp_path / "a"))


def test_a_convex_piece_that_names_another_file_is_refused(tmp_path) -> None:
    (tmp_path / "hull.obj").write_text("mtllib look.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n")
    with pytest.raises(DamagedFile, match="names a file of materials"):
        load_convex(tmp_path / "hull.obj")
