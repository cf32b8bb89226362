"""One data set of many runs: complete, without repetition, and whole whenever the process ends."""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from benchmarks._merge_runs import RunSpec, make_run
from tests.recordings import collected
from tests.run_folders import command, copied, digests
from vcage.base.errors import DiskFull, MissingStage, OutputFolderError, UsageError
from vcage.base.files import RunFolder, read_json, write_json
from vcage.campaigns import merge as merging
from vcage.campaigns.merge import RECORD, MergeSettings, Order, merge
from vcage.datasets.lerobot.formats import FORMATS
from vcage.datasets.lerobot.growing import COMMITTED, SOURCES, GrowingSet
from vcage.datasets.recordings.opening import open_recordings
from vcage.schema.merge import Merge

V3 = "lerobot-v3.0"
EPISODES = 2


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> Path:
    """A folder of a campaign: three runs of two episodes at different depths, and other folders."""
    root = tmp_path_factory.mktemp("campaign") / "campaign"
    for seed, place in enumerate(("jobs/red/0000", "jobs/red/0001", "jobs/blue/0000")):
        task = f"Put the {place.split('/')[1]} block on the plate"
        make_run(root / place, RunSpec(seed=seed, episodes=EPISODES, frames=6, instruction=task))
    (root / "exchanges").mkdir()
    (root / "jobs/red/0000/renders").mkdir()
    return root


@pytest.fixture
def campaign(made, tmp_path) -> Path:
    """A copy that may be changed."""
    return shutil.copytree(made, tmp_path / "campaign")


@pytest.fixture
def out(tmp_path) -> Path:
    return tmp_path / "all"


def info(out: Path, version: str = V3) -> dict[str, Any]:
    return json.loads((out / version / "meta/info.json").read_text())


def sources(out: Path, version: str = V3) -> list[tuple[str, str]]:
    rows = map(json.loads, (out / version / SOURCES).read_text().splitlines())
    return [(row["run"], Path(row["episode"]).name) for row in rows]


def another(root: Path, **changes: Any) -> RunFolder:
    return make_run(root, RunSpec(**{"seed": 50, "episodes": EPISODES, "frames": 6, **changes}))


@pytest.mark.parametrize("version", FORMATS)
def test_the_accepted_episodes_of_all_runs_are_one_data_set(made, out, version):
    record = merge([made], out, Order(formats=(version,))).record
    assert (record.runs, record.datasets[0].episodes, record.left_out) == (3, 6, [])
    found = open_recordings(out / version)
    assert [one.number for one in found] == list(range(6))
    assert {one.task for one in found} == {"Put the red block on the plate", "Put the blue block on the plate"}
    assert all(len(one.pictures("cam_high", [0, 5])) == 2 for one in found)
    assert not [path for path in (out / version).iterdir() if path.name.startswith(".")]


def test_states_are_those_of_the_runs_in_natural_order(made, out):
    merge([made], out)
    assert [run for run, _ in sources(out)] == [
        *["campaign/jobs/blue/0000"] * 2,
        *["campaign/jobs/red/0000"] * 2,
        *["campaign/jobs/red/0001"] * 2,
    ]
    table = pq.read_table(out / V3 / "data")
    whole = [pq.read_table(merged_alone(made / "jobs" / name, out.parent / name.replace("/", "-")))["observation.state"]
             for name in ("blue/0000", "red/0000", "red/0001")]  # fmt: skip
    expected = np.concatenate([column.to_numpy().tolist() for column in whole])
    np.testing.assert_array_equal(table["observation.state"].to_numpy().tolist(), expected)


def merged_alone(run: Path, out: Path) -> Path:
    merge([run], out)
    return out / V3 / "data"


def test_statistics_are_common(made, out):
    merge([made], out)
    stats = json.loads((out / V3 / "meta/stats.json").read_text())["observation.state"]
    values = np.array(pq.read_table(out / V3 / "data")["observation.state"].to_pylist())
    np.testing.assert_allclose(stats["mean"], values.mean(0), atol=1e-6)
    np.testing.assert_allclose(stats["q99"], np.quantile(values, 0.99, axis=0), atol=1e-6)
    assert stats["count"] == [36]


