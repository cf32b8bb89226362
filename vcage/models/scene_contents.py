"""Objects of a scene without an instruction: kinds that its template names, or that have its tags."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from vcage.base.errors import NoAssetFits, UnknownName
from vcage.schema.asset import CatalogueEntry
from vcage.schema.plan import SelectedAsset, Selection
from vcage.schema.scene import Contents, SceneTemplate


def draw_contents(template: SceneTemplate, catalogue: Sequence[CatalogueEntry], rng: np.random.Generator) -> Selection:
    """Objects for every record of a template's contents, in its order; no kind comes twice.

    Args:
        template: with contents.
        catalogue: what there is.
        rng: of all choices: how many, which kinds, which looks.

    Raises:
        UnknownName: no kind has a tag, or there is no kind of a name; says which there are.
        NoAssetFits: fewer kinds than asked for are good for their role.
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
    """The kinds that a record asks for, but for those that are taken and those that are no good for its role."""
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
