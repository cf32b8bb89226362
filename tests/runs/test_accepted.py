"""An episode that verify refuses stays where it is, and counts nowhere from then on."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.recordings import collected
from tests.run_folders import command
from vcage.apps.appending import append_to
from vcage.base.errors import MissingStage, StaleStage
from vcage.base.files import RunFolder, sha256_file, write_text
from vcage.datasets.packing.settings import CompressionSettings
from vcage.runs.accepted import acceptance_files, accepted_episodes, refusals
from vcage.runs.context import StageContext
from vcage.runs.edits import seal
from vcage.runs.stage import StageOptions
from vcage.schema.base import Provenance
from vcage.schema.compression import Compression
from vcage.schema.episodes import CriticCounts, Episodes, Verdict, Verdicts
from vcage.schema.export import Export
from vcage.stages import compress, export

FIRST, SECOND = "episodes/episode_000000.hdf5", "episodes/episode_000001.hdf5"
COMPRESS = compress.Options(seed=7, workers=1, compression=CompressionSettings(crf=20, effort="fast", keyframes=2))
EXPORT = export.Options(seed=7, workers=1, formats=("lerobot-v3.0", "robotwin"))
WHY = "the block lies on the rim"


@pytest.fixture
def run(tmp_path: Path) -> RunFolder:
    return collected(tmp_path / "run", frames=6)


def judged(run: RunFolder, *refused: str) -> None:
    """What verify leaves when it refuses these."""
    verdicts = {
        e.file: [Verdict(accepted=e.file not in refused, reason=WHY, confidence=0.9, provider="offline")]
        for e in Episodes.read(run.episodes).episodes
        if e.file
    }
    inputs = {"episodes/episodes.json": sha256_file(run.episodes)}
    none = CriticCounts.of([])
    record = Verdicts(
        provenance=Provenance(producer="verify", seed=7, inputs=inputs),
        episodes=verdicts,
        critic=none,
        earlier_critic=none,
        not_kept=0,
        differences=[],
    )
    seal(record, run.verdicts)


def counted(run: RunFolder) -> list[str | None]:
    return [episode.file for episode in accepted_episodes(run)]


def forced(options: StageOptions) -> StageOptions:
    return type(options)(**{**vars(options), "force": True})


def done(run: RunFolder) -> tuple[Compression, Export]:
    """Both stages after verify, made again if need be."""
    context = StageContext("offline")
    return (
        compress.execute(run, forced(COMPRESS), context).record,
        export.execute(run, forced(EXPORT), context).record,
    )


def test_before_a_second_verdict_the_acceptance_by_collect_counts(run):
    assert counted(run) == [FIRST, SECOND]
    assert acceptance_files(run) == [run.episodes]


def test_a_rejected_episode_does_not_count_and_its_reason_is_reported(run):
    judged(run, SECOND)
    assert counted(run) == [FIRST]
    assert refusals(run) == {SECOND: WHY}
    assert acceptance_files(run) == [run.episodes, run.verdicts]


def test_verdicts_on_other_episodes_are_refused(run):
    judged(run, SECOND)
    write_text(run.episodes, run.episodes.read_text() + " ")
    with pytest.raises(StaleStage, match="judges other episodes") as caught:
        accepted_episodes(run)
    assert caught.value.maker == "verify"


def test_a_new_verdict_makes_the_stages_after_it_stale(run):
    context = StageContext("offline")
    done(run)
    judged(run, SECOND)
    with pytest.raises(StaleStage, match=r"verify/verdicts\.json"):
        compress.execute(run, COMPRESS, context)
    with pytest.raises(StaleStage, match=r"verify/verdicts\.json"):
        export.execute(run, EXPORT, context)


def test_a_refused_episode_is_in_no_video_no_data_set_and_no_figure(run):
    judged(run, SECOND)
    compression, exported = done(run)
    assert {stream.episode for stream in compression.streams} == {FIRST}
    assert [dataset.episodes for dataset in exported.datasets] == [1, 1]
    assert len(list((run.export.parent / "robotwin/data").iterdir())) == 1
    assert (run.root / SECOND).is_file()


@pytest.mark.slow
def test_the_videos_of_the_others_are_taken_over_when_one_is_refused(run, monkeypatch):
    before, _ = done(run)
    judged(run, SECOND)
    monkeypatch.setattr(compress, "search_data_set", lambda clips, *_, **__: {} if not clips else pytest.fail("again"))
    after, _ = done(run)
    assert after.streams == [stream for stream in before.streams if stream.episode == FIRST]
    assert list(after.set_aside) == [SECOND]


@pytest.mark.slow
def test_an_episode_whose_raw_pictures_are_gone_counts_again_when_the_verdict_changes(run):
    before, _ = done(run)
    judged(run, SECOND)
    done(run)
    judged(run)
    after, exported = done(run)
    assert (after.streams, after.packed, after.set_aside) == (before.streams, before.packed, {})
    assert [dataset.episodes for dataset in exported.datasets] == [2, 2]


def test_the_reasons_are_reported_if_all_are_rejected(run):
    judged(run, FIRST, SECOND)
    with pytest.raises(MissingStage, match=f"verify refused {FIRST}: {WHY}"):
        compress.execute(run, COMPRESS, StageContext("offline"))


@pytest.mark.slow
def test_where_all_are_refused_none_is_left_as_if_it_counted(run):
    before, _ = done(run)
    judged(run, FIRST, SECOND)
    with pytest.raises(MissingStage, match="no episode counts"):
        compress.execute(run, COMPRESS, StageContext("offline"))
    left = Compression.read(run.compression)
    assert (left.streams, list(left.set_aside), left.reduction_raw) == ([], [FIRST, SECOND], 0.0)
    assert [file.suffix for file in run.compression.parent.iterdir()] == [".json", ".json"]
    assert not run.export.parent.exists()
    judged(run)
    again, exported = done(run)
    assert again.streams == before.streams and [one.episodes for one in exported.datasets] == [2, 2]


@pytest.mark.slow
@pytest.mark.parametrize("stage", ["compress", "export"])
def test_the_ways_out_are_reported_if_all_are_rejected(run, capsys, stage):
    done(run)
    judged(run, FIRST, SECOND)
    answer = command(capsys, stage, "--run", run, "--seed", "7")
    assert answer.code == 3 and answer.error["code"] == "missing_stage"
    assert str(run.verdicts) in answer.error["hint"]
    assert f" collect --run {run.root} " in answer.record["next"] and " --episodes=4" in answer.record["next"]


def test_an_export_from_before_a_verdict_is_not_added_to_a_data_set(run, tmp_path):
    done(run)
    judged(run, SECOND)
    with pytest.raises(StaleStage, match="other episodes"):
        append_to(tmp_path / "all", run)
