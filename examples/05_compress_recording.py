"""Compress a recording of one's own: HDF5 in, the same HDF5 with videos in place of pictures out.

    python examples/05_compress_recording.py [DATA] OUT

DATA is a file or a folder in a layout of docs/data-formats.md, and is only read. Without it the program makes a small
recording in the layout of ACT beside OUT. `vcage decompress OUT --out BACK` puts the pictures back.
"""

import sys
from pathlib import Path

import h5py
import numpy as np

import vcage

STEPS, HEIGHT, WIDTH = 20, 48, 64


def record(path: Path) -> Path:
    """Write a recording of a block that slides over a table."""
    path.mkdir(parents=True, exist_ok=True)
    pictures = np.full((STEPS, HEIGHT, WIDTH, 3), (150, 120, 90), np.uint8)
    for step, picture in enumerate(pictures):
        picture[16:32, 2 * step : 2 * step + 16] = (200, 30, 40)
    with h5py.File(path / "episode_0.hdf5", "w") as file:
        file.attrs["fps"] = 10
        file["observations/images/top"] = pictures
        file["observations/qpos"] = np.linspace(0, 1, STEPS)[:, None] * np.ones(7)
        file["action"] = np.linspace(0, 1, STEPS)[:, None] * np.ones(7)
    return path


*given, out = sys.argv[1:]
data = Path(given[0]) if given else record(Path(out).with_name("recording"))
settings = vcage.CompressionSettings(keyframes=3)  # the fewest bytes that lose less than 0.1 JOD
packed = vcage.pack(vcage.Order(data, Path(out), settings), workers=1)

for camera in packed.record.cameras:
    print(f"{camera.camera}: {camera.pixel_format}, CRF {camera.crf}, at most {camera.loss_max:.3f} JOD lost")
print(f"{packed.record.reduction_stored:.0%} of the bytes are saved")
