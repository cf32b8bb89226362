"""The page of a run: complete and self-contained, for any set of finished stages."""

from __future__ import annotations

import base64
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import h5py
import numpy as np
import pytest

from tests.run_folders import INSTRUCTION, OPTIONS, STAGES, Finished, copied
from vcage.apps.report.page import PageSettings, write_report
from vcage.apps.report.previews import GAP_PX
from vcage.base.errors import DamagedFile, MissingStage
from vcage.base.files import RunFolder, read_json, write_json, write_text
from vcage.base.pictures import read_picture
from vcage.base.videos import decode
from vcage.episodes.store import log_path, read_log
from vcage.schema.episodes import Episodes, Verdict
from vcage.schema.subtasks import Subtasks
from vcage.stages import verify


class Page(HTMLParser):
    """The elements of a page that a browser would load, show, and find open or closed."""

    VOID = {"meta", "img", "br", "hr", "input", "link"}

    def __init__(self, text: str):
        super().__init__()
        self.sources: list[tuple[str, str]] = []
        self.headings: list[str] = []
        self.open: list[str] = []
        self.text = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in self.VOID:
            self.open.append(tag)
        self.sources += [(tag, value or "") for name, value in attrs if name in ("src", "href", "poster", "data")]

    def handle_endtag(self, tag: str) -> None:
        while self.open and self.open.pop() != tag:
            pass

    def handle_data(self, data: str) -> None:
        self.text += data
        if self.open and self.open[-1] == "h2":
            self.headings.append(data)

    def of(self, tag: str) -> list[str]:
        return [url for name, url in self.sources if name == tag]


@pytest.fixture(scope="module")
def text(finished: Finished) -> str:
    return finished.run.report.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def page(text: str) -> Page:
    return Page(text)


def test_the_page_loads_nothing_from_elsewhere(page, text):
    assert page.sources and all(url.startswith("data:") for _, url in page.sources)
    assert not re.search(r"https?://|@import|url\((?!data:)", text)


def test_every_tag_is_closed(page):
    assert page.open == []


def test_it_has_every_section_of_a_whole_run(page):
    assert page.headings == [
        "Scene construction", "Layout plan", "Sub-tasks", "Episodes", "Where things start", "Acceptance",
        "Compression", "Data sets", "Timings", "Provenance",
    ]  # fmt: skip


def test_it_names_the_instruction_the_subtasks_and_the_reasons(finished, page):
    episode = Episodes.read(finished.run.episodes).episodes[0]
    subtasks = Subtasks.read(finished.run.subtasks)
    wanted = [INSTRUCTION, *(s.text for s in subtasks.kept), *(r.reason for r in subtasks.refused)]
    assert all(words in page.text for words in wanted + [v.reason for v in episode.verdicts])
    assert all(stage in page.text for stage in STAGES)


def test_every_accepted_episode_has_a_video_that_plays(finished, page, tmp_path):
    accepted = [e for e in Episodes.read(finished.run.episodes).episodes if e.accepted]
    assert len(page.of("video")) == len(accepted)
    path = tmp_path / "preview.mp4"
    path.write_bytes(base64.b64decode(page.of("video")[0].removeprefix("data:video/mp4;base64,")))
    frames = decode(path)
    assert len(frames) == accepted[0].frames
    assert frames[0].shape[1] == 4 * 320 + 3 * GAP_PX


def test_a_rejected_episode_is_reported_without_a_video(finished, tmp_path):
    run = copied(finished.run, tmp_path / "run")
    with h5py.File(run.root / Episodes.read(run.episodes).episodes[0].file, "a") as file:
        for camera in list(file["observations/images"]):  # as collecting leaves a rejected one
            del file["observations/images"][camera]
    page = Page(write_report(run).read_text(encoding="utf-8"))
    accepted = [e for e in Episodes.read(finished.run.episodes).episodes if e.accepted]
    assert len(page.of("video")) == len(accepted) - 1
    assert page.open == []


def test_pictures_of_all_stages_and_verdicts_are_inside(finished, page, tmp_path):
    verdicts = sum(len(e.verdicts) for e in Episodes.read(finished.run.episodes).episodes)
    assert len(page.of("img")) == 6 + 3 * verdicts
    path = tmp_path / "first.jpg"
    path.write_bytes(base64.b64decode(page.of("img")[0].split(",")[1]))
    assert read_picture(path).std() > 10


class Refuses:
    """A critic that says no to everything."""

    provider = "doubter"

    def judge(self, _question: object) -> Verdict:
        return Verdict(accepted=False, reason="I doubt it", confidence=0.6, provider=self.provider)


def test_disagreement_of_two_critics_is_shown_with_both_counted(finished, tmp_path, monkeypatch):
    run = copied(finished.run, tmp_path / "run", before="verify")
    pictures = len(Page(write_report(run).read_text(encoding="utf-8")).of("img"))
    monkeypatch.setattr(finished.context, "models", replace(finished.context.models, critic=Refuses()))
    record = verify.execute(run, OPTIONS, finished.context).record
    page = Page(write_report(run).read_text(encoding="utf-8"))
    assert page.open == []
    assert len(page.of("img")) == pictures + len(record.differences) > pictures
    counted = f"recall {record.critic.recall}; wrongly accepted 0, wrongly refused {len(record.differences)}"
    for words in ("Judged again by doubter", counted, "I doubt it", record.differences[0].truth.reason):
        assert words in page.text


