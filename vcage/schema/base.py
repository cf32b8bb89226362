"""Base classes of all records: strict fields, a schema id, provenance, and exact reading errors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Any, ClassVar, Self, TypeVar

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from vcage.base.errors import SchemaMismatch, UnknownName
from vcage.base.files import read_json, stage_of_file, write_json
from vcage.base.geometry import Camera, Pose, world_aabb
from vcage.base.inside import name_complaint, path_complaint
from vcage.base.version import __version__

Identifier = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9_-]*$", max_length=80)]
Finite = Annotated[float, Field(allow_inf_nan=False)]

MOST_METRES = 1000.0
"""Of a coordinate or a length: up to there the 32-bit floats of a simulator still tell 0.1 mm apart."""

Metres = Annotated[float, Field(ge=-MOST_METRES, le=MOST_METRES, allow_inf_nan=False)]
Point2 = tuple[Metres, Metres]
Point3 = tuple[Metres, Metres, Metres]
Vec3 = tuple[Finite, Finite, Finite]
Quat = tuple[Finite, Finite, Finite, Finite]


def _with_room(box: tuple[Point3, Point3]) -> tuple[Point3, Point3]:
    if not all(lower < upper for lower, upper in zip(*box, strict=True)):
        raise ValueError(f"expected a lower and an upper corner with room between them, got {box}")
    return box


Box = Annotated[tuple[Point3, Point3], AfterValidator(_with_room)]


def _of_unit_length(values: tuple[float, ...]) -> tuple[float, ...]:
    length = sum(x * x for x in values) ** 0.5
    if abs(length - 1) > 1e-3:
        raise ValueError(f"expected a unit {'quaternion' if len(values) == 4 else 'vector'}, got length {length:.4g}")
    return values


UnitVec3 = Annotated[Vec3, AfterValidator(_of_unit_length)]


def _stays(complaint: Callable[[str], str | None]) -> AfterValidator:
    def check(path: str) -> str:
        if found := complaint(path):
            raise ValueError(found)
        return path

    return AfterValidator(check)


RunPath = Annotated[str, _stays(path_complaint)]
"""A file of a run, by its path in the run folder; see :meth:`vcage.base.files.RunFolder.file`."""

NearPath = Annotated[str, _stays(partial(path_complaint, up=1))]
"""A file of a run, by its path from the folder of a stage: in it, or in that of another stage."""

FileName = Annotated[str, _stays(name_complaint)]
"""A file in a folder that is known."""


class Record(BaseModel):
    """A typed, frozen piece of JSON; unknown fields are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, ser_json_inf_nan="constants", defer_build=True)


R = TypeVar("R", bound=Record)


def the(kind: str, records: Sequence[R], key: object, field: str = "id") -> R:
    """The record of a list whose field has a value.

    Args:
        kind: of the records, for the error.

    Raises:
        UnknownName: there is none; names the known ones.
    """
    for record in records:
        if getattr(record, field) == key:
            return record
    raise UnknownName(kind, str(key), [str(getattr(record, field)) for record in records])


def require_unique(kind: str, records: Sequence[Record], field: str = "id") -> None:
    """Refuse a list with two records of one id."""
    ids = [getattr(record, field) for record in records]
    if len(set(ids)) != len(ids):
        raise ValueError(f"{kind} id occurs twice in {ids}")


def _rounded(values: np.ndarray) -> tuple[float, ...]:
    """To 0.1 µm: enough for any use, and readable."""
    return tuple(round(float(x), 7) for x in values)


class PoseRecord(Record):
    """A pose in the world frame: metres, and a unit quaternion wxyz."""

    position: Point3
    quaternion: Annotated[Quat, AfterValidator(_of_unit_length)]

    @classmethod
    def of(cls, pose: Pose) -> PoseRecord:
        return cls(position=_rounded(pose.p), quaternion=_rounded(pose.q))

    def pose(self) -> Pose:
        return Pose(self.position, self.quaternion)