def test_the_card_tells_the_episodes_of_every_run_and_grows_with_the_data_set(campaign, out):
    merge([campaign / "jobs/red"], out, Order(license="cc-by-4.0"))
    card = (out / V3 / "README.md").read_text()
    assert card.startswith("---\nlicense: cc-by-4.0\n") and "# Put the red block on the plate" in card
    another(campaign / "jobs/green/0000", instruction="Put the green block on the plate")
    merge([campaign], out, Order(license="cc-by-4.0"))
    rows = [json.loads(line) for line in (out / V3 / "meta/runs.jsonl").read_text().splitlines()]
    counted = {row["run"]: row["episodes"] for row in rows}
    assert counted == Counter(run for run, _ in sources(out))
    assert sum(counted.values()) == info(out)["total_episodes"]
    card = (out / V3 / "README.md").read_text()
    assert "| Put the green block on the plate | 2 |" in card and "| Put the red block on the plate | 4 |" in card
    assert "## Compression" in card and "of the others the data set does not know" not in card


@pytest.mark.slow
def test_a_copied_run_is_not_on_the_card(campaign, out):
    shutil.copytree(campaign / "jobs/red/0000", campaign / "jobs/red/copy")
    merge([campaign], out)
    assert "copy" not in (out / V3 / "meta/runs.jsonl").read_text()


def test_videos_are_linked_not_copied(campaign, out):
    merge([campaign], out)
    video = campaign / "jobs/blue/0000/compress/episode_000000.cam_high.mp4"
    assert (out / V3 / "videos/observation.images.cam_high/chunk-000/file-000.mp4").samefile(video)


# --- each episode once ---------------------------------------------------------------------------------


def test_a_repeated_merge_changes_no_data_set(made, out):
    merge([made], out)
    before = digests(out / V3)
    done = merge([made], out)
    assert (done.added, done.record.repeated) == ({V3: 0}, [])
    assert digests(out / V3) == before


def test_data_sets_and_links_below_a_folder_are_no_runs(campaign):
    merge([campaign], campaign / "all")
    (campaign / "linked").symlink_to(campaign / "jobs")
    (campaign / ".trash").mkdir()
    shutil.copytree(campaign / "jobs/red/0000", campaign / ".trash/0000")
    done = merge([campaign], campaign / "all")
    assert (done.record.runs, done.added, done.record.repeated) == (3, {V3: 0}, [])


def test_a_run_given_twice_is_merged_once(made, out):
    record = merge([made, made / "jobs/red/0000", made / "jobs"], out).record
    assert (record.runs, record.datasets[0].episodes) == (3, 6)


@pytest.mark.slow
def test_a_copied_run_is_merged_once_and_named(campaign, out):
    shutil.copytree(campaign / "jobs/red/0000", campaign / "jobs/red/copy")
    record = merge([campaign], out).record
    assert record.datasets[0].episodes == 6
    assert [(one.run, one.number) for one in record.repeated] == [
        ("campaign/jobs/red/copy", 2),
        ("campaign/jobs/red/copy", 3),
    ]


@pytest.mark.slow
def test_a_run_rendered_again_is_merged_once(tmp_path, out):
    for number, look in enumerate((0, 9)):
        another(tmp_path / f"runs/{number}", look=look)
    record = merge([tmp_path / "runs"], out).record
    assert (record.datasets[0].episodes, len(record.repeated)) == (2, 2)


@pytest.mark.slow
def test_a_run_simulated_again_with_other_motions_is_merged_once(tmp_path, out):
    for number, frames in enumerate((6, 7)):
        another(tmp_path / f"runs/{number}", frames=frames)
    assert merge([tmp_path / "runs"], out).record.datasets[0].episodes == 2


@pytest.mark.slow
@pytest.mark.parametrize("change", [{"seed": 51}, {"instruction": "Put the block away"}])
def test_another_seed_or_task_is_another_episode(tmp_path, out, change):
    another(tmp_path / "runs/0")
    another(tmp_path / "runs/1", **change)
    record = merge([tmp_path / "runs"], out).record
    assert (record.datasets[0].episodes + len(record.repeated), record.datasets[0].episodes) in ((4, 4), (4, 2))
    assert (record.datasets[0].episodes == 4) == ("seed" in change)  # the same motion under another name is no other


