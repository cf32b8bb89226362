"""The robot is data: ``assets/robots/<name>.yml``."""

from __future__ import annotations

from typing import Annotated, ClassVar, Self

from pydantic import Field, model_validator

from vcage.schema.base import Document, Finite, Identifier, Point3, PoseRecord, Record, UnitVec3

Positive = Annotated[Finite, Field(gt=0)]

JointLimit = Positive | list[Positive]
"""Of every joint, or of each."""

DEFAULT_ROBOT = "aloha_agilex"
"""The robot where neither the request nor the scene template names one."""


class Gripper(Record):
    """A parallel gripper; its frame has z along the approach, y along the closing, the origin between the tips."""

    joints: tuple[str, ...] = Field(min_length=1, description="finger joints, driven together")
    open: Finite = Field(description="joint position when open, metres")
    closed: Finite
    max_width: Finite = Field(gt=0, description="opening between the fingers, metres")
    force: Finite = Field(gt=0, description="force limit of each finger joint, newtons")
    stiffness: Finite | None = Field(
        default=None, gt=0, description="of each finger joint's drive, N/m: else the arm's"
    )
    damping: Finite | None = Field(
        default=None, gt=0, description="of each finger joint's drive, N s/m: else the arm's"
    )
    tip_depth: Finite = Field(gt=0, description="how far the finger tips reach beyond the frame's origin, metres")
    finger_length: Finite = Field(gt=0, description="free finger length from the palm to the frame's origin, metres")
    palm_size: tuple[Finite, Finite] = Field(description="palm size along x and y of the gripper frame, metres")
    palm_height: Finite = Field(default=0.12, gt=0, description="extent of hand and flange above the fingers, metres")
    finger_width: Finite = Field(default=0.022, gt=0, description="of one finger across the closing axis, metres")
    finger_thickness: Finite = Field(default=0.022, gt=0, description="along the closing axis, metres, generous")
    friction: Finite = Field(default=2.0, gt=0, description="Coulomb coefficient of the finger tips; rubber by default")
    friction_patch: Finite = Field(default=0.1, ge=0, description="radius of the torsional friction patch, metres")
    empty_width: Finite = Field(default=0.0015, gt=0, description="fingers closer than this hold nothing, metres")
    approach: Finite = Field(default=0.09, gt=0, description="straight way of the hand before a grasp, metres")


class Arm(Record):
    """One arm: its URDF, where its base stands, and what moves it."""

    urdf: str = Field(description="package:path, e.g. 'mani_skill:assets/robots/panda/panda_v2.urdf', or file:/path")
    srdf: str | None = None
    base: PoseRecord = Field(description="base link in the world")
    joints: list[str] = Field(min_length=1, description="arm joints from the base on")
    home: list[Finite]
    tool_link: str = Field(description="link whose frame is the gripper frame")
    tool_offset: PoseRecord | None = Field(default=None, description="gripper frame in the tool link, when they differ")
    gripper: Gripper
    stiffness: Finite = Field(default=1000.0, gt=0, description="of each joint's drive, N m/rad")
    damping: Finite = Field(default=100.0, gt=0, description="of each joint's drive, N m s/rad")
    force: Finite = Field(default=100.0, gt=0, description="limit of each joint's drive, N m")
    max_speed: JointLimit = Field(default=2.1, description="rad/s: of every joint, or a list with one number for each")
    max_acceleration: JointLimit = Field(default=7.5, description="rad/s², in the same way")
    max_jerk: JointLimit = Field(default=3750.0, description="rad/s³, in the same way")
    self_collision_gap: int = Field(default=4, ge=1, description="links this many apart are checked for collision")

    @property
    def speeds(self) -> list[float]:
        """JointLimit of each joint, rad/s."""
        return self._of_each(self.max_speed)

    @property
    def accelerations(self) -> list[float]:
        """JointLimit of each joint, rad/s²."""
        return self._of_each(self.max_acceleration)

    @property
    def jerks(self) -> list[float]:
        """JointLimit of each joint, rad/s³."""
        return self._of_each(self.max_jerk)

    def _of_each(self, limit: JointLimit) -> list[float]:
        return list(limit) if isinstance(limit, list) else [limit] * len(self.joints)

    @model_validator(mode="after")
    def _limits_name_every_joint(self) -> Self:
        for name in ("max_speed", "max_acceleration", "max_jerk"):
            given = len(self._of_each(getattr(self, name)))
            if given != len(self.joints):
                raise ValueError(f"{name} has {given} numbers for {len(self.joints)} joints")
        return self


class RobotCamera(Record):
    """A camera of the recording; ``arm`` and ``link`` say what carries it, none for a fixed one."""

    width: int = 320
    height: int = 240
    fovy: Finite
    position: Point3 = Field(description="in the link's frame, or in the world for a fixed camera")
    forward: UnitVec3
    up: UnitVec3
    arm: str | None = None
    link: str | None = None


class Robot(Document):
    """A robot: arms by side, and the cameras of its recordings by name."""

    SCHEMA: ClassVar[str] = "vcage.robot/1"

    name: Identifier
    description: str
    arms: dict[str, Arm] = Field(min_length=1, description="'left', 'right'")
    cameras: dict[str, RobotCamera] = Field(min_length=1)
    visual_faces: float = Field(default=0.1, gt=0, le=1, description="share of the visual triangles that is kept")
