"""Draw docs/pictures/chain.jpg: what the stages of a finished run leave, in order, each with its caption.

vcage run "Pack the marker pens and the eraser into the box" --out runs/pack-stationery --episodes 1
python docs/pictures/chain.py runs/pack-stationery
"""

import sys
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

import vcage

PANEL = (320, 240)
STRIP, GAP, COLUMNS = 26, 8, 3
"""Height of a caption and distance of panels, pixels."""

run = vcage.RunFolder(sys.argv[1])
scene = vcage.Scene.read(run.layout)
episode = next(episode for episode in vcage.Episodes.read(run.episodes).episodes if episode.accepted)
last = episode.verdicts[-1]
with vcage.EpisodeReader(run.root / episode.file) as reader:
    segment = reader.episode.segments[-1]
    at_work = reader.images("cam_high")[segment.start + (segment.end - segment.start) * 6 // 10]
seen = next(run.episodes.parent / name for name in last.pictures if name.endswith("after-top.png"))

panels = [
    ("1  choose and place", Image.open(run.scene.with_name("source.png"))),
    ("2  plan, and draw the target", Image.open(run.plan.with_name("target.png"))),
    ("3  find the objects in it", Image.open(run.matches.with_name("overlay.png"))),
    ("4  make the layout possible", Image.open(run.layout.with_name("top.png"))),
    ("5, 6  search sub-tasks, collect", Image.fromarray(np.asarray(at_work))),
    (f"7  verify: {'done' if last.accepted else 'not done'}", Image.open(seen)),
]
rows = -(-len(panels) // COLUMNS)
size = (COLUMNS * (PANEL[0] + GAP) + GAP, STRIP + rows * (PANEL[1] + STRIP + GAP) + GAP)
page = Image.new("RGB", size, "white")
draw, font = ImageDraw.Draw(page), ImageFont.load_default(16)
draw.text((GAP, GAP), f"“{scene.instruction}”", "black", ImageFont.load_default(18))
for index, (caption, picture) in enumerate(panels):
    row, column = divmod(index, COLUMNS)
    x, y = GAP + column * (PANEL[0] + GAP), GAP + STRIP + row * (PANEL[1] + STRIP + GAP)
    page.paste(picture.convert("RGB").resize(PANEL, Image.Resampling.LANCZOS), (x, y + STRIP))
    draw.text((x, y + 4), caption, "black", font)
page.save(Path(sys.argv[2]) if len(sys.argv) > 2 else Path(__file__).with_suffix(".jpg"), quality=88)
