"""Small objects in RoboTwin's format, built of boxes; coordinates of rigid ones are y up, as there."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

SCALE = 0.025

TOP_DOWN = [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]
"""A contact frame whose y points up: the gripper comes from above and closes along the mesh's x."""

INTO = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
"""A functional frame whose z points down, into what receives."""


def frame(rotation: Any, position: Any) -> list[list[float]]:
    """4×4, as RoboTwin writes it."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation, position
    return matrix.tolist()


def tray_boxes() -> list[trimesh.Trimesh]:
    """An open box, 8 × 2 × 4 mesh units, y up, standing on y = 1 and off the middle: floor 0.2 thick, walls 0.2."""
    bounds = [
        [(1, 1, -2), (9, 1.2, 2)],
        [(1, 1.2, -2), (1.2, 3, 2)],
        [(8.8, 1.2, -2), (9, 3, 2)],
        [(1.2, 1.2, -2), (8.8, 3, -1.8)],
        [(1.2, 1.2, 1.8), (8.8, 3, 2)],
    ]
    return [trimesh.creation.box(bounds=b) for b in bounds]


def painted(parts: list[trimesh.Trimesh], colour: tuple[int, int, int] = (200, 30, 30)) -> trimesh.Trimesh:
    mesh = trimesh.util.concatenate(parts)
    material = trimesh.visual.material.PBRMaterial(baseColorFactor=[*colour, 255], roughnessFactor=0.3)
    mesh.visual = trimesh.visual.TextureVisuals(material=material)
    return mesh


class Rigid:
    """A rigid object's folder: fields of ``model_data0.json`` can be changed before :meth:`write`."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.parts = tray_boxes()
        self.info: dict[str, Any] | None = None
        self.data: dict[str, Any] = {
            "center": [5, 2, 0],
            "extents": [8, 2, 4],
            "scale": [SCALE, SCALE, SCALE],
            "contact_points_pose": [frame(TOP_DOWN, [1.1, 2.8, 0]), frame(TOP_DOWN, [8.9, 2.8, 0.5])],
            "functional_matrix": [frame(INTO, [5, 1.25, 0])],
            "orientation_point": [],
            "contact_points_group": [[0], [1]],
            "contact_points_mask": [True, True],
            "contact_points_discription": ["left wall", "right wall"],
            "functional_point_discription": ["the inside"],
            "stable": True,
        }

    def write(self, number: int = 0, visual: bool = True, collision: bool = True, data: bool = True) -> Rigid:
        for kind, wanted in (("visual", visual), ("collision", collision)):
            (self.folder / kind).mkdir(parents=True, exist_ok=True)
            if wanted:
                (self.folder / kind / f"base{number}.glb").write_bytes(painted(self.parts).export(file_type="glb"))
        if data:
            (self.folder / f"model_data{number}.json").write_text(json.dumps(self.data))
        if self.info is not None:
            (self.folder / "points_info.json").write_text(json.dumps(self.info))
        return self


class Cabinet:
    """An articulated object's folder: a box, z up, open at its front (-x), with a drawer that slides out of it."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.data: dict[str, Any] = {
            "scale": 0.5,
            "transform_matrix": np.eye(4).tolist(),
            "init_qpos": [0.0],
            "mass": {"body": 2.0, "drawer": 0.3},
            "contact_points": [
                {"matrix": frame([[0, -1, 0], [0, 0, -1], [1, 0, 0]], [-0.55, 0, 0.1]), "base": "drawer"}
            ],
            "functional_points": [
                {"matrix": frame([[1, 0, 0], [0, -1, 0], [0, 0, -1]], [0, 0, 0.03]), "base": "drawer"}
            ],
            "contact_points_discription": ["handle"],
        }
        self.limit = '<limit lower="0" upper="0.4" effort="1" velocity="1"/>'
        self.joint = "prismatic"
        wall = 0.02
        self.body = [
            [(-0.4, -0.3, 0), (0.4, 0.3, wall)],
            [(0.4 - wall, -0.3, wall), (0.4, 0.3, 0.3)],
            [(-0.4, -0.3, wall), (0.4 - wall, -0.3 + wall, 0.3)],
            [(-0.4, 0.3 - wall, wall), (0.4 - wall, 0.3, 0.3)],
        ]
        self.drawer = [
            [(-0.38, -0.26, 0), (0.34, 0.26, 0.02)],
            [(-0.38, -0.26, 0.02), (-0.36, 0.26, 0.2)],
            [(0.32, -0.26, 0.02), (0.34, 0.26, 0.2)],
            [(-0.36, -0.26, 0.02), (0.32, -0.24, 0.2)],
            [(-0.36, 0.24, 0.02), (0.32, 0.26, 0.2)],
            [(-0.56, -0.05, 0.09), (-0.38, 0.05, 0.11)],
        ]

    def write(self, meshes: bool = True, data: bool = True) -> Cabinet:
        self.folder.mkdir(parents=True, exist_ok=True)
        for name, boxes in (("body", self.body), ("drawer", self.drawer)):
            mesh = trimesh.util.concatenate([trimesh.creation.box(bounds=b) for b in boxes])
            if meshes:
                mesh.export(self.folder / f"{name}.obj")
        if data:
            (self.folder / "model_data.json").write_text(json.dumps(self.data))
        (self.folder / "mobility.urdf").write_text(self.urdf())
        return self

    def urdf(self) -> str:
        def link(name: str) -> str:
            mesh = f'<geometry><mesh filename="{name}.obj"/></geometry>'
            return f'<link name="{name}"><visual>{mesh}</visual><collision>{mesh}</collision></link>'

        return f"""<robot name="cabinet">
          <link name="base"/>{link("body")}{link("drawer")}
          <joint name="fixing" type="fixed"><parent link="base"/><child link="body"/></joint>
          <joint name="sliding" type="{self.joint}"><origin xyz="0 0 0.04"/><axis xyz="-1 0 0"/>
            <parent link="body"/><child link="drawer"/>{self.limit}</joint>
        </robot>"""


@pytest.fixture
def rigid(tmp_path: Path) -> Rigid:
    return Rigid(tmp_path / "objects" / "003_deep-tray")


@pytest.fixture
def cabinet(tmp_path: Path) -> Cabinet:
    return Cabinet(tmp_path / "objects" / "036_cabinet" / "46653")


@pytest.fixture
def into(tmp_path: Path) -> Path:
    return tmp_path / "imported"
