"""Correspondences between the source and the target picture."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from pydantic import Field

from vcage.schema.base import Finite, Identifier, Point2, Record, RunPath, StageDocument

MatchMethod = Literal["feature", "name", "kept"]
"""By cosine similarity above τ; below it, by the name that the detector gave; not found or in doubt, so kept."""


class Match(Record):
    """Place of one object of the scene in the target picture."""

    object: Identifier
    method: MatchMethod
    similarity: Finite | None = Field(description="cosine similarity of the features; none when kept")
    confidence: Finite = Field(ge=0, le=1, description="estimated probability that the match is right")
    box: tuple[Finite, Finite, Finite, Finite] | None = Field(description="u0, v0, u1, v1 in the source's frame, px")
    position: Point2 = Field(description="x, y of the object's origin in the world, metres")
    yaw: Finite = Field(description="heading of the object's x axis in the world, radians")
    turned: Finite = Field(description="rotation from source to target, the smallest of those that look alike, radians")
    ncc: Finite | None = Field(description="normalised cross-correlation at that rotation")
    note: str = ""


class Matches(StageDocument):
    """``match/matches.json``."""

    SCHEMA: ClassVar[str] = "vcage.matches/1"

    threshold: Finite = Field(description="the paper's τ")
    matches: list[Match] = Field(min_length=1)
    unclaimed: list[tuple[Finite, Finite, Finite, Finite]] = Field(description="boxes of detections of no object")
    overlay: RunPath = Field(description="path of the overlay picture in the run folder")
    notes: list[str] = Field(default=[], description="what was strange about the picture, in sentences")
    checks: dict[str, Any] = Field(default={}, description="relations_shown: share of the plan that the picture shows…")
