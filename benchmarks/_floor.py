"""Draw the accepted episodes of a run once and encode them once: no data set with these videos can cost less.

``python -m benchmarks._floor RUN`` is a process of its own. It prints a JSON object on its last line, with wall and CPU
seconds of two parts:

- ``draw``: worlds built from the recorded start and look, and the pictures of all states from all cameras;
- ``encode``: each camera's pictures, with the encoder, settings and CRF of the run.

Neither includes the fixed cost of a process: Python's start, imports, files read, and a first picture with its shaders.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from vcage.base.files import RunFolder
from vcage.datasets.reader import EpisodeReader
from vcage.episodes.recorded import Recorded
from vcage.runs.accepted import accepted_episodes
from vcage.runs.context import StageContext
from vcage.schema.compression import Compression, VideoStream
from vcage.sim.looks import look_world
from vcage.sim.replay import render_state
from vcage.sim.world import World
from vcage.video.codec import EncoderSettings, encode


class _Clock:
    """Wall and CPU seconds of this process by part."""

    def __init__(self) -> None:
        self.spent: dict[str, np.ndarray] = {}

    @contextmanager
    def __call__(self, part: str) -> Iterator[None]:
        before = _now()
        yield
        self.spent[part] = self.spent.get(part, 0.0) + _now() - before


def _now() -> np.ndarray:
    return np.array([time.perf_counter(), time.process_time()])


def draw_and_encode(run: RunFolder) -> dict[str, np.ndarray]:
    """Return (2,) wall and CPU seconds by part.

    Raises:
        VcageError: a file of the run cannot be read.
        ValueError: an encoding differs from the run's video.
    """
    record, context, clock = Compression.read(run.compression), StageContext("offline"), _Clock()
    for episode in accepted_episodes(run):
        path = run.file(str(episode.file))
        with EpisodeReader(path) as reader:
            recorded = Recorded.of(reader.episode, path, context)
        fps, states = recorded.episode.fps, list(recorded.states())
        if not clock.spent:
            render_state(_world(recorded), states[0])
        with clock("draw"):
            world = _world(recorded)
            frames = [render_state(world, state).pictures for state in states]
        for stream in record.streams:
            if stream.episode == episode.file:
                pictures = np.stack([frame[stream.camera] for frame in frames])
                with clock("encode"):
                    video = encode(pictures, fps, _settings(record, stream), stream.crf)
                if video != run.file(stream.file).read_bytes():
                    raise ValueError(f"{stream.file} is encoded from other pictures, or otherwise")
    return clock.spent


def _world(recorded: Recorded) -> World:
    return look_world(recorded.scene, recorded.models, recorded.robot, recorded.drawn.look)


def _settings(record: Compression, stream: VideoStream) -> EncoderSettings:
    return EncoderSettings(stream.codec, stream.pixel_format, record.encoding.effort, stream.gop)


if __name__ == "__main__":
    print(json.dumps({part: spent.tolist() for part, spent in draw_and_encode(RunFolder(Path(sys.argv[1]))).items()}))
