"""The library in numbers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import Any

from vcage.schema.asset import Annotation

SCENES = ("kitchen", "bathroom", "office_desk", "cashier_desk", "cabinet")
"""The scenes of the paper's experiments, as the annotations' scene tags call them."""


def count_kinds(annotations: Iterable[Annotation]) -> dict[str, Any]:
    """How many kinds and variants there are, and how many kinds per scene and per source."""
    annotations = list(annotations)
    tags = Counter(tag for annotation in annotations for tag in set(annotation.words.scene_tags))
    return {
        "kinds": len(annotations),
        "variants": sum(len(annotation.variants) for annotation in annotations),
        "scenes": {scene: tags[scene] for scene in SCENES},
        "sources": dict(sorted(Counter(annotation.source for annotation in annotations).items())),
    }
