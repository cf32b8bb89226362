from __future__ import annotations

import pytest

from tests.apps.viewer.conftest import ReadBack
from tests.recordings import CAMERAS, FPS, clip, collected
from vcage.apps.viewer.show import view
from vcage.base.errors import DamagedFile, MissingStage
from vcage.base.files import RunFolder
from vcage.schema.base import Provenance
from vcage.schema.compression import Compression, Encoding, VideoStream
from vcage.video.codec import EncoderSettings, encode

FRAMES = 12
FILE = "episodes/episode_000000.hdf5"


def compressed(run: RunFolder, frames: int = FRAMES) -> RunFolder:
    """The run with videos of its first episode."""
    sizes = dict.fromkeys(("bytes", "raw_bytes", "jpeg_bytes", "stored_bytes"), 1)
    found = {"codec": "hevc", "pixel_format": "yuv420p", "gop": 10, "crf": 30, "loss_max": 0.1, "loss_mean": 0.1}
    searched = {"held_out": None, "keyframes": [], "guarded": [], "evaluations": []}
    streams = []
    for camera in CAMERAS:
        video = run.root / f"compress/episode_000000.{camera}.mp4"
        video.parent.mkdir(exist_ok=True)
        video.write_bytes(encode(clip(frames), FPS, EncoderSettings(), 30))
        where = {"episode": FILE, "camera": camera, "file": run.relative(video), "frames": frames}
        streams.append(VideoStream(**where, **sizes, **found, **searched))
    how = {"codec": "hevc", "encoder": "libx265", "encoder_version": "4", "effort": "default", "preset": "medium"}
    judged = {"metric": "cvvdp", "display": "standard_fhd", "reduce": "max", "threshold": 0.1, "guard": True}
    Compression(
        provenance=Provenance(producer="compress", seed=0),
        encoding=Encoding(**how, **judged, scope="camera"),
        cameras=[],
        streams=streams,
        reduction_raw=0.9,
        reduction_jpeg=0.5,
        reduction_stored=0.5,
    ).write(run.compression)
    return run


def test_compressed_videos_are_shown_as_they_are(tmp_path):
    run = compressed(collected(tmp_path / "run", 1, FRAMES))
    view(run.root / FILE, save=tmp_path / "look.rrd", footage="compressed")
    seen = ReadBack(tmp_path / "look.rrd")
    video = (run.root / "compress/episode_000000.cam_high.mp4").read_bytes()
    assert bytes(seen.fixed("/world/cameras/cam_high", "Blob")) == video
    shown = seen.rows("/world/cameras/cam_high", "VideoTimestamp")
    assert list(shown.values()) == [pytest.approx(frame / FPS * 1e9, abs=1e6) for frame in range(FRAMES)]


def test_an_uncompressed_run_says_what_to_do(tmp_path):
    run = collected(tmp_path / "run", 1, FRAMES)
    with pytest.raises(MissingStage) as caught:
        view(run.root / FILE, save=tmp_path / "look.rrd", footage="compressed")
    assert "compress" in caught.value.hint


def test_an_episode_that_was_not_compressed_with_the_others_is_missing(tmp_path):
    run = compressed(collected(tmp_path / "run", 2, FRAMES))
    with pytest.raises(MissingStage, match="episode_000001"):
        view(run.root, number=1, save=tmp_path / "look.rrd", footage="compressed")


def test_a_video_of_another_length_is_damaged(tmp_path):
    run = compressed(collected(tmp_path / "run", 1, FRAMES), frames=5)
    with pytest.raises(DamagedFile, match="has 5 frames, its episode 12"):
        view(run.root / FILE, save=tmp_path / "look.rrd", footage="compressed")


@pytest.mark.parametrize("content", [b"", b"no video", None])
def test_a_file_that_is_no_video_is_damaged(tmp_path, content):
    run = compressed(collected(tmp_path / "run", 1, FRAMES))
    video = run.root / "compress/episode_000000.cam_high.mp4"
    if content is None:
        video.unlink()
    else:
        video.write_bytes(content)
    with pytest.raises(DamagedFile, match=r"cam_high\.mp4"):
        view(run.root / FILE, save=tmp_path / "look.rrd", footage="compressed")