def test_new_runs_are_added(campaign, out):
    merge([campaign], out)
    another(campaign / "jobs/new/0000")
    done = merge([campaign], out)
    assert (done.added, done.record.datasets[0].episodes) == ({V3: 2}, 8)
    assert len(open_recordings(out / V3)) == 8


@pytest.mark.slow
def test_a_format_that_came_later_gets_all_episodes(made, out):
    merge([made], out)
    record = merge([made], out, Order(formats=tuple(FORMATS))).record
    assert [one.episodes for one in record.datasets] == [6] * len(FORMATS)


# --- what is damaged is left out -----------------------------------------------------------------------


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def flip(path: Path) -> None:
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 0xFF
    path.write_bytes(bytes(data))


BAD_EPISODE = [("episodes/episode_000001.hdf5", cut), ("episodes/episode_000001.hdf5", flip)]
BAD_VIDEO = [("compress/episode_000001.cam_high.mp4", cut), ("compress/episode_000001.cam_high.mp4", Path.unlink)]


@pytest.mark.parametrize(("file", "damage"), [*BAD_EPISODE, *BAD_VIDEO])
def test_a_damaged_episode_is_left_out_and_named(campaign, out, file, damage: Callable[[Path], None]):
    damage(campaign / "jobs/red/0000" / file)
    record = merge([campaign], out).record
    assert [(one.run, one.episode) for one in record.left_out] == [
        ("campaign/jobs/red/0000", "episodes/episode_000001.hdf5")
    ]
    assert Path(file).name in record.left_out[0].reason
    assert record.datasets[0].episodes == 5 == len(open_recordings(out / V3))
    assert Merge.read(out / RECORD) == record


def edit(path: Path) -> None:
    path.write_text(path.read_text().replace('"accepted": true', '"accepted": false', 1))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "damage"),
    [
        ("episodes/episodes.json", edit),
        ("episodes/episodes.json", cut),
        ("compress/compression.json", cut),
        ("compress/compression.json", Path.unlink),
        ("compress", shutil.rmtree),
    ],
)
def test_a_damaged_run_is_left_out_and_named(campaign, out, file, damage):
    damage(campaign / "jobs/red/0000" / file)
    record = merge([campaign], out).record
    assert [(one.run, one.episode) for one in record.left_out] == [("campaign/jobs/red/0000", None)]
    assert record.left_out[0].reason
    assert record.datasets[0].episodes == 4


def test_an_edited_record_of_the_compression_is_named_with_its_field(campaign, out):
    path = campaign / "jobs/red/0000/compress/compression.json"
    path.write_text(path.read_text().replace('"display": "', '"display": "x', 1))
    (left_out,) = merge([campaign], out).record.left_out
    assert left_out.code == "stale_stage"
    assert "compression.json: field provenance.options.display was edited" in left_out.reason


@pytest.mark.slow
def test_a_repaired_episode_is_added_by_the_next_merge(campaign, out):
    path = campaign / "jobs/red/0000/episodes/episode_000000.hdf5"
    whole = path.read_bytes()
    cut(path)
    assert merge([campaign], out).record.datasets[0].episodes == 5
    path.unlink()
    path.write_bytes(whole)
    record = merge([campaign], out).record
    assert (record.datasets[0].episodes, record.left_out) == (6, [])


def test_nothing_to_merge_is_an_error_with_the_first_reason(campaign, out):
    cut(campaign / "jobs/red/0000/compress/compression.json")
    with pytest.raises(MissingStage, match=r"no episode could be added: .*compression\.json"):
        merge([campaign / "jobs/red/0000"], out)
    with pytest.raises(MissingStage, match="no run folder"):
        merge([campaign / "exchanges"], out)


# --- runs that do not fit ------------------------------------------------------------------------------


@pytest.mark.parametrize("change", [{"robot": "aloha_agilex"}, {"fps": 5}, {"codec": "h264"}, {"cameras": ("front",)}])
def test_runs_that_do_not_fit_together_are_refused_by_name(made, tmp_path, out, change):
    another(tmp_path / "other", **change)
    with pytest.raises(UsageError, match=r"2 kinds: campaign/jobs/blue/0000 has .*, other has ") as caught:
        merge([made, tmp_path / "other"], out)
    assert "--group" in caught.value.hint
    assert not out.exists()


