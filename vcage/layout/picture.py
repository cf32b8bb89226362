"""A plan drawing of the layout before and after the optimisation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.drawing import INK, PAPER, WARNING, Canvas, Colour, distinct_colours
from vcage.base.geometry import rotation_2d
from vcage.layout.items import TableItem
from vcage.schema.scene import Table, Workspace


@dataclass(frozen=True)
class PictureSettings:
    """Sizes and colours of the drawing.

    Args:
        panel_px: width of one of the two plans.
        edge_px, header_px, footer_px: margins around them.
        wood, grey: colours of the table and of the workspace's dots.
        shortest_move_mm: moves that are shorter are not marked.
    """

    panel_px: int = 900
    edge_px: int = 24
    header_px: int = 64
    footer_px: int = 44
    wood: Colour = (236, 222, 200)
    grey: Colour = (150, 145, 138)
    shortest_move_mm: float = 3


SETTINGS = PictureSettings()


def draw_layout(
    before: Sequence[TableItem],
    after: Sequence[TableItem],
    labels: Mapping[str, str],
    workspace: Workspace,
    table: Table,
) -> np.ndarray:
    """The table from above, twice: left the target layout with its collisions in red, right the optimised one.

    Args:
        before, after: the same objects, with their targets at where they should be and where they ended.
        labels: texts beside the objects, by id.
        workspace: drawn dotted.
        table: drawn as wood; the robot stands below the picture.

    Returns:
        (H, W, 3) uint8.
    """
    height = round(table.size[1] * SETTINGS.panel_px / table.size[0])
    across = 2 * SETTINGS.panel_px + 3 * SETTINGS.edge_px
    sheet = np.full((height + SETTINGS.header_px + SETTINGS.footer_px, across, 3), PAPER, dtype=np.uint8)
    canvas = Canvas(sheet, text_size=17)
    colours = dict(zip([f.id for f in before], distinct_colours(len(before)), strict=True))
    clashes = collisions(before)
    moved = {f.id: 1000 * float(np.hypot(*np.subtract(f.target, b.target))) for b, f in zip(before, after, strict=True)}

    plan = _Plan(canvas, table, SETTINGS.edge_px)
    plan.draw("Target layout (matched)", workspace, before, colours)
    for rectangle in clashes:
        plan.rectangle(rectangle, fill=(*WARNING, 120), outline=(*WARNING, 255))
    plan.label(before, labels, colours, {})
    plan.foot(_count(clashes), WARNING if clashes else INK)

    plan = _Plan(canvas, table, 2 * SETTINGS.edge_px + SETTINGS.panel_px)
    plan.draw("Optimised layout", workspace, after, colours)
    for old, new in zip(before, after, strict=True):
        canvas.arrow(plan.pixel(old.target).tolist(), plan.pixel(new.target).tolist(), INK, width=2)
    plan.label(after, labels, colours, moved)
    plan.foot(f"{_count(collisions(after))}; {_summary(labels, moved)}", INK)
    return canvas.picture()


def collisions(items: Sequence[TableItem]) -> list[np.ndarray]:
    """(2, 2) rectangles in which boxes of unrelated objects overlap; in a container, along its axes."""
    found = []
    yaws = {f.id: f.yaw for f in items}
    for k, a in enumerate(items):
        for b in items[k + 1 :]:
            if b.id == a.inside or a.id == b.inside:
                continue
            # Contents of one container are laid out along its walls, not along the world's axes.
            if a.inside is not None and a.inside == b.inside and _apart(a, b, yaws[a.inside]):
                continue
            box_a, box_b = a.rectangle() + a.target, b.rectangle() + b.target
            lower, upper = np.maximum(box_a[0], box_b[0]), np.minimum(box_a[1], box_b[1])
            if np.all(upper - lower > 1e-6):
                found.append(np.stack([lower, upper]))
    return found


def _apart(a: TableItem, b: TableItem, yaw: float) -> bool:
    """True if the boxes along the axes of a frame turned by ``yaw`` do not overlap."""
    halves = sum(f.half_size(yaw) for f in (a, b))
    between = np.abs(rotation_2d(-yaw) @ np.subtract(a.target, b.target))
    return bool(np.any(between >= halves - 1e-6))


def _count(clashes: Sequence[np.ndarray]) -> str:
    if not clashes:
        return "no collisions"
    return "1 collision" if len(clashes) == 1 else f"{len(clashes)} collisions"


def _summary(labels: Mapping[str, str], moved: Mapping[str, float]) -> str:
    furthest = max(moved, key=lambda name: moved[name])
    if moved[furthest] < SETTINGS.shortest_move_mm:
        return "nothing moved"
    mean = sum(moved.values()) / len(moved)
    return f"moved {mean:.0f} mm on average, at most {moved[furthest]:.0f} mm ({labels[furthest]})"


class _Plan:
    """The table on one panel, from the pixel column ``left`` on."""

    def __init__(self, canvas: Canvas, table: Table, left: int):
        self._canvas, self._left = canvas, left
        self._lower, self._upper = table.rectangle
        self._scale = SETTINGS.panel_px / table.size[0]

    def pixel(self, points: np.ndarray | Sequence[float]) -> np.ndarray:
        """(..., 2) pixels of world points (..., 2); y upwards."""
        points = np.asarray(points, dtype=np.float64)
        u = (points[..., 0] - self._lower[0]) * self._scale + self._left
        return np.stack([u, (self._upper[1] - points[..., 1]) * self._scale + SETTINGS.header_px], axis=-1)

    def _box(self, rectangle: np.ndarray) -> list[float]:
        """Left, top, right and bottom pixel of a (2, 2) rectangle of the table."""
        (u0, v1), (u1, v0) = self.pixel(rectangle).tolist()
        return [u0, v0, u1, v1]

    def rectangle(self, rectangle: np.ndarray, fill: tuple[int, ...], outline: tuple[int, ...]) -> None:
        """Mark a (2, 2) rectangle of the table."""
        self._canvas.draw.rectangle(self._box(rectangle), fill=fill, outline=outline, width=2)

    def foot(self, words: str, colour: Colour) -> None:
        """Write a line below the table."""
        below = self.pixel(self._lower)[1] + 10
        self._canvas.text((self._left, round(below)), words, fill=colour, size=20)

    def draw(self, title: str, workspace: Workspace, items: Sequence[TableItem], colours: Mapping[str, Colour]) -> None:
        """Draw the table with its workspace dotted, and the items on it, the largest first."""
        self._canvas.text((self._left, 20), title, size=26)
        draw, grey = self._canvas.draw, SETTINGS.grey
        table = self._box(np.stack([self._lower, self._upper]))
        draw.rounded_rectangle(table, radius=10, fill=SETTINGS.wood, outline=grey, width=2)
        u0, v0, u1, v1 = self._box(np.array([workspace.lower, workspace.upper]))
        for u in np.arange(u0, u1, 12):
            for v in (v0, v1):
                draw.line([u, v, min(u + 5, u1), v], fill=grey, width=2)
        for v in np.arange(v0, v1, 12):
            for u in (u0, u1):
                draw.line([u, v, u, min(v + 5, v1)], fill=grey, width=2)
        self._canvas.text((u0 + 8, v1 - 26), "robot side, workspace dotted", fill=grey, size=16)
        for item in sorted(items, key=lambda f: -f.size[0] * f.size[1]):
            self._draw_item(item, colours[item.id])

    def _draw_item(self, item: TableItem, colour: Colour) -> None:
        half = np.array(item.size[:2]) / 2 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        corners = self.pixel(np.array(item.target) + (half + item.centre) @ rotation_2d(item.yaw).T)
        draw = self._canvas.draw
        draw.polygon([tuple(p) for p in corners], fill=(*colour, 110), outline=(*colour, 255), width=3)
        front, centre = (corners[0] + corners[1]) / 2, self.pixel(item.target)
        draw.line([*(centre + 0.6 * (front - centre)), *front], fill=colour, width=3)

    def label(
        self,
        items: Sequence[TableItem],
        labels: Mapping[str, str],
        colours: Mapping[str, Colour],
        moved: Mapping[str, float],
    ) -> None:
        """Write the items' labels beside them, with the millimetres that each was moved by."""
        boxes = {f.id: self._box(f.rectangle() + f.target) for f in items}
        for box in boxes.values():
            self._canvas.keep_clear(box)
        for f in items:
            distance = moved.get(f.id, 0.0)
            words = f"{labels[f.id]}  {distance:.0f} mm" if distance >= SETTINGS.shortest_move_mm else labels[f.id]
            self._canvas.label(boxes[f.id], words, colours[f.id])