def box_record(bounds: np.ndarray, pose: Pose) -> Box:
    """The axis-aligned world box of a local box (2, 3) at ``pose``."""
    (x0, y0, z0), (x1, y1, z1) = world_aabb(bounds, pose).tolist()
    return (x0, y0, z0), (x1, y1, z1)


MOST_PIXELS = 8192
"""Of a camera's picture along one side: beyond it a renderer ends its process."""


class CameraRecord(Record):
    """A pinhole camera (see :class:`vcage.base.geometry.Camera`)."""

    width: int = Field(gt=0, le=MOST_PIXELS)
    height: int = Field(gt=0, le=MOST_PIXELS)
    fovy: float = Field(gt=0, lt=np.pi, description="vertical field of view, radians")
    pose: PoseRecord = Field(description="camera frame (x forward, y left, z up) in the world")

    @classmethod
    def of(cls, camera: Camera) -> CameraRecord:
        return cls(width=camera.width, height=camera.height, fovy=camera.fovy, pose=PoseRecord.of(camera.pose))

    def camera(self) -> Camera:
        return Camera(self.width, self.height, self.fovy, self.pose.pose())


class Document(Record):
    """A record that is a file of its own; subclasses set :attr:`SCHEMA` (``name/version``)."""

    SCHEMA: ClassVar[str]

    schema_id: str = Field(default="", alias="schema", description="name and version of this file's schema")
    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)

    def model_post_init(self, _context: Any) -> None:
        if not self.schema_id:
            object.__setattr__(self, "schema_id", self.SCHEMA)

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read and validate the file.

        Raises:
            MissingStage, DamagedFile: it is not there, or not JSON.
            SchemaMismatch: it is of another schema or version, or breaks its own; names the field.
        """
        return cls.parse(read_json(path), path)

    @classmethod
    def parse(cls, data: Any, path: Path) -> Self:
        """Validate the data read from ``path`` (of JSON or YAML).

        Raises:
            SchemaMismatch: as for :meth:`read`.
        """
        if not isinstance(data, dict):
            raise SchemaMismatch(
                f"{path}: field (whole file): {type(data).__name__}; expected an object of the schema {cls.SCHEMA!r}",
                hint="restore the file",
                maker=stage_of_file(path),
                details={"path": str(path), "field": "(whole file)", "expected": cls.SCHEMA},
            )
        found = data.get("schema")
        if found != cls.SCHEMA:
            raise SchemaMismatch(
                f"{path} has the schema {found!r}, expected {cls.SCHEMA!r}",
                hint="it was written by another version",
                maker=stage_of_file(path),
                details={"path": str(path), "found": found, "expected": cls.SCHEMA},
            )
        try:
            return cls.model_validate(data)
        except ValidationError as error:
            first = error.errors()[0]
            field = ".".join(str(part) for part in first["loc"]) or "(whole file)"
            raise SchemaMismatch(
                f"{path}: field {field}: {first['msg']}",
                hint="fix the field",
                maker=stage_of_file(path),
                details={"path": str(path), "field": field, "errors": error.error_count()},
            ) from error

    def write(self, path: Path) -> Path:
        """Write the file atomically."""
        return write_json(path, self.model_dump(mode="json", by_alias=True))


class Provenance(Record):
    """Origin of a stage's file; with equal provenance the stage need not run again."""

    producer: str = Field(description="the stage that wrote this")
    version: str = Field(default=__version__, description="version of vcage")
    seed: int = Field(ge=0, description="seed of every random choice of the stage")
    options: dict[str, Any] = Field(default_factory=dict, description="the stage's options that change its result")
    inputs: dict[str, str] = Field(default_factory=dict, description="what it read: path in the run folder → SHA-256")
    providers: dict[str, str] = Field(default_factory=dict, description="model role → provider that answered")


class StageDocument(Document):
    """The JSON that a stage leaves in the run folder."""

    provenance: Provenance
    edited: list[str] = Field(default=[], description="files of the stage that a user edited and the checks accepted")

    @property
    def made_from(self) -> Provenance:
        """The key of a finished stage (see :class:`vcage.base.keeper.Keeper`)."""
        return self.provenance
