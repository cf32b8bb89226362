from __future__ import annotations

import pytest

from vcage.datasets.packing.settings import CompressionSettings
from vcage.datasets.packing.writing import compression_record
from vcage.schema.base import Provenance
from vcage.schema.compression import Compression, HeldOutLoss, VideoStream
from vcage.video.choices import LOSSLESS
from vcage.video.encoders import CODECS

PROVENANCE = Provenance(producer="compress", seed=0)


def stream(camera: str = "top", **changes) -> VideoStream:
    facts = {
        "episode": "a",
        "camera": camera,
        "file": f"a.{camera}.mp4",
        "frames": 10,
        "bytes": 100,
        "raw_bytes": 10_000,
        "jpeg_bytes": 1_000,
        "stored_bytes": 2_000,
        "codec": "hevc",
        "pixel_format": "yuv444p10le",
        "gop": 10,
        "crf": 20,
        "loss_max": 0.05,
        "loss_mean": 0.04,
        "held_out": None,
        "keyframes": [0, 9],
        "guarded": [],
        "evaluations": [],
    }
    return VideoStream(**{**facts, **changes})


def record(*streams: VideoStream, **settings) -> Compression:
    return compression_record(PROVENANCE, CompressionSettings(**settings), streams)


def test_reductions_are_of_all_streams_together():
    made = record(stream(bytes=100), stream("wrist", bytes=300))
    assert (made.reduction_raw, made.reduction_jpeg, made.reduction_stored) == (0.98, 0.8, 0.9)


def test_a_camera_has_a_crf_where_all_its_episodes_have_it():
    (same,) = record(stream(), stream(episode="b")).cameras
    (several,) = record(stream(), stream(episode="b", crf=19, gop=30)).cameras
    assert (same.crf, same.gop) == (20, 10)
    assert (several.crf, several.gop, several.pixel_format) == (None, None, "yuv444p10le")


def test_a_camera_tells_the_colours_of_its_videos():
    def colours(*formats: str) -> tuple[str | None, str | None]:
        (camera,) = record(*(stream(pixel_format=name) for name in formats)).cameras
        return camera.matrix, camera.range

    assert colours("yuv420p", "yuv444p10le") == ("BT.601", "limited")
    assert colours("gbrp") == colours("rgb24") == ("RGB", "full")
    assert colours("gbrp", "yuv420p") == (None, None)


def test_a_camera_is_as_lossy_as_its_worst_episode():
    held_out = HeldOutLoss(worst=0.09, mean=0.05, frame=3, count=2)
    (camera,) = record(stream(loss_max=0.03), stream(loss_max=0.08, held_out=held_out)).cameras
    assert (camera.loss_max, camera.held_out_max, camera.lossless) == (0.08, 0.09, False)


def test_cameras_whose_streams_keep_every_pixel_are_without_loss():
    (camera,) = record(stream(crf=None), stream(crf=None)).cameras
    assert camera.lossless and camera.crf is None
    assert not record(stream(crf=None), stream()).cameras[0].lossless


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        ({}, ("camera", True)),
        ({"scope": "episode", "guard": False}, ("episode", False)),
        ({"crf": 18}, ("fixed", False)),
        ({"crf": LOSSLESS}, ("fixed", False)),
    ],
)
def test_the_encoding_states_the_sharing_of_crfs_and_the_use_of_held_out_frames(settings, expected):
    encoding = record(stream(), **settings).encoding
    assert (encoding.scope, encoding.guard) == expected


@pytest.mark.parametrize("codec", CODECS)
def test_the_encoding_names_the_encoder_its_effort_and_its_preset(codec):
    encoding = record(stream(), codec=codec).encoding
    assert (encoding.encoder, encoding.effort) == (CODECS[codec].encoder, "default")
    assert encoding.preset == CODECS[codec].presets["default"]
    assert encoding.encoder_version
