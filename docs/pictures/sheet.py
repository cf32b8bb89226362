"""Draw pictures in rows, as the sheets of the pages are: python docs/pictures/sheet.py OUT COLUMNS PICTURE…

objects.jpg, 8 columns: `vcage assets gallery NAME… --out runs/gallery`, then runs/gallery/pictures/….png
scenes.jpg, 3 columns: `vcage select-place --scene NAME --out runs/NAME`, then runs/NAME/place/source.png
"""

import sys
from pathlib import Path

from PIL import Image, ImageOps

WIDTH, GAP = 960, 6
"""Of the sheet, and between pictures, pixels."""

VIEWS = 4
"""That the gallery draws of an object, side by side."""

out, columns, *names = sys.argv[1:]
panel = (WIDTH - GAP) // int(columns) - GAP
pictures = []
for name in names:
    picture = Image.open(name).convert("RGB")
    if picture.width > 2 * picture.height:
        view = picture.crop((0, 0, picture.width // VIEWS, picture.height))
        picture = ImageOps.pad(view, (view.height, view.height), Image.Resampling.LANCZOS, view.getpixel((0, 0)))
    pictures.append(picture.resize((panel, panel * picture.height // picture.width), Image.Resampling.LANCZOS))

height = pictures[0].height + GAP
rows = -(-len(pictures) // int(columns))
sheet = Image.new("RGB", (WIDTH, rows * height + GAP), "white")
for index, picture in enumerate(pictures):
    row, column = divmod(index, int(columns))
    sheet.paste(picture, (GAP + column * (panel + GAP), GAP + row * height))
sheet.save(Path(out), quality=85)
