"""Draws among kinds of the catalogue: kinds that suit a place, clutter, scenes without an instruction."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.errors import NoAssetFits, UnknownName
from vcage.schema.asset import CatalogueEntry, Variant
from vcage.schema.plan import SelectedAsset, Selection
from vcage.schema.scene import Contents, SceneTemplate

Look = tuple[CatalogueEntry, Variant]


@dataclass(frozen=True)
class Occasion:
    """The scene of a task, and its preferences among kinds.

    Args:
        scene: name of the scene template.
        tags: scene tags of the objects chosen already.
        wall_m: thickness of the walls of receptacles.
        share_of_place: largest share of a place's outer rectangle for one of several contents.
        most: number of objects that are chosen for "several".
        gap_m: between several contents, for the fingers.
        filled: largest share of a room that several contents fill, with their gaps.
        context: number of clutter objects.
        context_footprint_m2: the largest footprint of a clutter object.
    """

    scene: str
    tags: frozenset[str] = frozenset()
    wall_m: float = 0.01
    share_of_place: float = 0.25
    most: int = 3
    gap_m: float = 0.02
    filled: float = 0.7
    context: int = 2
    context_footprint_m2: float = 0.03

    def suiting(
        self, kinds: Sequence[CatalogueEntry], place: CatalogueEntry | None, several: bool, least: int
    ) -> list[CatalogueEntry]:
        """Kinds that fit a place and belong to the scene, as far as there are any.

        Args:
            place: the target.
            several: True if several objects go there.
            least: number of kinds that must remain for a preference to count.
        """
        if place is not None:
            kinds = self._fitting(kinds, place, several)
        here = [kind for kind in kinds if self.scene in kind.words.scene_tags]
        kinds = here if len(here) >= least else kinds
        alike = [kind for kind in kinds if self.tags & set(kind.words.scene_tags)]
        return list(alike if len(alike) >= least else kinds)

    def _fitting(
        self, kinds: Sequence[CatalogueEntry], place: CatalogueEntry, several: bool
    ) -> Sequence[CatalogueEntry]:
        """Kinds that fit a place as well as any do; all where none does."""
        smaller = [kind for kind in kinds if kind.name != place.name and self.goes_in(kind, place)]
        kinds = [kind for kind in smaller if self.has_room(place, kind)] or smaller or kinds
        room = self.share_of_place * place.size[0] * place.size[1]
        return [kind for kind in kinds if not several or kind.size[0] * kind.size[1] <= room] or kinds

    def goes_in(self, entry: CatalogueEntry, place: CatalogueEntry) -> bool:
        """Check if an object, turned by a quarter if need be, is smaller than the inside of a place can be."""
        drawers = sum(point.link is not None for point in place.functional_points)
        if drawers and entry.size[2] > place.size[2] / drawers - 2 * self.wall_m:
            return False
        sides = zip(sorted(entry.size[:2]), sorted(place.size[:2]), strict=True)
        return all(mine < its - 2 * self.wall_m for mine, its in sides)

    def has_room(self, place: CatalogueEntry, entry: CatalogueEntry) -> bool:
        """Check if a measured room of a place takes an object, turned by a quarter if need be."""
        wide, high = sorted(entry.size[:2]), entry.size[2]
        links = {point.id: point.link for point in place.functional_points}
        rooms = [(sorted(room.size[:2]), room.size[2] if links[room.point] else 0.0) for room in place.rooms]
        return any(
            all(mine <= its for mine, its in zip(wide, sides, strict=True)) and (not roof or high <= roof)
            for sides, roof in rooms
        )

    def several(self, place: CatalogueEntry | None, kinds: Sequence[CatalogueEntry]) -> int:
        """The number of objects that are chosen where no number is said: two at least, and as many as have room.

        Args:
            place: where they go; None where that has no edge.
            kinds: to choose, one of each, in this order.
        """
        most = min(self.most, max(2, len(kinds)))
        if place is None:
            return most
        room = max((room.size[0] * room.size[1] for room in place.rooms), default=place.size[0] * place.size[1])
        filled = np.cumsum([(kind.size[0] + self.gap_m) * (kind.size[1] + self.gap_m) for kind in kinds[:most]])
        return min(most, max(2, int(np.count_nonzero(filled <= self.filled * room))))

    def standing_by(
        self, kinds: Sequence[CatalogueEntry], mistaken: Callable[[CatalogueEntry], bool], rng: np.random.Generator
    ) -> list[SelectedAsset]:
        """Small objects that belong to the scene, or to what was chosen where nothing is tagged with the scene.

        Args:
            kinds: to draw from.
            mistaken: True for a kind that could be taken for an object of the task.
            rng: of the draw.
        """
        known = any(self.scene in kind.words.scene_tags for kind in kinds)
        tags: Collection[str] = {self.scene} if known else self.tags
        small = [kind for kind in kinds if kind.size[0] * kind.size[1] <= self.context_footprint_m2]
        fitting = [kind for kind in small if set(tags) & set(kind.words.scene_tags) and not mistaken(kind)]
        found = []
        for kind in (fitting[i] for i in rng.permutation(len(fitting))[: self.context]):
            reason = f"belongs to {', '.join(sorted(set(tags) & set(kind.words.scene_tags)))}"
            look = kind.variants[int(rng.integers(len(kind.variants)))]
            found.append(SelectedAsset(asset=kind.name, variant=look.id, role="context", reason=reason))
        return found


def one_of_each(kinds: Sequence[tuple[CatalogueEntry, Sequence[Variant]]], rng: np.random.Generator) -> list[Look]:
    """One look of each kind before a second of any, the looks of a kind in random order."""
    shuffled = [(kind, [looks[i] for i in rng.permutation(len(looks))]) for kind, looks in kinds]
    most = max((len(looks) for _, looks in shuffled), default=0)
    return [(kind, looks[k]) for k in range(most) for kind, looks in shuffled if k < len(looks)]


def draw_contents(template: SceneTemplate, catalogue: Sequence[CatalogueEntry], rng: np.random.Generator) -> Selection:
    """Objects for every record of a template's contents, in its order; no kind comes twice.

    Args:
        template: with contents.
        catalogue: what there is.
        rng: of all choices: how many, which kinds, which looks.

    Raises:
        UnknownName: no kind has a tag, or a name is unknown; lists the known ones.
        NoAssetFits: fewer kinds than requested suit their role.
    """
    catalogue = sorted(catalogue, key=lambda entry: entry.name)
    chosen: list[SelectedAsset] = []
    for asked in template.contents:
        kinds = _kinds(asked, catalogue, {one.asset for one in chosen})
        least, most = asked.count
        if len(kinds) < least:
            what = f"tagged {' and '.join(asked.tags)}" if asked.tags else f"of {', '.join(asked.assets)}"
            raise NoAssetFits(
                f"the scene {template.name} asks for {least} objects {what} as {asked.role}, there are {len(kinds)}",
                hint="ask for fewer, or for other tags, in its contents",
                details={"scene": template.name, "asked": least, "kinds": [kind.name for kind in kinds]},
            )
        count = int(rng.integers(least, min(most, len(kinds)) + 1))
        for kind in (kinds[i] for i in rng.permutation(len(kinds))[:count]):
            look = kind.variants[int(rng.integers(len(kind.variants)))]
            reason = f"belongs to the scene {template.name}"
            chosen.append(SelectedAsset(asset=kind.name, variant=look.id, role=asked.role, reason=reason))
    return Selection(objects=chosen)


def _kinds(asked: Contents, catalogue: Sequence[CatalogueEntry], taken: Collection[str]) -> list[CatalogueEntry]:
    """The kinds that a record asks for, except those already used or unsuitable for its role."""
    tags = {tag for entry in catalogue for tag in _tags(entry)}
    for tag in asked.tags:
        if tag not in tags:
            raise UnknownName("tag", tag, tags)
    names = {entry.name for entry in catalogue}
    for name in asked.assets:
        if name not in names:
            raise UnknownName("asset", name, names)
    meant = [e for e in catalogue if (e.name in asked.assets if asked.assets else _tags(e).issuperset(asked.tags))]
    return [entry for entry in meant if entry.name not in taken and _good_for(entry, asked.role)]


def _tags(entry: CatalogueEntry) -> set[str]:
    return {entry.words.category, *entry.words.scene_tags}


def _good_for(entry: CatalogueEntry, role: str) -> bool:
    """Check if a kind suits a role: contents can be carried, receptacles take things."""
    if role == "content":
        return entry.can_be_carried
    return role in ("context", "tool") or bool(entry.functional_points)
