"""The page about an episode that stands beside it in the viewer."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from vcage.apps.viewer.log import Clock
from vcage.apps.viewer.sdk import rr
from vcage.datasets.episode import EpisodeData
from vcage.datasets.recordings.recording import Recording


def about_episode(path: Path, episode: EpisodeData) -> rr.TextDocument:
    """The instruction, and the facts that travel in the file; the scene is left to be looked at."""
    facts = {name: value for name, value in episode.meta.items() if name not in ("instruction", "scene")}
    length = f"{episode.frames} frames, {episode.fps:g} a second"
    return _page(episode.instruction, {"file": path.name, "length": length, **facts})


def about_recording(recording: Recording, clock: Clock) -> rr.TextDocument:
    """What the recording is, and how it was understood."""
    cameras = [f"{camera.name} ({camera.width}x{camera.height}, {camera.storage})" for camera in recording.cameras]
    times = "at unknown times" if clock.seconds is None else f"{clock.seconds[-1]:g} s"
    facts = {
        "file": recording.path.name,
        "layout": recording.LAYOUT,
        "length": f"{len(clock)} frames, {times}",
        "cameras": ", ".join(cameras),
        "robot": recording.robot or "unknown",
        "notes": "; ".join(recording.notes) or "none",
    }
    return _page(recording.task or recording.path.name, facts)


def _page(title: str, facts: Mapping[str, Any]) -> rr.TextDocument:
    rows = [f"| {name} | {_words(value)} |" for name, value in facts.items()]
    return rr.TextDocument("\n".join([f"### {title}", "", "| | |", "|---|---|", *rows]), media_type="text/markdown")


def _words(value: Any) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {_words(inner)}" for name, inner in value.items())
    return str(value).replace("|", "\\|")
