"""Small robots in RoboTwin's format: arms of two links with a gripper of two sliding fingers, built of boxes."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import trimesh
import yaml

HAND, FINGER = (0.06, 0.2, 0.05), (0.02, 0.01, 0.06)
"""Sizes of palm and finger, metres."""

CONFIG: dict[str, Any] = {
    "urdf_path": "./arm.urdf",
    "joint_stiffness": 1000,
    "joint_damping": 200,
    "ee_joints": ["wrist", "wrist"],
    "arm_joints_name": [["shoulder", "elbow"], ["shoulder", "elbow"]],
    "gripper_name": [{"base": "finger1", "mimic": [["finger2", 1.0, 0.0]]}] * 2,
    "gripper_bias": 0.1,
    "gripper_scale": [0.0, 0.03],
    "homestate": [[0.1, 0.2], [0.1, 0.2]],
    "delta_matrix": [[0, 0, 1], [0, -1, 0], [1, 0, 0]],
    "global_trans_matrix": [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
    "robot_pose": [[0, -0.65, 0.75, 0.70710678, 0, 0, 0.70710678]],
    "static_camera_list": [
        {"name": "head_camera", "position": [0, -0.45, 1.3], "forward": [0, 0.6, -0.8], "left": [-1, 0, 0]}
    ],
}


def config(**changes: Any) -> dict[str, Any]:
    """The config with other fields; None takes one out."""
    fields = {**copy.deepcopy(CONFIG), **changes}
    return {name: value for name, value in fields.items() if value is not None}


def arm(prefix: str = "", parent: str = "base", at: str = "0 0 0.1", mirrored: bool = False) -> str:
    """Links and joints of one arm; the second finger's joint may run the other way, as the Piper's does."""
    axis, lower, upper = ("0 1 0", -0.03, 0) if mirrored else ("0 -1 0", 0, 0.03)
    limit = '<limit lower="-1.5" upper="1.5" effort="50" velocity="2"/>'

    def link(name: str, size: tuple[float, ...], z: float) -> str:
        box = f'<geometry><box size="{" ".join(map(str, size))}"/></geometry>'
        return f'<link name="{prefix}{name}"><collision><origin xyz="0 0 {z}"/>{box}</collision></link>'

    def joint(name: str, kind: str, up: str, down: str, rest: str) -> str:
        ends = f'<parent link="{up}"/><child link="{prefix}{down}"/>'
        return f'<joint name="{prefix}{name}" type="{kind}">{ends}{rest}</joint>'

    return "".join(
        [
            link("upper", (0.05, 0.05, 0.2), 0.1),
            link("lower", (0.05, 0.05, 0.2), 0.1),
            link("hand", HAND, HAND[2] / 2),
            link("left_finger", FINGER, FINGER[2] / 2),
            link("right_finger", FINGER, FINGER[2] / 2),
            f'<link name="{prefix}camera"/>',
            joint("shoulder", "revolute", parent, "upper", f'<origin xyz="{at}"/><axis xyz="0 0 1"/>{limit}'),
            joint("elbow", "revolute", f"{prefix}upper", "lower", f'<origin xyz="0 0 .2"/><axis xyz="0 1 0"/>{limit}'),
            joint("wrist", "fixed", f"{prefix}lower", "hand", '<origin xyz="0 0 .2"/>'),
            joint("mount", "fixed", f"{prefix}hand", "camera", '<origin xyz=".05 0 0" rpy="0 -1.2 0"/>'),
            joint(
                "finger1", "prismatic", f"{prefix}hand", "left_finger",
                '<origin xyz="0 .005 .05"/><axis xyz="0 1 0"/><limit lower="0" upper=".03" effort="40" velocity="1"/>',
            ),
            joint(
                "finger2", "prismatic", f"{prefix}hand", "right_finger",
                f'<origin xyz="0 -.005 .05"/><axis xyz="{axis}"/>'
                f'<limit lower="{lower}" upper="{upper}" effort="40" velocity="1"/><mimic joint="{prefix}finger1"/>',
            ),
        ]
    )  # fmt: skip


def write(folder: Path, fields: dict[str, Any], *arms: str, extra: str = "") -> Path:
    """The embodiment's folder, with a base that is a mesh."""
    (folder / "meshes").mkdir(parents=True, exist_ok=True)
    trimesh.creation.box([0.1, 0.1, 0.1]).export(folder / "meshes" / "base.stl")
    mesh = '<geometry><mesh filename="package://meshes/base.stl"/></geometry>'
    base = f'<link name="base"><visual>{mesh}</visual><collision>{mesh}</collision></link>'
    (folder / "arm.urdf").write_text(f'<robot name="test">{base}{"".join(arms or [arm()])}{extra}</robot>')
    (folder / "config.yml").write_text(yaml.safe_dump(fields))
    return folder


def dual_config() -> dict[str, Any]:
    """Both arms in one URDF, their joints called ``l_…`` and ``r_…``."""
    return config(
        dual_arm=True,
        ee_joints=["l_wrist", "r_wrist"],
        arm_joints_name=[[f"{p}shoulder", f"{p}elbow"] for p in ("l_", "r_")],
        gripper_name=[{"base": f"{p}finger1", "mimic": [[f"{p}finger2", 1.0, 0.0]]} for p in ("l_", "r_")],
    )
