"""Add an object of one's own: write its two files, then measure it as the robot would see it.

    python examples/03_own_object.py [FOLDER]

FOLDER (default: my-objects) gets the object. docs/assets.md explains both files. After `export
VCAGE_ASSETS=$PWD/FOLDER` the command `vcage assets validate candle` proves that the robot can use it, and an
instruction may name it: "Put the candle on the plate".
"""

import json
import os
import sys
from pathlib import Path

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "my-objects").resolve()
os.environ["VCAGE_ASSETS"] = str(folder)  # names folders of objects, and is your consent to execute their model.py

import vcage  # noqa: E402

ANNOTATION = {
    "schema": "vcage.asset/1",
    "name": "candle",
    "words": {"name": "candle", "plural": "candles", "description": "A pillar candle.", "category": "decoration"},
    "variants": [{"id": "white", "colour": "white"}],
    "contact_points": [
        {"id": 0, "name": "top", "position": [0, 0, 0.06], "approach": [0, 0, -1], "closing": [1, 0, 0]}
    ],
}

MODEL = '''"""A pillar candle: 0.05 m across, 0.08 m high."""

from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng


def build(variant: str) -> BuiltObject:
    body = solids.revolved([(0, 0), (0.025, 0), (0.025, 0.077), (0.022, 0.08), (0, 0.08)])
    wax = materials.plastic(variant_rng("candle", variant), (244, 240, 226))
    hull = pieces.stack([(0.025, 0), (0.025, 0.08)])
    return BuiltObject([paint(body, wax, tiled(0.05))], [hull], mass=0.15, friction=0.6)
'''

(folder / "candle").mkdir(parents=True, exist_ok=True)
(folder / "candle" / "asset.json").write_text(json.dumps(ANNOTATION, indent=1))
(folder / "candle" / "model.py").write_text(MODEL)

library = vcage.Library.load()
candle = library.asset("candle")
print(f"{len(library.names)} kinds of objects, one of them a candle of {candle.size.round(3)} m")
width = candle.grasp_width(candle.annotation.contact_points[0])
print(f"a gripper holds it {width * 1000:.0f} mm apart")
