"""The page of a validation: every object with its pictures and results."""

from __future__ import annotations

from itertools import groupby
from pathlib import Path

from vcage.apps.gallery.page import Picture, draw_variant
from vcage.apps.html import rendered
from vcage.base.files import write_text
from vcage.base.progress import Progress, silent
from vcage.objects.library import Library
from vcage.schema.proof import Proof, VariantProof

PAGE = "proof.html"
TEMPLATE = Path(__file__).with_name("page.html.jinja")


def write_page(proof: Proof, library: Library, folder: Path, progress: Progress = silent) -> Path:
    """Write ``proof.html`` and ``pictures/``: the first variant of each object, and the results.

    Args:
        proof: the result.
        library: of the objects.
        folder: of the page.
        progress: called before each object.

    Raises:
        NoRenderer: nothing here can draw.
    """
    kinds = [(name, list(group)) for name, group in groupby(proof.results, key=lambda result: result.asset)]
    cards = []
    for number, (name, results) in enumerate(kinds):
        progress(name, number, len(kinds))
        cards.append({"name": name, "results": results, "pictures": _pictures(library, results[0], folder)})
    cards.sort(key=lambda card: not any(result.failed for result in card["results"]))
    shown = {"proof": proof, "cards": cards, "left_out": library.left_out}
    return write_text(folder / PAGE, rendered(TEMPLATE, shown))


def _pictures(library: Library, result: VariantProof, folder: Path) -> list[Picture]:
    """Pictures of a variant; none of an object that cannot be loaded, as its proof says."""
    loaded = any(check.measured for check in result.checks)
    return draw_variant(library, result.asset, result.variant, folder) if loaded else []
