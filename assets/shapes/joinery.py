"""Furniture from boards: carcasses, drawers that slide out, and handles that a parallel gripper can close on.

Everything is built in the object frame: the front faces -y, and the handles reach to the front of the bounding box.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from vcage.objects.modelling import pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.noise import shaded
from vcage.objects.modelling.parts import Part, paint
from vcage.schema.asset import Joint

GRIP_WIDTH, GRIP_HEIGHT, PROUD = 0.012, 0.034, 0.036
"""A handle: thickness along x, height, and how far it stands out in front of the face, metres."""

GAP = 0.002
"""Between a front and the boards around it, metres."""

SLIDE = 0.16
"""How far a drawer opens, metres."""

REBATE = 0.002
"""How far the boards of a carcass reach into its sides and back, metres."""

HandleShape = Literal["fin", "bar"]

Foot = Literal["plinth", "legs"]


@dataclass(frozen=True)
class Finish:
    """A surface: a seamless texture that repeats every ``period`` metres, and how it shines."""

    texture: np.ndarray
    period: float = 0.18
    roughness: float = 0.6
    metallic: float = 0.0

    def on(self, solid: solids.Solid, along: int = 0) -> Part:
        """The solid in this finish, its grain along an axis."""
        mapping = tiled(self.period, along=along)
        return paint(solid, self.texture, mapping, crease=35, roughness=self.roughness, metallic=self.metallic)


@dataclass
class Assembly:
    """What is seen and what is solid of one rigid part, while it is being put together."""

    parts: list[Part] = field(default_factory=list)
    hulls: list[solids.Solid] = field(default_factory=list)

    def board(self, size: ArrayLike, bottom: ArrayLike, finish: Finish, *, radius: float = 0.0, along: int = 0) -> None:
        """Add a board whose bottom face is centred at ``bottom``; ``radius`` rounds its edges."""
        seen = solids.rounded_box(size, radius, bottom, steps=2) if radius else solids.box(size, bottom)
        self.parts.append(finish.on(seen, along))
        self.hulls.append(solids.box(size, bottom))

    def front(self, size: Sequence[float], bottom: Sequence[float], finish: Finish, framed: bool) -> None:
        """Add a drawer's or a door's front.

        Args:
            size: (3,) metres.
            bottom: (3,) the middle of its front face's lower edge.
            finish: of all of it.
            framed: whether it has a field that lies 4 mm deeper, with slopes that lead up to its frame.
        """
        wide, deep, high = size
        x, y, z = bottom
        block = solids.box(size, (x, y + deep / 2, z))
        along = 2 if high > wide else 0
        if framed:
            rings = [_upright_rectangle(wide - 2 * inset, high - 2 * inset, depth) for inset, depth in FIELD]
            carved = solids.cut(block, solids.moved(pieces.hull(*rings), (x, y, z + high / 2)))
            self.parts += _framed(carved, finish, along)
        else:
            self.parts.append(finish.on(solids.rounded_box(size, 0.0015, (x, y + deep / 2, z), steps=2), along))
        self.hulls.append(block)

    def add(self, other: Assembly) -> None:
        """Add all of another."""
        self.parts += other.parts
        self.hulls += other.hulls

    def grip(self, style: HandleShape, at: Sequence[float], finish: Finish, height: float = GRIP_HEIGHT) -> None:
        """Add a handle on a face.

        Args:
            style: a solid fin, or a bar on two stems.
            at: (3,) point of the face behind its middle.
            finish: of the handle.
            height: along z, metres.
        """
        x, y, z = at
        root, low = 0.006, z - height / 2  # the root reaches into the front, which may be hollowed
        if style == "fin":
            middle = (x, y + (root - PROUD) / 2, low)
            self.board((GRIP_WIDTH, PROUD + root, height), middle, finish, radius=0.004, along=1)
            return
        depth, stem = 0.02, 0.007
        self.board((GRIP_WIDTH, depth, height), (x, y - PROUD + depth / 2, low), finish, radius=0.004, along=2)
        reach = PROUD - depth + root + 0.003
        for bottom in (low + 0.002, low + height - stem - 0.002):
            self.board((0.008, reach, stem), (x, y + root - reach / 2, bottom), finish, radius=0.002, along=1)


@dataclass(frozen=True)
class Carcass:
    """The fixed boards of a cabinet, open at the front.

    Args:
        width, depth: outside, metres; handles stand out beyond the depth.
        bays: clear heights from the lowest upwards.
        foot: height of the plinth or legs.
        board, side, top: thickness of the boards between and below the bays, at the sides, and above.
        lip: how far the top stands out at the sides and the front.
        recess: how far the boards between the bays stay behind the face.
    """

    width: float
    depth: float
    bays: tuple[float, ...]
    foot: float = 0.03
    board: float = 0.008
    side: float = 0.01
    top: float = 0.012
    lip: float = 0.003
    recess: float = 0.0

    @property
    def face(self) -> float:
        """y of the plane in which the fronts lie."""
        return (PROUD - self.depth) / 2

    @property
    def back(self) -> float:
        """y of the back."""
        return (PROUD + self.depth) / 2

    @property
    def middle(self) -> float:
        """y halfway between front and back."""
        return PROUD / 2

    @property
    def clear(self) -> float:
        """Width between the sides."""
        return self.width - 2 * self.lip - 2 * self.side

    @property
    def under_top(self) -> float:
        """z of the lower face of the top board."""
        return self.foot + len(self.bays) * self.board + sum(self.bays)

    def floor(self, bay: int) -> float:
        """z of a bay's floor."""
        return self.foot + (bay + 1) * self.board + sum(self.bays[:bay])

    def build(self, finish: Finish, top: Finish, foot: Finish, style: Foot = "plinth") -> Assembly:
        """Its boards, on a plinth or on four legs."""
        out = Assembly()
        outer, tall, sheet = self.width - 2 * self.lip, self.under_top - self.foot, 0.005
        deep = self.depth - sheet
        for i in range(len(self.bays)):
            bottom = self.floor(i) - self.board
            recess = self.recess if i else 0.0
            middle = (0, self.middle + (recess - sheet) / 2 + REBATE / 2, bottom)
            out.board((self.clear + 2 * REBATE, deep - recess + REBATE, self.board), middle, finish)
        for sign in (-1, 1):
            x = sign * (outer - self.side) / 2
            out.board((self.side, self.depth, tall), (x, self.middle, self.foot), finish, along=2)
        out.board((self.clear + 2 * REBATE, sheet, tall), (0, self.back - sheet / 2, self.foot), finish, along=2)
        size = (self.width, self.depth + self.lip, self.top)
        out.board(size, (0, self.middle - self.lip / 2, self.under_top), top, radius=0.002)
        out.add(self._stand(foot, style))
        return out

    def _stand(self, finish: Finish, style: Foot) -> Assembly:
        out = Assembly()
        wide, deep = self.width - 2 * self.lip, self.depth
        if style == "plinth":
            out.board((wide - 0.012, deep - 0.016, self.foot), (0, self.middle + 0.002, 0), finish)
            return out
        for x in (-1, 1):
            for y in (-1, 1):
                middle = np.array([x * (wide / 2 - 0.017), self.middle + y * (deep / 2 - 0.017), 0.0])
                slim, wider = (solids.rounded_rectangle((w, w), 0.003, 2) for w in (0.02, 0.028))
                ends = [np.pad(slim, ((0, 0), (0, 1))), np.pad(wider, ((0, 0), (0, 1)), constant_values=self.foot)]
                leg = pieces.hull(*(end + middle for end in ends))
                out.parts.append(finish.on(leg, along=2))
                out.hulls.append(leg)
        return out


