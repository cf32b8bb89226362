"""The server's special answers: faults, and answers chosen by a test."""

from __future__ import annotations

import random
from dataclasses import dataclass, field
from typing import Literal


@dataclass(frozen=True)
class Special:
    """An answer that replaces the usual one.

    Args:
        status: anything but 200 is an error in the service's own shape.
        body: raw bytes in place of any shape.
        text: what the model says.
        finish: why it ended, in Gemini's words; the others' are found from it.
        blocked: the service's own way to say that the request is not allowed.
        picture: base64 to send as the picture; ``""`` for none.
        mime: the declared type of the picture.
        refusal: text of OpenAI's refusal.
        manner: how the bytes of the answer come: at once, never, one by one, up to the middle, without their number.
    """

    status: int = 200
    headers: dict[str, str] = field(default_factory=dict)
    body: bytes | None = None
    text: str | None = None
    finish: str = "STOP"
    blocked: bool = False
    picture: str | None = None
    mime: str = "image/png"
    refusal: str | None = None
    manner: Literal["whole", "hang", "drip", "reset", "unsized"] = "whole"


def raw_answer(body: bytes, status: int = 200) -> Special:
    return Special(status=status, body=body)


def text_answer(text: str, finish: str = "STOP") -> Special:
    return Special(text=text, finish=finish)


def no_picture(reason: str = "NO_IMAGE") -> Special:
    return Special(picture="", finish=reason)


PASSING = (
    Special(status=429, headers={"Retry-After": "0"}),
    Special(status=500, headers={"Retry-After": "0"}),
    Special(status=503, headers={"Retry-After": "0"}),
    Special(manner="reset"),
    Special(body=b""),
    Special(text="I would rather tell a story.", picture="AAAA"),
    Special(text='```json\n{"surprise": true}\n```', picture="iVBORw0KGgo"),
)
"""Faults that are gone when a client asks again, or says what was wrong."""


class Faults:
    """Draws faults for a share of the requests, the same ones for the same seed."""

    def __init__(self, share: float, seed: int):
        self._share, self._rng = share, random.Random(seed)

    def draw(self) -> Special | None:
        fault = self._rng.choice(PASSING)
        return fault if self._rng.random() < self._share else None
