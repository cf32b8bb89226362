"""An asset: one variant of an annotated object, with its geometry measured from the convex pieces."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from vcage.base.geometry import Pose
from vcage.objects import nesting, openings
from vcage.objects.convex import Convex, load_convex
from vcage.objects.openings import Opening
from vcage.schema.asset import (
    Annotation,
    CatalogueEntry,
    ContactPoint,
    FunctionalPoint,
    PhysicalModel,
    Variant,
)


@dataclass(frozen=True)
class Asset:
    """One variant of an object, ready for the simulator.

    Everything is in the object frame (origin at the centre of the bottom; x right, y back, z up), in metres, with
    all joints at 0: drawers and lids closed.

    Args:
        annotation: words and points.
        variant: which look.
        model: files and physical constants.
        standing: of an object on its side, the same as it stands; None for all others.
        stands: frame of the standing object in the frame of this one.
    """

    annotation: Annotation
    variant: Variant
    model: PhysicalModel
    standing: Asset | None = None
    stands: Pose = field(default_factory=Pose)

    @property
    def name(self) -> str:
        return self.annotation.name

    @property
    def articulated(self) -> bool:
        """True if it has moving parts."""
        return bool(self.model.links)

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
    def round(self) -> bool:
        """Check that it is about as wide in every direction seen from above, so that its heading does not matter."""
        return _is_round(np.concatenate([piece.vertices for piece in self.pieces])[:, :2])

    @cached_property
    def ball_radius(self) -> float | None:
        """Radius of a ball that lies loose in what holds it, metres; None for all else."""
        return float(self.size.max()) / 2 if self.annotation.loose else None

    @cached_property
    def pieces(self) -> list[Convex]:
        """The convex pieces whose union is the collision shape, including moving parts."""
        return [piece for pieces in self._pieces_by_link.values() for piece in pieces]

    def pieces_of(self, link: str | None) -> list[Convex]:
        """The convex pieces of one moving part, or of the body (None).

        Raises:
            UnknownName: there is no such part.
        """
        if link is not None:
            self.model.link(link)
        return self._pieces_by_link[link]

    def bounds_of(self, link: str | None) -> np.ndarray:
        """(2, 3) lower and upper corner of one moving part, or of the body (None); of all where nothing moves.

        Raises:
            UnknownName: there is no such part.
        """
        if link is None and not self.articulated:
            return self.bounds
        corners = np.concatenate([piece.vertices for piece in self.pieces_of(link)])
        return np.array([corners.min(axis=0), corners.max(axis=0)])

    @cached_property
    def _pieces_by_link(self) -> dict[str | None, list[Convex]]:
        hulls = {None: self.model.hulls, **{link.name: link.hulls for link in self.model.links}}
        return {link: [load_convex(path) for path in paths] for link, paths in hulls.items()}

    @cached_property
    def volume(self) -> float:
        """Volume of the material in m³ (pieces overlap a little where they join)."""
        return sum(piece.volume for piece in self.pieces)

    def entry(self) -> CatalogueEntry:
        """Return its catalogue entry, which models and people read."""
        size, parts = tuple(float(x) for x in self.size), [link.name for link in self.model.links]
        return unbuilt_entry(self.annotation).model_copy(update={"size": size, "moving_parts": parts})

    def grasp_width(self, contact: ContactPoint) -> float:
        """Return the distance between fingers closed at a contact point, metres; 0 where they meet nothing."""
        key = (contact.link, tuple(contact.position), tuple(contact.closing))
        if key not in self._widths:
            self._widths[key] = openings.grasped_width(self.pieces_of(contact.link), contact.position, contact.closing)
        return self._widths[key]

    def closed_width(self, points: np.ndarray, axis: np.ndarray, opening: float) -> float:
        """Return the distance between fingers that close until both meet the body, metres; 0 where they meet nothing.

        Args:
            points: (k, 3) between the fingers.
            axis: (3,) along which they close.
            opening: from which they close, metres.
        """
        key = (*((np.round(values, 5) + 0.0).tobytes() for values in (points, axis)), opening)
        if key not in self._closed_widths:
            self._closed_widths[key] = openings.closed_width(self.pieces_of(None), points, axis, opening)
        return self._closed_widths[key]

    def opening(self, point: FunctionalPoint, *, standing: bool = False) -> Opening:
        """The room at a functional point, in the frame of the point's part; other parts are out of the way.

        Args:
            standing: the room of a standing box, which is smaller between sloping walls.

        Raises:
            ValueError: there is none: the point lies inside the material, or over nothing.
        """
        key = (point.model_dump_json(), standing)
        if key not in self._openings:
            self._openings[key] = self._measured_opening(point, standing)
        return self._openings[key]

    def nested_height(self, content: Asset, point: FunctionalPoint) -> float | None:
        """Height at which the bottom of another container comes to rest in this one, in the frame of the point's part,
        metres; None where it does not nest there.

        Args:
            content: the inner one.
            point: of this one.
        """
        hollow = any(own.holds == "in" and not own.sideways for own in content.annotation.functional_points)
        if point.holds != "in" or point.sideways or not hollow or not content.round:
            return None
        key = (content.name, content.variant.id, point.id)
        if key not in self._nested:
            self._nested[key] = nesting.nested_height(content.pieces, self.pieces_of(point.link), self.opening(point))
        return self._nested[key]

    @cached_property
    def _nested(self) -> dict[tuple[str, str, int], float | None]:
        """The computed heights of what nests in it."""
        return {}

    @cached_property
    def _widths(self) -> dict[tuple[str | None, tuple[float, ...], tuple[float, ...]], float]:
        """The computed grasp widths: a search needs the same one with every place of the scene."""
        return {}

    @cached_property
    def _closed_widths(self) -> dict[tuple[bytes | float, ...], float]:
        """The computed ones: a hand on a standing object is the same wherever that stands."""
        return {}

    @cached_property
    def _openings(self) -> dict[tuple[str, bool], Opening]:
        """The computed ones: an episode needs the same one many times."""
        return {}

    def _measured_opening(self, point: FunctionalPoint, standing: bool) -> Opening:
        pieces = self.pieces_of(point.link)
        if point.holds == "in" and point.sideways:
            return openings.room_under_roof(pieces, point.position)
        if point.holds == "in":
            return openings.room_inside(pieces, point.position, standing=standing)
        return openings.surface_on_top(pieces, point.position)


def _is_round(points: np.ndarray, directions: int = 12, max_difference_share: float = 0.05) -> bool:
    """True if points (n, 2) are about as wide in every direction.

    Args:
        directions: in which their width is measured.
        max_difference_share: by which the widest may be wider than the narrowest.
    """
    angles = np.linspace(0, np.pi, directions, endpoint=False)
    widths = np.ptp(points @ np.stack([np.cos(angles), np.sin(angles)]), axis=0)
    return bool(widths.max() <= (1 + max_difference_share) * widths.min())


def unbuilt_entry(annotation: Annotation) -> CatalogueEntry:
    """Facts about a kind that need no model."""
    return CatalogueEntry(
        name=annotation.name,
        words=annotation.words,
        variants=annotation.variants,
        any_colour=annotation.any_colour,
        loose=annotation.loose,
        contact_points=annotation.contact_points,
        functional_points=annotation.functional_points,
        faces=annotation.faces,
    )