@dataclass(frozen=True)
class DrawerLook:
    """Finishes of a drawer, its handle, and whether its front is framed like a panelled door."""

    front: Finish
    inside: Finish
    metal: Finish
    grip: Finish
    style: HandleShape = "bar"
    framed: bool = False


FIELD = ((0.0115, -0.001), (0.0165, 0.004))
"""The slopes of a framed front: distance from its edges, and depth behind its face, metres."""

DRAWER_FLOOR = 0.007
"""Height of a drawer's floor above the bay's, metres."""

PANEL, WALL, WALL_HEIGHT, DRAWER_DEPTH = 0.008, 0.006, 0.042, 0.122
"""Thickness of a drawer's front and walls, height of its walls above its floor, and its depth inside, metres."""

TALL_WALL_SHARE = 0.55
"""Share of a tall bay that a drawer's walls are high at least, so that bottles do not tip over them."""


def drawer(carcass: Carcass, bay: int, look: DrawerLook) -> Assembly:
    """A drawer that fills a bay; it hangs in slides that stay in the carcass when it is pulled out.

    Args:
        carcass: that it hangs in.
        bay: number of the bay, from the lowest upwards.
        look: finishes and handle.
    """
    out = Assembly()
    face, bottom, high = carcass.face, carcass.floor(bay), carcass.bays[bay]
    out.front((carcass.clear - 2 * GAP, PANEL, high - 2 * GAP), (0, face, bottom + GAP), look.front, look.framed)
    outer = carcass.clear - 0.01
    start, low = face + PANEL, bottom + 0.003
    sheet = DRAWER_FLOOR - 0.003
    out.board((outer, DRAWER_DEPTH + WALL, sheet), (0, start + (DRAWER_DEPTH + WALL) / 2, low), look.inside)
    rise = max(WALL_HEIGHT, TALL_WALL_SHARE * high)
    for sign in (-1, 1):
        x = sign * (outer - WALL) / 2
        out.board((WALL, DRAWER_DEPTH, rise), (x, start + DRAWER_DEPTH / 2, low + sheet), look.inside, along=1)
        rail = 0.164
        out.board((0.003, rail, 0.01), (sign * (outer + 0.003) / 2, start + rail / 2, low + 0.01), look.metal, along=1)
    out.board((outer, WALL, rise), (0, start + DRAWER_DEPTH + WALL / 2, low + sheet), look.inside)
    out.grip(look.style, (0, face, bottom + high / 2), look.grip)
    return out


def slide(carcass: Carcass, bay: int) -> Joint:
    """The joint of the drawer in a bay."""
    return Joint(
        kind="slide",
        origin=(0, carcass.face, carcass.floor(bay) + carcass.bays[bay] / 2),
        axis=(0, -1, 0),
        lower=0.0,
        upper=SLIDE,
        damping=8.0,
        friction=3.0,
    )


def _framed(solid: solids.Solid, finish: Finish, along: int) -> list[Part]:
    """A framed front; its slopes are darker, as where paint and dust gather."""
    slope = np.abs(solid.face_normals).max(axis=1) < 0.95
    flats, slopes = solid.copy(), solid.copy()
    flats.update_faces(~slope)
    slopes.update_faces(slope)
    dim = shaded(finish.texture, np.full(finish.texture.shape[:2], 0.72))
    return [finish.on(flats, along), replace(finish, texture=dim).on(slopes, along)]


def _upright_rectangle(wide: float, high: float, y: float) -> np.ndarray:
    """Corners (4, 3) of a rectangle across y, around the origin."""
    return np.array([(i * wide / 2, y, j * high / 2) for i in (-1, 1) for j in (-1, 1)])
