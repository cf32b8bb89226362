"""SAPIEN's shaders without light from an environment map, of which our worlds have none.

For the reflections of such a map SAPIEN integrates a table (the BRDF of B. Karis, "Real Shading in Unreal Engine 4",
2013) before the first picture of every process, read or not: seven seconds of a CPU that draws. Shaders that do not
declare the table are drawn with at once, and draw the same pictures to the last bit, for what it scales is black.
"""

from __future__ import annotations

import re
import shutil
from importlib import metadata, resources
from pathlib import Path

from filelock import FileLock

from vcage.base.files import atomic_folder, cache_dir

RECIPE = 1
"""Raised when this module changes what it writes, so that older cached copies are not used."""

TABLE = "samplerBRDFLUT"
DECLARATION = re.compile(rf"^layout\(.*\buniform sampler2D {TABLE};\n?", re.MULTILINE)
READING = re.compile(rf"texture\({TABLE}, vec2\(\w+, \w+\)\)\.xy")
SHARED = "common"
"""The folder beside the packs that they include from."""


def shaders_without_table(name: str) -> Path:
    """The folder of one of SAPIEN's shader packs (``default``, ``minimal``), in the user's cache; made on first use.

    A pack of another SAPIEN, whose table is read in a way that is not known here, is taken as it is.
    """
    folder = cache_dir("shaders") / f"sapien-{metadata.version('sapien')}-{RECIPE}"
    with FileLock(f"{folder}.lock"):
        if not (folder / name).is_dir():
            packs = Path(str(resources.files("sapien"))) / "vulkan_shader"
            if not (folder / SHARED).is_dir():
                _copy(packs / SHARED, folder / SHARED)
            _copy(packs / name, folder / name)
    return folder / name


def _copy(pack: Path, target: Path) -> None:
    texts = {path.name: without_table(path.read_text(encoding="utf-8")) for path in pack.iterdir() if path.is_file()}
    known = not any(TABLE in text for text in texts.values())
    with atomic_folder(target) as part:
        shutil.copytree(pack, part, dirs_exist_ok=True)
        for name, text in texts.items() if known else ():
            (part / name).write_text(text, encoding="utf-8")


def without_table(source: str) -> str:
    """The source of a shader to which the table is black."""
    return READING.sub("vec2(0)", DECLARATION.sub("", source))