def test_a_run_that_does_not_fit_the_data_set_is_refused(made, tmp_path, out):
    merge([made], out)
    another(tmp_path / "other", robot="aloha_agilex")
    with pytest.raises(UsageError, match=r"other does not fit .*robot aloha_agilex"):
        merge([tmp_path / "other"], out)


def test_a_data_set_that_no_merge_made_is_refused_as_its_episodes_could_be_there_twice(made, out):
    merge([made], out)
    (out / V3 / SOURCES).unlink()  # as an export, which has no such list
    before = digests(out)
    with pytest.raises(UsageError, match="holds 6 episodes, of which 6 are not of a merge"):
        merge([made], out)
    assert digests(out) == before


@pytest.mark.slow
def test_groups_are_a_data_set_for_each_kind_of_runs(made, tmp_path, out):
    another(tmp_path / "other", robot="aloha_agilex")
    record = merge([made, tmp_path / "other"], out, Order(group=True)).record
    assert [one.episodes for one in record.datasets] == [6, 2]
    assert [one.group.split("-")[0] for one in record.datasets] == ["dual_panda", "aloha_agilex"]
    assert all(len(open_recordings(out / one.path)) == one.episodes for one in record.datasets)
    assert list(merge([tmp_path / "other"], out, Order(group=True)).added.values()) == [0]


@pytest.mark.slow
def test_degrees_of_compression_may_differ_within_a_data_set(made, tmp_path, out):
    another(tmp_path / "other", crf=30)
    assert merge([made, tmp_path / "other"], out).record.datasets[0].episodes == 8
    described = info(out)["features"]["observation.images.cam_high"]["info"]
    assert "video.crf" not in described and described["video.codec"] == "hevc"


def test_a_folder_in_a_run_is_refused(campaign):
    with pytest.raises(UsageError, match="in a run folder"):
        merge([campaign], campaign / "jobs/red/0000/all")


# --- splits --------------------------------------------------------------------------------------------


def test_whole_runs_are_held_out_and_come_last(made, out):
    record = merge([made], out, Order(test=0.3)).record
    assert record.datasets[0].splits == info(out)["splits"] == {"train": "0:4", "test": "4:6"}
    runs = [run for run, _ in sources(out)]
    assert not set(runs[:4]) & set(runs[4:])
    assert merge([made], out, Order(test=0.3)).added == {V3: 0}


@pytest.mark.slow
def test_runs_to_train_with_cannot_follow_the_test_split(campaign, out):
    merge([campaign], out, Order(test=0.3))
    for number in range(6):
        another(campaign / f"jobs/new/{number}", seed=100 + number)
    with pytest.raises(UsageError, match="its splits is"):
        merge([campaign], out, Order(test=0.3))
    assert len(open_recordings(out / V3)) == 6


@pytest.mark.slow
def test_a_copy_of_a_run_is_never_in_the_other_split(campaign, out):
    for run in sorted((campaign / "jobs/red").iterdir()):
        shutil.copytree(run, run.with_name(f"{run.name}-copy"))
    merge([campaign], out, Order(test=0.5))
    runs, (begin, end) = [run for run, _ in sources(out)], map(int, info(out)["splits"]["test"].split(":"))
    assert end == len(runs) == 6
    assert not {run.removesuffix("-copy") for run in runs[:begin]} & {run.removesuffix("-copy") for run in runs[begin:]}


def test_one_run_cannot_be_split(made, out):
    with pytest.raises(UsageError, match="takes whole runs"):
        merge([made / "jobs/blue"], out, Order(test=0.5))


# --- ends at any moment --------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("kind", [DiskFull, OutputFolderError])
def test_committed_episodes_stay_when_the_disk_is_full_or_becomes_read_only(made, out, monkeypatch, kind):
    monkeypatch.setattr(merging, "SETTINGS", MergeSettings(commit_episodes=2))
    begun = 0

    def full(*arguments: Any, add: Callable[..., None] = GrowingSet.add) -> None:
        nonlocal begun
        begun += 1
        if begun > 3:
            raise kind("it cannot be written")
        add(*arguments)

    with monkeypatch.context() as patched, pytest.raises(kind):
        patched.setattr(GrowingSet, "add", full)
        merge([made], out)
    assert len(open_recordings(out / V3)) == 2
    merge([made], out)
    assert digests(out / V3) == digests(undisturbed(made, out.parent / "whole", monkeypatch))


