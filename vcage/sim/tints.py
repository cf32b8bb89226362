"""Changes of the colours of objects under which their names stay true."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import cv2
import numpy as np

from vcage.objects.colour_words import word_of
from vcage.schema.asset import PhysicalModel
from vcage.schema.randomisation import Tint
from vcage.sim.render import painted_texture

if TYPE_CHECKING:
    import sapien

HUE_MARGIN_DEG, HALVINGS = 6.0, 6
"""Distance of a hue from one of another name, as warm and cold lights turn visible hues by about as much; and how
often a change that is too large is halved before it is dropped."""


@dataclass(frozen=True)
class Colours:
    """The visible colours of an object.

    Args:
        colours: (n, 3) uint8 sRGB of its triangles.
        areas: (n,) of the triangles, square metres.
    """

    colours: np.ndarray
    areas: np.ndarray

    def words(self, tint: Tint | None = None) -> tuple[str, str]:
        """The words for its mean colour and for the colour of most of its surface, after a tint."""
        shown = self.colours if tint is None else tinted(self.colours[None], tint)[0]
        mean = word_of(self.areas @ shown / self.areas.sum())
        kinds, which = np.unique(shown, axis=0, return_inverse=True)
        shares: dict[str, float] = {}
        for kind, area in zip(kinds, np.bincount(which.ravel(), weights=self.areas), strict=True):
            word = word_of(kind)
            shares[word] = shares.get(word, 0.0) + float(area)
        return mean, max(shares, key=lambda word: shares[word])


def truthful(colours: Colours, tint: Tint) -> Tint | None:
    """The tint, or the largest half, quarter, … of it under which the colour words of an object stay; None for none."""
    words = colours.words()
    for _ in range(HALVINGS):
        beside = (
            tint.model_copy(update={"hue_deg": tint.hue_deg + off}) for off in (-HUE_MARGIN_DEG, 0, HUE_MARGIN_DEG)
        )
        if all(colours.words(one) == words for one in beside):
            return tint
        tint = weaker(tint, 0.5)
    return None


def weaker(tint: Tint, share: float) -> Tint:
    """A share of a tint."""
    return Tint(hue_deg=tint.hue_deg * share, saturation=tint.saturation**share, lightness=tint.lightness**share)


def tinted(picture: np.ndarray, tint: Tint) -> np.ndarray:
    """(H, W, 3) uint8 sRGB with hue turned, and saturation and lightness (HSL) multiplied."""
    hls = cv2.cvtColor(picture.astype(np.float32) / 255, cv2.COLOR_RGB2HLS)
    hls[..., 0] = (hls[..., 0] + np.float32(tint.hue_deg)) % np.float32(360)
    hls[..., 1] = np.minimum(hls[..., 1] * np.float32(tint.lightness), 1)
    hls[..., 2] = np.minimum(hls[..., 2] * np.float32(tint.saturation), 1)
    return np.clip(np.round(cv2.cvtColor(hls, cv2.COLOR_HLS2RGB) * 255), 0, 255).astype(np.uint8)


def colours_of(model: PhysicalModel) -> Colours:
    """The visible colours of a model with all its parts."""
    parts = [_mesh_colours(part.visual) for part in (model, *model.links)]
    return Colours(np.concatenate([c for c, _ in parts]), np.concatenate([a for _, a in parts]))


@lru_cache(maxsize=256)
def _mesh_colours(path: str) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) uint8 sRGB and (n,) areas of the triangles of a GLB."""
    import trimesh

    scene = trimesh.load_scene(path)
    colours, areas = [], []
    for mesh in scene.dump():
        assert isinstance(mesh, trimesh.Trimesh) and mesh.visual is not None
        seen = mesh.visual
        seen = seen.to_color() if isinstance(seen, trimesh.visual.TextureVisuals) else seen
        colours.append(np.asarray(seen.vertex_colors)[mesh.faces][..., :3].mean(axis=1))
        areas.append(mesh.area_faces)
    return np.concatenate(colours).round().astype(np.uint8), np.concatenate(areas)


def tint_entities(entities: Iterable[sapien.Entity], tint: Tint) -> None:
    """Change the visible colours of an object; its textures are replaced, as other worlds share them."""
    import sapien

    for entity in entities:
        body = entity.find_component_by_type(sapien.render.RenderBodyComponent)
        for shape in body.render_shapes if body is not None else ():
            for part in shape.parts:
                _tint_material(part.material, tint)


def _tint_material(material: sapien.render.RenderMaterial, tint: Tint) -> None:
    texture = material.base_color_texture
    if texture is None:
        *colour, alpha = material.base_color
        if alpha == 0:  # only throws a shadow
            return
        screen = np.round(255 * np.clip(colour, 0, 1) ** (1 / 2.2)).astype(np.uint8)
        material.set_base_color([*(tinted(screen[None, None], tint)[0, 0] / 255.0) ** 2.2, alpha])
        return
    material.set_base_color_texture(painted_texture(tinted(texture.download()[..., :3], tint)))
