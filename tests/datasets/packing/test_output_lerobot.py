"""LeRobot data sets with compressed pictures."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tests.datasets.conftest import episode_of
from tests.recordings import CAMERAS, FPS, clip, episode
from vcage.base.errors import UsageError
from vcage.base.files import sha256_file
from vcage.datasets.lerobot.formats import open_writer
from vcage.datasets.lerobot.statistics import picture_histogram
from vcage.datasets.packing.output import OutputSpec, output_notes, require_alike, resolve_output
from vcage.datasets.packing.pack import Order, pack
from vcage.datasets.packing.settings import CompressionSettings
from vcage.datasets.packing.sources import find_sources
from vcage.datasets.recordings.opening import open_all, open_recordings
from vcage.datasets.recordings.recording import VIDEOS
from vcage.video.codec import EncoderSettings, encode

LENGTHS = (6, 5)
SETTINGS = CompressionSettings(crf=20, keyframes=3)
OTHER = {"lerobot-v2.1": "lerobot-v3.0", "lerobot-v3.0": "lerobot-v2.1", "lerobot-v3.1": "lerobot-v2.1"}


@pytest.fixture(
    scope="module", params=[("lerobot-v2.1", "h264"), ("lerobot-v3.0", "av1"), ("lerobot-v3.1", "h264")], ids="-".join
)
def made(request, tmp_path_factory) -> Path:
    """A data set in LeRobot's usual codecs, with rewards."""
    version, codec = request.param
    folder = tmp_path_factory.mktemp(version)
    root = folder / "set"
    with open_writer(version, root) as writer:
        for index, length in enumerate(LENGTHS):
            pictures = clip(length, index)
            film = folder / f"{index}.mp4"
            film.write_bytes(encode(pictures, FPS, EncoderSettings(codec, "yuv420p", gop=2), 12))
            videos = dict.fromkeys(CAMERAS, film)
            histograms = dict.fromkeys(CAMERAS, picture_histogram(pictures))
            writer.add(episode_of(episode(length), videos, histograms, length))
    for file in (root / "data").rglob("*.parquet"):
        table = pq.read_table(file)
        pq.write_table(table.append_column("next.reward", pa.array(np.linspace(0, 1, table.num_rows))), file)
    info = json.loads((root / "meta/info.json").read_text())
    info["features"]["next.reward"] = {"dtype": "float64", "shape": [1], "names": None}
    (root / "meta/info.json").write_text(json.dumps(info))
    return root


@pytest.fixture
def dataset(made, tmp_path) -> Path:
    """A copy of it."""
    return shutil.copytree(made, tmp_path / "set")


def version_of(root: Path) -> str:
    return open_recordings(root)[0].LAYOUT


def hashes(root: Path) -> dict[str, str]:
    return {file.relative_to(root).as_posix(): sha256_file(file) for file in root.rglob("*") if file.is_file()}


def compressed(root: Path, target: str | None = None, cameras: tuple[str, ...] = ()) -> Path:
    out = root.parent / "out"
    pack(Order(root, out, SETTINGS, OutputSpec(target), cameras), workers=1)
    return out


@pytest.mark.slow
def test_the_same_version_keeps_all_but_the_videos(dataset):
    before = hashes(dataset)
    after = hashes(compressed(dataset))
    assert hashes(dataset) == before
    changed = {name for name in before if after.get(name) != before[name]}
    assert all(name.endswith(".mp4") or name.startswith(("meta/info.json", "meta/episodes/")) for name in changed)
    assert set(after) - set(before) == {"compression.json"}
    for index, recording in enumerate(open_recordings(dataset.parent / "out")):
        for camera in recording.cameras:
            assert camera.storage == "hevc"
            assert np.abs(recording.pictures(camera.name) - clip(LENGTHS[index], index).astype(int)).mean() < 8


@pytest.mark.slow
def test_info_says_how_the_videos_are_encoded_now(dataset):
    out = compressed(dataset, cameras=("cam_high",))
    features = json.loads((out / "meta/info.json").read_text())["features"]
    told = features["observation.images.cam_high"]["info"]
    assert (told["video.codec"], told["video.crf"], told["video.g"]) == ("hevc", 20, 10)
    assert features["observation.images.cam_left_wrist"]["info"]["video.codec"] in ("h264", "av1")


@pytest.mark.slow
def test_another_version_names_the_parts_it_left_out(dataset):
    out = compressed(dataset, OTHER[version_of(dataset)], ("cam_high",))
    assert version_of(out) == OTHER[version_of(dataset)]
    record = json.loads((out / "compression.json").read_text())
    language = ["language_persistent", "language_events"] if version_of(dataset) == "lerobot-v3.1" else []
    assert list(record["left_out"]) == ["next.reward", "subtask_index", *language]
    assert record["notes"] == {}


def test_the_same_version_says_of_nothing_that_it_is_left_out(dataset):
    sources = find_sources(dataset, SETTINGS).sources
    output = resolve_output(OutputSpec(), sources)
    assert output.target == version_of(dataset)
    assert [*sources[0].notes, *output_notes(sources, output)[sources[0].name]] == []


def test_the_same_version_needs_all_episodes(dataset):
    sources = find_sources(dataset, SETTINGS).sources[1:]
    with pytest.raises(UsageError, match="none can be left out; missing: 0"):
        resolve_output(OutputSpec(), sources)
    assert resolve_output(OutputSpec(OTHER[version_of(dataset)]), sources).target == OTHER[version_of(dataset)]


def test_depth_is_refused_before_anything_is_searched(dataset):
    info = json.loads((dataset / "meta/info.json").read_text())
    info["features"]["observation.images.cam_high"]["info"]["video.is_depth_map"] = True
    (dataset / "meta/info.json").write_text(json.dumps(info))
    sources = find_sources(dataset, SETTINGS)
    wanted = resolve_output(OutputSpec(), sources.sources)
    with pytest.raises(UsageError, match="cam_high shows depth"):
        require_alike(sources.clips(), wanted)
    require_alike(sources.clips(["cam_left_wrist"]), wanted)
    with pytest.raises(UsageError, match="cam_high shows depth"):
        require_alike(sources.clips(), OutputSpec(VIDEOS))
    assert any("cam_high shows depth" in note for note in sources.sources[0].notes)


def test_a_data_set_is_rgb_regardless_of_the_option(dataset):
    assert open_all(dataset, "rgb").recordings
    with pytest.raises(UsageError, match="RGB"):
        open_all(dataset, "bgr")
