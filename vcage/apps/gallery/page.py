"""The page of the library: every variant from three sides and from above, at one scale."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vcage.apps.gallery.renders import VIEWS, portrait
from vcage.apps.html import rendered
from vcage.base.files import RunFolder, write_text
from vcage.base.pictures import write_picture
from vcage.base.progress import Progress, silent
from vcage.objects.library import Library

PAGE = "index.html"
TEMPLATE = Path(__file__).with_name("gallery.html.jinja")


@dataclass(frozen=True)
class Picture:
    """One strip of views on the page.

    Args:
        path: relative to the page.
        width: pixels.
        caption: shown below it.
    """

    path: str
    width: int
    caption: str


def write_gallery(library: Library, folder: Path, names: Sequence[str] = (), progress: Progress = silent) -> Path:
    """Write ``index.html`` and ``pictures/`` of all objects, or of those named.

    Args:
        library: of the objects.
        folder: of the page.
        names: of the objects; all when empty.
        progress: called before each variant.

    Raises:
        UnknownName: there is no such object.
        OutputFolderError: the folder cannot be written.
        NoRenderer: nothing here can draw.
    """
    wanted = library.variants(names or None)
    RunFolder(folder).make()
    pictures: dict[str, list[Picture]] = {}
    for number, (name, variant) in enumerate(wanted):
        progress(f"{name}/{variant}", number, len(wanted))
        pictures.setdefault(name, []).extend(draw_variant(library, name, variant, folder))
    cards = [
        {"annotation": library.annotation(name), "size": library.asset(name).size, "pictures": drawn}
        for name, drawn in pictures.items()
    ]
    shown = {"cards": cards, "left_out": library.left_out, "scale": VIEWS.metres_per_px, "variants": len(wanted)}
    return write_text(folder / PAGE, rendered(TEMPLATE, shown))


def draw_variant(library: Library, name: str, variant: str, folder: Path) -> list[Picture]:
    """Write the strips of one variant into ``folder/pictures``: closed, and opened if parts of it move.

    Args:
        library: of the objects.
        name, variant: which.
        folder: of the page.
    """
    asset = library.asset(name, variant)
    pictures = []
    for opened in (False, True) if asset.articulated else (False,):
        state = "-opened" if opened else ""
        strip = _side_by_side(portrait(asset, opened=opened))
        path = f"pictures/{name}-{variant}{state}.png"
        write_picture(folder / path, strip)
        caption = f"{variant}, opened" if opened else variant
        pictures.append(Picture(path, strip.shape[1], caption))
    return pictures


def _side_by_side(views: Mapping[str, np.ndarray]) -> np.ndarray:
    """One picture of all views, bottom edges level."""
    height = max(len(picture) for picture in views.values())
    padded = [np.pad(x, ((height - len(x), 0), (0, 0), (0, 0)), mode="edge") for x in views.values()]
    return np.hstack(padded)
