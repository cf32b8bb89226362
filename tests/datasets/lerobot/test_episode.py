"""Requirements on an episode to export."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from vcage.base.errors import UsageError
from vcage.datasets.lerobot.episode import LeRobotEpisode, SubtaskSpan

HISTOGRAM = np.ones((3, 256), np.int64)


@pytest.fixture
def foreign() -> LeRobotEpisode:
    """Five frames by somebody who recorded two commands and one camera."""
    return LeRobotEpisode(
        fps=20,
        robot="arm",
        task="push",
        videos={"top": Path("top.mp4")},
        histograms={"top": HISTOGRAM},
        sampled=1,
        action=np.zeros((5, 2)),
        action_names=["x", "y"],
    )


def test_the_number_of_frames_comes_from_the_recording(foreign):
    assert list(foreign.complaints()) == []
    assert foreign.length == 5
    pictures_only = replace(foreign, action=None, frames=7)
    assert list(pictures_only.complaints()) == []
    assert pictures_only.length == 7
    assert pictures_only.vectors == {}


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"fps": 0}, "frame rate is 0"),
        ({"fps": float("nan")}, "frame rate is nan"),
        ({"task": " "}, "no task"),
        ({"action": np.zeros((0, 2))}, "no frame"),
        ({"action": None}, "no frame"),
        ({"action": None, "frames": 5, "videos": {}, "histograms": {}}, "neither pictures nor state nor action"),
        ({"action": np.zeros((5, 3))}, r"action has the shape \(5, 3\), expected \(5, 2\)"),
        ({"action": np.zeros(5)}, r"action has the shape \(5,\)"),
        ({"frames": 6}, r"action has the shape \(5, 2\), expected \(6, 2\)"),
        ({"state": np.zeros((4, 1)), "state_names": ["x"]}, r"action has the shape \(5, 2\), expected \(4, 2\)"),
        ({"action": np.array([[0, 0]] * 3 + [[0, np.nan]] * 2)}, r"action of frame 3 holds NaN or infinity \(y\)"),
        ({"histograms": {}}, r"histograms of \[\], but videos of \['top'\]"),
        ({"histograms": {"top": np.zeros((3, 256))}}, "histogram of top"),
        ({"histograms": {"top": np.ones(256)}}, "histogram of top"),
        ({"sampled": 0}, "histogram of top"),
        ({"subtasks": [SubtaskSpan("a", 0, 3), SubtaskSpan("b", 2, 5)]}, "sub-task 'b' covers the frames 2…5"),
        ({"subtasks": [SubtaskSpan("a", 0, 6)]}, "within 5"),
    ],
)
def test_faults_of_an_export_are_reported(foreign, change, complaint):
    with pytest.raises(AssertionError, match=complaint):
        assert not list(replace(foreign, **change).complaints())


def test_some_frames_alone_have_commands_that_lead_to_the_next_of_them(foreign):
    numbers = np.arange(5.0)[:, None]
    spans = [SubtaskSpan("reach", 0, 2), SubtaskSpan("push", 2, 5)]
    whole = replace(
        foreign,
        videos={},
        histograms={},
        state=numbers,
        state_names=["x"],
        environment=10 * numbers,
        environment_names=["cup.x"],
        action=numbers + 1,
        action_names=["x"],
        subtasks=spans,
        frames=5,
    )
    found = whole.at(np.array([0, 2, 4]))
    assert list(found.complaints()) == []
    assert (found.length, found.state.ravel().tolist(), found.environment.ravel().tolist()) == (
        3,
        [0, 2, 4],
        [0, 20, 40],
    )
    assert found.action.ravel().tolist() == [2, 4, 5]
    assert [(span.text, span.start, span.end) for span in found.subtasks] == [("reach", 0, 1), ("push", 1, 3)]


def test_no_frame_is_left_out_of_videos(foreign):
    with pytest.raises(UsageError, match="videos that were compressed"):
        foreign.at(np.array([0, 4]))
