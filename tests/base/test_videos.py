from __future__ import annotations

from pathlib import Path

import av
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.recordings import FPS, clip
from vcage.base.errors import DamagedFile, UsageError
from vcage.base.videos import (
    codec_name,
    decode,
    decode_whole,
    frame_count,
    frame_rate,
    frame_times,
    pictures,
)
from vcage.video.codec import EncoderSettings, encode

FRAMES = 40


def mux(path: Path, encoder: str, options: dict[str, str], container: dict[str, str] | None = None) -> Path:
    """A video of ``clip(FRAMES)`` made with an encoder's own options."""
    with av.open(str(path), "w", options=container or {}) as target:
        stream = target.add_stream(encoder, rate=int(FPS))
        stream.height, stream.width, stream.pix_fmt, stream.options = 48, 64, "yuv420p", options
        for picture in clip(FRAMES):
            target.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        target.mux(stream.encode(None))
    return path


OTHERS = {
    "h264.mp4": ("libx264", {"g": "12", "bf": "3"}),
    "h264-open-gop.mp4": ("libx264", {"g": "12", "bf": "3", "x264-params": "open-gop=1"}),
    "h264-b-frames-only.mkv": ("libx264", {"g": "250", "bf": "8"}),
    "h264.ts": ("libx264", {"g": "12", "bf": "3"}),
    "hevc-open-gop.mp4": ("libx265", {"x265-params": "keyint=10:bframes=4:open-gop=1:log-level=none"}),
    "av1.mp4": ("libsvtav1", {"g": "10", "preset": "12", "svtav1-params": "pred-struct=2"}),
}
OURS = {f"gop-{gop}.mp4": gop for gop in (2, 10, 250)}


@pytest.fixture(scope="module")
def videos(tmp_path_factory) -> dict[str, tuple[Path, np.ndarray]]:
    """Name → the file and its pictures, decoded from the start by PyAV alone."""
    folder = tmp_path_factory.mktemp("videos")
    for name, (encoder, options) in OTHERS.items():
        mux(folder / name, encoder, options)
    for name, gop in OURS.items():
        (folder / name).write_bytes(encode(clip(FRAMES), FPS, EncoderSettings(gop=gop), 4))
    return {path.name: (path, linear(path)) for path in folder.iterdir()}


def linear(path: Path) -> np.ndarray:
    with av.open(str(path)) as container:
        return np.stack([frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)])


@pytest.fixture(scope="module")
def video(videos) -> bytes:
    return videos["gop-10.mp4"][0].read_bytes()


@pytest.mark.parametrize("name", [*OTHERS, *OURS])
def test_every_frame_alone_is_that_of_the_whole_video(videos, name):
    path, whole = videos[name]
    assert len(whole) == FRAMES
    for index in range(FRAMES):
        assert np.array_equal(decode(path, [index]), whole[[index]]), index


@pytest.mark.parametrize("name", [*OTHERS, *OURS])
@settings(deadline=None, max_examples=15)
@given(indices=st.sets(st.integers(0, FRAMES - 1)))
def test_chosen_frames_match_the_whole_video_in_time_order(videos, name, indices):
    path, whole = videos[name]
    assert np.array_equal(decode(path, list(indices)), whole[sorted(indices)])


@pytest.mark.parametrize("name", [*OTHERS, *OURS])
def test_pictures_come_one_by_one_as_in_the_whole_video(videos, name):
    path, whole = videos[name]
    assert all(np.array_equal(*pair) for pair in zip(pictures(path), whole, strict=True))
    assert np.array_equal(decode(path), whole)
    assert frame_count(path) == FRAMES


@pytest.mark.parametrize("name", [*OTHERS, *OURS])
def test_frames_are_counted_where_all_are_decoded_for_some(videos, name):
    path, whole = videos[name]
    found, count = decode_whole(path, [31, 3])
    assert np.array_equal(found, whole[[3, 31]])
    assert count == FRAMES


@pytest.mark.parametrize("name", [*OTHERS, *OURS])
def test_frames_are_shown_in_order_when_a_decoder_shows_them(videos, name):
    path, _ = videos[name]
    with av.open(str(path)) as container:
        shown = [frame.time for frame in container.decode(video=0)]
    assert frame_times(path) == pytest.approx(shown)


def test_a_video_in_memory_is_read_like_a_file(videos, video):
    assert np.array_equal(decode(video, [3, 31]), videos["gop-10.mp4"][1][[3, 31]])


