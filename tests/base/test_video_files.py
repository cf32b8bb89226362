from __future__ import annotations

from fractions import Fraction

import av
import cv2
import numpy as np
import pytest

from tests.recordings import clip
from vcage.base import video_files
from vcage.base.errors import DamagedFile, OversizedFile
from vcage.base.video_files import VideoLimits, frame_size, open_video
from vcage.base.videos import pictures
from vcage.video.codec import EncoderSettings, encode


@pytest.fixture(scope="module")
def video(tmp_path_factory):
    path = tmp_path_factory.mktemp("video") / "a.mp4"
    path.write_bytes(encode(clip(4), 10.0, EncoderSettings(gop=2), 20))
    return path


@pytest.mark.parametrize(
    "text",
    [
        "#EXTM3U\n#EXT-X-TARGETDURATION:10\n#EXTINF:10,\n{video}\n#EXT-X-ENDLIST\n",
        "ffconcat version 1.0\nfile '{video}'\n",
    ],
)
def test_a_list_of_other_files_is_no_video(tmp_path, video, text):
    (tmp_path / "list.mp4").write_text(text.format(video=video))
    with pytest.raises(DamagedFile, match=r"list\.mp4 cannot be decoded"):
        next(pictures(tmp_path / "list.mp4"))


def test_the_size_of_frames_is_read_without_decoding_them(video):
    assert frame_size(video) == clip(4).shape[1:3]


def test_a_relative_path_is_never_taken_for_a_protocol(tmp_path, video, monkeypatch):
    monkeypatch.chdir(tmp_path)
    name = f"subfile,,start,0,end,{video.stat().st_size},,:{video}".replace("/", "_")
    (tmp_path / name).write_bytes(video.read_bytes())
    with open_video((tmp_path / name).relative_to(tmp_path)) as container:
        assert container.streams.video[0].frames == 4


@pytest.mark.parametrize("limits", [VideoLimits(max_frames=3), VideoLimits(max_pixels=100)])
def test_a_video_that_declares_too_much_is_refused_with_its_claim(video, monkeypatch, limits):
    monkeypatch.setattr(video_files, "LIMITS", limits)
    with pytest.raises(OversizedFile, match="4 frames of 64 x 48"), open_video(video):
        pass


def test_a_frame_that_is_larger_than_the_header_says_is_not_decoded(tmp_path, monkeypatch):
    small, large = (cv2.imencode(".png", np.zeros((size, size), np.uint8))[1].tobytes() for size in (16, 512))
    (tmp_path / "small.png").write_bytes(small)
    with av.open(str(tmp_path / "small.png")) as source, av.open(str(tmp_path / "a.mp4"), "w") as target:
        stream = target.add_stream_from_template(source.streams.video[0])
        for time in range(2):
            packet = av.Packet(large)
            packet.pts, packet.dts, packet.duration = time, time, 1
            packet.time_base, packet.stream, packet.is_keyframe = Fraction(1, 10), stream, True
            target.mux(packet)
    assert list(pictures(tmp_path / "a.mp4"))
    monkeypatch.setattr(video_files, "LIMITS", VideoLimits(max_pixels=100_000))
    with pytest.raises(DamagedFile, match=r"a\.mp4"):
        list(pictures(tmp_path / "a.mp4"))
