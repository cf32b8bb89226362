"""An asset: one variant of an annotated object, with its geometry measured from the convex pieces."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vcage.assets import openings
from vcage.assets.convex import Convex, load_convex
from vcage.assets.openings import Opening
from vcage.schema.asset import Annotation, CatalogueEntry, ContactPoint, FunctionalPoint, PhysicalModel, Variant


@dataclass(frozen=True)
class Asset:
    """One variant of an object, ready for the simulator.

    Everything is in the object frame (origin at the centre of the bottom; x right, y back, z up), in metres.

    Args:
        annotation: words and points.
        variant: which look.
        model: files and physical constants.
    """

    annotation: Annotation
    variant: Variant
    model: PhysicalModel

    @property
    def name(self) -> str:
        return self.annotation.name

    @cached_property
    def bounds(self) -> np.ndarray:
        """(2, 3) lower and upper corner."""
        return np.array([self.model.lower, self.model.upper])

    @property
    def size(self) -> np.ndarray:
        """(3,) edge lengths of the bounding box."""
        return self.bounds[1] - self.bounds[0]

    @property
    def footprint(self) -> np.ndarray:
        """(2,) edge lengths of the bounding rectangle seen from above."""
        return self.size[:2]

    @cached_property
    def pieces(self) -> list[Convex]:
        """The convex pieces whose union is the collision shape."""
        return [load_convex(path) for path in self.model.hulls]

    @cached_property
    def volume(self) -> float:
        """Volume of the material in m³ (pieces overlap a little where they join)."""
        return sum(piece.volume for piece in self.pieces)

    def entry(self) -> CatalogueEntry:
        """What a model sees of it."""
        return CatalogueEntry(
            name=self.name,
            words=self.annotation.words,
            variants=self.annotation.variants,
            size=tuple(float(x) for x in self.size),
            contact_points=self.annotation.contact_points,
            functional_points=self.annotation.functional_points,
        )

    def grasp_width(self, contact: ContactPoint) -> float:
        """How far apart the fingers are that close at a contact point, metres; 0 where they would meet nothing."""
        return openings.grasped_width(self.pieces, contact.position, contact.closing)

    def opening(self, point: FunctionalPoint) -> Opening:
        """The room at a functional point.

        Raises:
            ValueError: there is none: the point lies inside the material, or over nothing.
        """
        if point.holds == "in":
            return openings.room_inside(self.pieces, point.position)
        return openings.surface_on_top(self.pieces, point.position)