def test_disagreement_of_critic_and_state_is_shown_side_by_side(finished, tmp_path):
    run = copied(finished.run, tmp_path / "run")
    first, *others = read_log(run.episodes.parent)
    refused = first.verdict.model_copy(update={"accepted": False, "reason": "it lies beside it"})
    disputed = first.model_copy(update={"accepted": False, "stage": "verify", "verdict": refused})
    write_text(log_path(run.episodes.parent), "".join(a.model_dump_json() + "\n" for a in (disputed, *others)))
    page = Page(write_report(run).read_text(encoding="utf-8"))
    assert "1 attempt on which critic and simulator state disagree" in page.text
    shown = " ".join(page.text[page.text.index("simulator state disagree") :].split())
    assert f"critic: no · {refused.confidence:.2f} it lies beside it simulator state: yes {first.truth.reason}" in shown


def test_an_episode_that_verify_refuses_is_not_counted_and_tells_why(finished, tmp_path):
    run = copied(finished.run, tmp_path / "run")
    verdicts = read_json(run.verdicts)
    for said in verdicts["episodes"].values():
        said[0] |= {"accepted": False, "reason": "it lies on the rim"}
    write_json(run.verdicts, verdicts)
    page = Page(write_report(run).read_text(encoding="utf-8"))
    episodes = Episodes.read(run.episodes).episodes
    assert "refused by verify" in page.text and "it lies on the rim" in page.text
    assert f"0 / {len(episodes)}" in page.text and page.of("video") == []


def test_edits_by_hand_are_named(finished, tmp_path):
    run = copied(finished.run, tmp_path / "run")
    write_json(run.matches, {**read_json(run.matches), "edited": ["matches.json"]})
    assert "matches.json" in write_report(run).read_text(encoding="utf-8").rpartition("edited by hand")[2]


def test_agreement_of_critics_is_reported(page):
    assert "Judged again by offline" in page.text and "The two differ on none of them." in page.text


@pytest.mark.parametrize("stage", STAGES[1:])
def test_a_run_that_stopped_before_any_stage_has_a_page(finished, tmp_path, stage):
    run = copied(finished.run, tmp_path / "run", before=stage)
    page = Page(write_report(run).read_text(encoding="utf-8"))
    assert page.open == []
    assert INSTRUCTION in page.text
    assert ("None collected yet." in page.text) == (STAGES.index(stage) <= STAGES.index("collect"))


def test_words_of_the_instruction_are_not_taken_for_tags(finished, tmp_path):
    run = copied(finished.run, tmp_path / "run", before="inpaint_plan")
    write_json(run.scene, {**read_json(run.scene), "instruction": "<script>alert(1)</script> & more"})
    text = write_report(run).read_text(encoding="utf-8")
    assert "<script>" not in text
    assert "<script>alert(1)</script> & more" in Page(text).text


def test_depth_and_masks_of_an_episode_are_shown(finished, tmp_path, monkeypatch):
    run = copied(finished.run, tmp_path / "run")
    before = write_report(run).read_text()
    assert "Boxes, masks and depth" not in before, "cameras took colour alone"
    monkeypatch.setattr("vcage.apps.report.page.channel_sheet", lambda _: np.full((30, 40, 3), 7, np.uint8))
    assert "Boxes, masks and depth" in write_report(run).read_text()


def test_an_empty_folder_has_no_page(tmp_path):
    with pytest.raises(MissingStage, match="holds no run"):
        write_report(RunFolder(tmp_path))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("file", ["plan", "episodes"])
def test_a_damaged_stage_is_named_and_the_old_page_stays(finished, tmp_path, file):
    run = copied(finished.run, tmp_path / "run")
    run.report.write_text("the old page")
    path: Path = getattr(run, file)
    path.write_text("{")
    with pytest.raises(DamagedFile, match=path.name):
        write_report(run)
    assert run.report.read_text() == "the old page"


def test_a_damaged_by_product_does_not_matter(finished, tmp_path):
    run = copied(finished.run, tmp_path / "run", before="inpaint_plan")
    run.timings.write_text("[1, 2")
    assert "Timings" not in Page(write_report(run).read_text(encoding="utf-8")).headings


def test_only_the_first_accepted_episodes_have_their_videos_in_it(finished, tmp_path, monkeypatch):
    accepted = [e for e in Episodes.read(finished.run.episodes).episodes if e.accepted]
    monkeypatch.setattr("vcage.apps.report.page.SETTINGS", PageSettings(max_previews=len(accepted) - 1))
    page = Page(write_report(copied(finished.run, tmp_path / "run")).read_text(encoding="utf-8"))
    assert len(page.of("video")) == len(accepted) - 1
    assert f"The first {len(accepted) - 1} accepted ones" in page.text
