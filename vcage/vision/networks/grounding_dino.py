"""Grounding DINO: finds named objects, in any picture, without knowing the empty table.

S. Liu et al., Grounding DINO: Marrying DINO with Grounded Pre-Training for Open-Set Object Detection, ECCV 2024.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import cv2
import numpy as np

from vcage.vision.networks.loading import Weights, device
from vcage.vision.protocols import Detection

logger = logging.getLogger(__name__)

Box = tuple[float, float, float, float]
"""u0, v0, u1, v1 in pixels, half open."""

WEIGHTS = "IDEA-Research/grounding-dino-tiny"
KINDS = ("grounding-dino", "mm-grounding-dino")


@dataclass(frozen=True)
class BoxLimits:
    """Limits of accepted boxes; the first two are those of the authors' demonstration.

    Args:
        box_probability: least probability of the word that fits a box best.
        text_probability: least probability of a name's best word for the box to be labelled with the name.
        same_object_iou: boxes that overlap by more (intersection over union) are one object, under any names.
        largest_share: a box that covers more of the picture is the table.
    """

    box_probability: float = 0.25
    text_probability: float = 0.25
    same_object_iou: float = 0.6
    largest_share: float = 0.5


class GroundingDinoDetector:
    """Implements :class:`vcage.vision.protocols.Detector`; gives boxes with names, and no masks.

    Args:
        weights: a hub id or a folder, see :class:`Weights`.
        limits: of the boxes.
    """

    def __init__(self, weights: str | None = None, limits: BoxLimits = BoxLimits()):
        self._weights = Weights(weights or WEIGHTS, KINDS)
        self._limits = limits
        self.provider = f"grounding-dino:{self._weights.name}"

    def detect(
        self, picture: np.ndarray, names: Sequence[str], background: np.ndarray | None = None
    ) -> list[Detection]:
        """Boxes of things with one of the names, the surest first; none without a name. ``background`` is not used."""
        found = [one for prompt in self._prompts(names) for one in self._ask(picture, prompt)]
        return distinct(sorted(found, key=lambda d: (-d.score, d.box)), self._limits.same_object_iou)

    def _prompts(self, names: Sequence[str]) -> Iterator[list[str]]:
        """The distinct names in groups whose tokens fit into the text encoder together."""
        limit = self._network.config.max_text_len - 2  # Beside the words stand a first and a last token.
        group: list[str] = []
        for name in dict.fromkeys(names):
            if not phrase(name):
                continue
            if group and self._tokens([*group, name]) > limit:
                yield group
                group = []
            if self._tokens([name]) > limit:
                logger.warning("the name %r is too long for the detector; it is left out", name)
                continue
            group.append(name)
        if group:
            yield group

    def _tokens(self, names: Sequence[str]) -> int:
        return len(self._processor.tokenizer(prompt_of(names)[0], add_special_tokens=False)["input_ids"])

    def _ask(self, picture: np.ndarray, names: Sequence[str]) -> list[Detection]:
        """Detections for one prompt."""
        import torch

        text, spans = prompt_of(names)
        inputs = self._processor(images=picture, text=text, return_tensors="pt").to(device())
        with torch.inference_mode():
            answer = self._network(**inputs)
        words = torch.sigmoid(answer.logits[0]).float().cpu().numpy()
        parts = [words[:, columns] for columns in self._columns(text, spans)]
        # Names may share words ("red block", "blue block"): the mean tells them apart.
        nearest = np.argmax([part.mean(axis=1) for part in parts], axis=0)
        boxes = corners(answer.pred_boxes[0].float().cpu().numpy(), picture.shape)
        found = []
        for index in np.flatnonzero(words.max(axis=1) > self._limits.box_probability):
            box = clipped(boxes[index], picture.shape, self._limits.largest_share)
            named = parts[nearest[index]][index].max() > self._limits.text_probability
            if box is not None:
                label = names[nearest[index]] if named else None
                found.append(Detection(box, None, float(words[index].max()), label))
        return found

    def _columns(self, text: str, spans: Sequence[tuple[int, int]]) -> list[np.ndarray]:
        """Indices of the tokens of each name, so that no name is guessed from decoded words."""
        offsets = np.array(self._processor.tokenizer(text, return_offsets_mapping=True)["offset_mapping"])
        real = offsets[:, 1] > offsets[:, 0]
        return [np.flatnonzero(real & (offsets[:, 0] >= start) & (offsets[:, 1] <= end)) for start, end in spans]

    @cached_property
    def _network(self) -> Any:
        return self._weights.read("AutoModelForZeroShotObjectDetection")

    @cached_property
    def _processor(self) -> Any:
        return self._weights.read("AutoProcessor")


def phrase(name: str) -> str:
    """A name as the network was trained to read it: lower case, without the full stop that ends a phrase."""
    return " ".join(name.lower().replace(".", " ").replace("?", " ").split())


def prompt_of(names: Sequence[str]) -> tuple[str, list[tuple[int, int]]]:
    """The text "first name. second name." and the half-open span of characters of each name in it."""
    text, spans = "", []
    for words in map(phrase, names):
        start = len(text) + (1 if text else 0)
        spans.append((start, start + len(words)))
        text += f"{' ' if text else ''}{words}."
    return text, spans


def corners(boxes: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """(n, 4) u0, v0, u1, v1 in pixels of boxes given as centre and size in shares of the picture."""
    centre, half = boxes[:, :2], boxes[:, 2:] / 2
    return np.concatenate([centre - half, centre + half], axis=1) * np.tile([shape[1], shape[0]], 2)


def clipped(box: Sequence[float] | np.ndarray, shape: tuple[int, ...], largest: float = 1.0) -> Box | None:
    """The part of a box inside a picture of that shape.

    None if it is not finite, has less than a pixel's area left, or covers more than the share ``largest``.
    """
    box = np.asarray(box, dtype=np.float64)
    if not np.isfinite(box).all():
        return None
    u0, v0, u1, v1 = (float(x) for x in np.clip(box, 0, [shape[1], shape[0]] * 2))
    area = max(u1 - u0, 0) * max(v1 - v0, 0)
    return (u0, v0, u1, v1) if 1 <= area <= largest * shape[0] * shape[1] else None


def distinct(detections: Sequence[Detection], overlap: float) -> list[Detection]:
    """The detections whose boxes do not overlap an earlier one by more: greedy non-maximum suppression.

    Args:
        detections: the best first.
        overlap: intersection over union above which two boxes are the same thing.
    """
    boxes = [(u0, v0, u1 - u0, v1 - v0) for u0, v0, u1, v1 in (d.box for d in detections)]
    chosen = cv2.dnn.NMSBoxes(boxes, [d.score for d in detections], 0.0, overlap)
    return [detections[index] for index in sorted(np.ravel(chosen).astype(int))]
