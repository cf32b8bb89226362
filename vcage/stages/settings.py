"""What a user may choose for a run: one place for the defaults of all stages."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from vcage.datasets.lerobot.formats import FORMATS
from vcage.datasets.packing.settings import CompressionSettings
from vcage.layout.cost import Weights
from vcage.models.registry import DETECTORS, EMBEDDERS, THRESHOLD

OnFailure = Literal["resample", "abort"]

ROBOTWIN = "robotwin"

EXPORTS = (*FORMATS, ROBOTWIN)
"""Formats that the last stage writes."""


@dataclass(frozen=True)
class ExportSettings:
    """What the last stage writes.

    Args:
        formats: of :data:`EXPORTS`.
        codec: of the videos of LeRobot's formats; None for what was compressed.
        crf: instead of the one that was searched. None with another codec searches one at the same loss, or is lossless
            where the compression was; where its CRF was given, this one must be.
    """

    formats: tuple[str, ...] = tuple(FORMATS)
    codec: str | None = None
    crf: int | None = None


@dataclass(frozen=True)
class Settings:
    """Options of the stages; each stage reads those that concern it.

    Args:
        instruction: the task in plain language (first stage).
        template: scene template (first stage).
        seed: of every random choice; None for the seed of ``place/scene.json``, or 0 in the first stage.
        models: 'auto', 'offline', 'gemini', 'openai' or 'openrouter'.
        detector, embedder: what finds and tells apart the objects of the target picture; ``name`` or ``name:weights``
            (see :mod:`vcage.models.registry`).
        force: make a finished stage again.
        threshold: the paper's τ, smallest cosine similarity of a match that no label of the detector speaks for.
        margin: the paper's δ, smallest gap between two objects, metres: room for an open finger between any two, and a
            little for what settles.
        restarts: random restarts of the layout optimisation.
        weights: the λ of the layout's cost.
        episodes: how many accepted episodes to collect.
        on_failure: try a failed sub-task again from the verified state before it, or abort the episode.
        retries: attempts per sub-task beyond the first, when resampling.
        fps: frames per second of the recording; divides the 250 Hz of the physics.
        compression: how the videos are encoded and judged.
        export: what the last stage writes.
        workers: processes that compress; None takes as many as there are cores and memory for.
    """

    instruction: str | None = None
    template: str = "table"
    seed: int | None = None
    models: str = "auto"
    detector: str = DETECTORS[0]
    embedder: str = EMBEDDERS[0]
    force: bool = False
    threshold: float = THRESHOLD
    margin: float = 0.045
    restarts: int = 6
    weights: Weights = field(default_factory=Weights)
    episodes: int = 3
    on_failure: OnFailure = "resample"
    retries: int = 3
    fps: int = 10
    compression: CompressionSettings = field(default_factory=CompressionSettings)
    export: ExportSettings = field(default_factory=ExportSettings)
    workers: int | None = None
