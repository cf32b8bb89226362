"""The editor that asks a model for pictures; a picture that is no edit of the source goes back with a complaint."""

from __future__ import annotations

import numpy as np

from vcage.base.errors import ModelRefused
from vcage.models import prompts
from vcage.models.exchange import Answerer, Message, Question
from vcage.models.protocols import EditRequest
from vcage.models.structured import ROUNDS
from vcage.vision.colour import distance, to_lab
from vcage.vision.register import register


class LlmEditor:
    """Implements :class:`vcage.models.protocols.ImageEditor`."""

    def __init__(self, who: Answerer):
        self._who = who
        self.provider = who.provider

    def rearrange(self, request: EditRequest) -> np.ndarray:
        """The edited picture, in the size it came in.

        Raises:
            ModelRefused: the last round's picture is no edit of the source either.
            AnswerNeeded, EndpointFailed, ConfigurationError: see :class:`vcage.models.exchange.Answerer`.
        """
        prompt = prompts.fill("rearrange", scene=request.scene, plan=request.plan)
        turn = Message("user", prompt.text, (request.picture,))
        question = Question("editor", (turn,), None, prompt.name, ("the picture to edit",))
        complaint = ""
        for _ in range(ROUNDS):
            reply = self._who.answer(question)
            if reply.picture is None:
                raise ModelRefused(f"{self.provider} gave no picture", hint="use --editor offline")
            complaint = edit_complaint(reply.picture, request.picture, request.background)
            if not complaint:
                return reply.picture
            said = f"That is not the picture that was asked for: {complaint}. Edit the first one."
            question = question.again(reply, said)
        raise ModelRefused(
            f"{self.provider} drew no edit of the picture in {ROUNDS} rounds: {complaint}",
            hint="try another model, or --editor offline",
        )


def edit_complaint(
    picture: np.ndarray,
    source: np.ndarray,
    background: np.ndarray,
    *,
    table_lab: float = 20.0,
    min_table_share: float = 0.5,
    min_object_share: float = 0.3,
) -> str:
    """The complaint that a picture is no edit of another; empty if it is one.

    Image models recolour a little and move objects, but most of the picture still shows the same table.

    Args:
        picture: (h, w, 3) uint8 RGB of any size.
        source: (H, W, 3), the picture that was to be edited.
        background: (H, W, 3), the same view of the empty table.
        table_lab: largest colour distance (Lab) of a pixel that shows the table.
        min_table_share: least share of such pixels in the edit.
        min_object_share: least area of other pixels, as a share of that in the source.
    """
    laid = register(picture, source, background)
    empty = to_lab(background)
    seen = distance(to_lab(laid.picture), empty)[laid.valid] < table_lab
    table_share = float(seen.mean()) if seen.size else 0.0
    if table_share < min_table_share:
        return f"only {100 * table_share:.0f} % of it shows the table that was there"
    before = int((distance(to_lab(source), empty) >= table_lab).sum())
    if (~seen).sum() < min_object_share * before:
        return "it shows the table without the objects"
    return ""