def undisturbed(made: Path, out: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(merging, "SETTINGS", MergeSettings(commit_episodes=2))
    merge([made], out)
    return out / V3


PROGRAM = """
import sys
from pathlib import Path
from vcage.campaigns import merge
merge.SETTINGS = merge.MergeSettings(commit_episodes=2)
print("ready", flush=True)
merge.merge([Path(sys.argv[1])], Path(sys.argv[2]), merge.Order(formats=("lerobot-v2.1", "lerobot-v3.0"), test=0.3))
"""


def _start(made: Path, out: Path) -> subprocess.Popen[str]:
    arguments = [sys.executable, "-c", PROGRAM, str(made), str(out)]
    process = subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    assert process.stdout is not None and process.stdout.readline() == "ready\n"
    return process


def _files(out: Path) -> int:
    return sum(len(files) for _, _, files in os.walk(out))  # which passes over what goes meanwhile


@pytest.mark.slow
def test_killed_merges_end_with_the_files_of_an_undisturbed_one(made, tmp_path):
    assert _start(made, tmp_path / "whole").wait() == 0
    expected, rng, killed = digests(tmp_path / "whole"), random.Random(0), 0
    out = tmp_path / "killed"
    for _ in range(3):
        enough = _files(out) + rng.randint(1, 16)
        process = _start(made, out)
        while process.poll() is None and _files(out) < enough:
            time.sleep(0.001)
        process.send_signal(signal.SIGKILL)
        killed += process.wait() == -signal.SIGKILL
        for version in ("lerobot-v2.1", V3):
            if (out / version / "meta/info.json").is_file() and not (out / version / COMMITTED).exists():
                assert len(open_recordings(out / version)) == info(out, version)["total_episodes"]
    assert _start(made, out).wait() == 0
    assert digests(out) == expected
    assert killed >= 2


# --- the command ---------------------------------------------------------------------------------------


def test_the_command_names_the_data_sets_and_what_was_left_out(campaign, out, capsys):
    cut(campaign / "jobs/red/0000/episodes/episode_000000.hdf5")
    answer = command(capsys, "merge", campaign, "--out", out, "--formats", V3, "lerobot-v2.1")
    assert answer.code == 0
    assert [one["episodes"] for one in answer.record["summary"]["datasets"]] == [5, 5]
    assert answer.record["left_out"][0]["episode"] == "episodes/episode_000000.hdf5"
    assert Path(answer.record["output"]) == out / RECORD
    assert "left out: campaign/jobs/red/0000/episodes/episode_000000.hdf5" in answer.stderr


def test_the_command_refuses_no_folder_at_all(out, capsys):
    assert command(capsys, "merge", "--out", out).code == 2


def test_states_alone_are_merged_of_runs_that_were_never_compressed(tmp_path, out):
    for seed in (1, 2):
        collected(tmp_path / "runs" / str(seed), count=2, frames=6, seed=100 * seed)
    record = merge([tmp_path / "runs"], out, Order(videos=False)).record
    assert (record.datasets[0].episodes, record.left_out) == (4, [])
    assert not [name for name in info(out)["features"] if name.startswith("observation.images")]
    assert merge([tmp_path / "runs"], out, Order(videos=False)).added == {V3: 0}


def test_the_state_of_objects_is_merged_where_runs_share_their_objects(finished, tmp_path, out):
    order = Order(videos=False, environment_state=True)
    copied(finished.run, tmp_path / "runs/a", before="compress")
    merge([tmp_path / "runs"], out, order)
    assert info(out)["features"]["observation.environment_state"]["names"]
    other = copied(finished.run, tmp_path / "runs/b", before="compress")
    scene = read_json(other.layout)
    scene["objects"] = scene["objects"][:-1]
    write_json(other.layout, scene)
    with pytest.raises(UsageError, match="of 2 kinds") as refused:
        merge([tmp_path / "runs"], tmp_path / "new", order)
    assert "numbers" in str(refused.value.details["other"])