def test_a_frame_is_reached_without_decoding_distant_ones(videos, tmp_path):
    path, whole = videos["h264.mp4"]
    with av.open(str(path)) as container:
        packets = [packet for packet in container.demux(video=0) if packet.size]
    content = bytearray(path.read_bytes())
    for packet in packets[:12]:
        content[packet.pos : packet.pos + packet.size] = bytes(packet.size)
    spoilt = tmp_path / "video.mp4"
    spoilt.write_bytes(content)
    assert np.array_equal(decode(spoilt, [15, 37]), whole[[15, 37]])
    with pytest.raises(DamagedFile):
        decode(spoilt, [3])


def test_a_file_that_was_replaced_is_looked_at_again(videos, tmp_path):
    path = tmp_path / "video.mp4"
    for name in ("gop-2.mp4", "h264.mp4"):
        path.write_bytes(videos[name][0].read_bytes())
        assert np.array_equal(decode(path, [37]), videos[name][1][[37]])


def test_no_index_gives_no_picture(video):
    assert decode(video, []).shape == (0, 48, 64, 3)


@pytest.mark.parametrize("index", [FRAMES, -1])
def test_a_frame_outside_the_video_is_refused(video, index):
    with pytest.raises(UsageError, match=f"{FRAMES} frames, frame {index}"):
        decode(video, [0, index])


@pytest.mark.parametrize(("name", "codec"), [("h264.mp4", "h264"), ("av1.mp4", "av1"), ("gop-2.mp4", "hevc")])
def test_a_video_says_how_it_is_encoded(videos, name, codec):
    assert codec_name(videos[name][0]) == codec


READERS = {
    "decode": decode,
    "one": lambda path: decode(path, [0]),
    "pictures": lambda path: list(pictures(path)),
    "count": frame_count,
    "whole": lambda path: decode_whole(path, [0]),
}


@pytest.mark.parametrize("read", READERS.values(), ids=READERS)
@pytest.mark.parametrize("content", [b"", b"not a video at all", None], ids=["empty", "text", "header"])
def test_a_file_without_video_data_is_damaged(tmp_path, video, read, content):
    path = tmp_path / "video.mp4"
    path.write_bytes(video[:300] if content is None else content)
    with pytest.raises(DamagedFile, match=r"video\.mp4"):
        read(path)


@pytest.mark.parametrize("read", READERS.values(), ids=READERS)
@pytest.mark.parametrize("share", [0.5, 0.8, 0.99])
def test_a_video_that_is_cut_off_is_damaged(tmp_path, read, share):
    path = mux(tmp_path / "video.mp4", "libx264", {"g": "5"}, {"movflags": "faststart"})
    path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])
    with pytest.raises(DamagedFile, match=r"video\.mp4"):
        read(path)


@pytest.mark.parametrize("read", READERS.values(), ids=READERS)
def test_a_video_that_ends_between_two_frames_holds_fewer_than_it_claims(tmp_path, read):
    path = mux(tmp_path / "video.mp4", "libx264", {"g": "5", "bf": "0"}, {"movflags": "faststart"})
    with av.open(str(path)) as container:
        ends = [packet.pos for packet in container.demux(video=0) if packet.size]
    path.write_bytes(path.read_bytes()[: ends[30]])
    with pytest.raises(DamagedFile, match=r"video\.mp4 claims 40 frames and holds 30"):
        read(path)


def test_a_file_without_pictures_is_damaged(tmp_path):
    with av.open(str(tmp_path / "sound.mp4"), "w") as container:
        stream = container.add_stream("aac", rate=8000)
        frame = av.AudioFrame.from_ndarray(np.zeros((1, 1024), np.float32), format="fltp", layout="mono")
        frame.sample_rate = 8000
        container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
    with pytest.raises(DamagedFile, match="no video stream"):
        decode(tmp_path / "sound.mp4")


@pytest.mark.parametrize("fps", [10.0, 16.67, 30000 / 1001, 250 / 15, 0.5])
@pytest.mark.parametrize("frames", [1, 3])
def test_the_frame_rate_is_the_one_it_was_encoded_with(fps, frames):
    video = encode(clip(frames), fps, EncoderSettings(effort="fast"), 30)
    assert frame_rate(video) == pytest.approx(fps, rel=1e-9)


def test_a_file_that_is_no_video_has_no_frame_rate(tmp_path):
    (tmp_path / "video.mp4").write_bytes(b"none")
    with pytest.raises(DamagedFile, match=r"video\.mp4"):
        frame_rate(tmp_path / "video.mp4")
