"""The agent that runs the commands is the model: it reads a question from a folder and writes its answer there.

``ask/<role>-<hash>/`` of the run holds ``prompt.md``, ``schema.json`` and the pictures. Where ``answer.json`` is
missing, the command ends with :class:`vcage.base.errors.AnswerNeeded`; the next run reads the answer, stores it as
``answer-<round>.json``, and reads it for every repetition of the question. Remove the folder to answer again.
"""

from __future__ import annotations

import math
import re
from pathlib import Path

from vcage.base.drawing import contact_sheet
from vcage.base.errors import AnswerNeeded, InputFileError
from vcage.base.files import write_json, write_text
from vcage.base.pictures import write_picture
from vcage.base.reading import Unreadable, text_of
from vcage.models.exchange import Question, Reply

PROVIDER = "agent"

SHEET, COLUMNS, VIEW = "pictures.png", 4, 475
"""Contact sheet of a question's pictures: file, pictures in a row at most, and their width, pixels.

Clients shrink pictures above 2000 pixels."""

MAX_ANSWER_BYTES = 1_000_000
"""Limit on the file of an answer."""


class Agent:
    """Implements :class:`vcage.models.exchange.Answerer`.

    Args:
        folder: the folder of questions.
    """

    provider = PROVIDER

    def __init__(self, folder: Path):
        self._folder = folder

    def answer(self, question: Question) -> Reply:
        """The answer in ``answer-<round>.json``, or else in ``answer.json``.

        Raises:
            AnswerNeeded: there is none; names the files, the round and the complaint about the last answer.
            InputFileError: it is no text, or too long.
            OutputFolderError: the question cannot be written.
        """
        folder = self._folder / question.label
        stored, written = folder / f"answer-{question.round}.json", folder / "answer.json"
        if stored.exists():
            return Reply(_read(stored))
        if not written.exists():
            raise self._needed(question, folder)
        text = _read(written)
        written.replace(stored)
        return Reply(text)

    def _needed(self, question: Question, folder: Path) -> AnswerNeeded:
        """The error, once the question is written."""
        first = question.first.messages[0]
        names = [f"picture-{number:02}-{_spelled(what)}.png" for number, what in enumerate(question.captions, 1)]
        write_text(folder / "prompt.md", _prompt(question, names))
        write_json(folder / "schema.json", question.schema)
        for name, picture in zip(names, first.pictures, strict=True):
            write_picture(folder / name, picture)
        if len(names) > 1:
            names = [SHEET, *names]
            views = list(zip(question.captions, first.pictures, strict=True))
            write_picture(folder / SHEET, contact_sheet(views, min(COLUMNS, math.ceil(math.sqrt(len(views)))), VIEW))
        complaint = question.messages[-1].text if question.round > 1 else ""
        return AnswerNeeded.of(folder, question.role, question.round, complaint, ["prompt.md", "schema.json", *names])


def _prompt(question: Question, names: list[str]) -> str:
    """The text for the agent: the question, the pictures' captions, and complaints about its last answer."""
    parts = [question.messages[0].text]
    if names:
        listed = zip(names, question.captions, strict=True)
        parts.append("\n".join(["The pictures lie beside this file:", *(f"- {name}: {what}" for name, what in listed)]))
        if len(names) > 1:
            parts.append(f"{SHEET} shows them all.")
    parts.append("Write the JSON object that schema.json describes to answer.json in this folder.")
    if question.round > 1:
        parts.append(f"Your answer of round {question.round - 1}:\n{question.messages[-2].text.strip()}")
        parts.append(question.messages[-1].text)
    return "\n\n".join(parts) + "\n"


def _read(path: Path) -> str:
    if not path.is_file():
        raise InputFileError(f"{path} is no file", hint="write the JSON object into one")
    if path.stat().st_size > MAX_ANSWER_BYTES:
        raise InputFileError(f"{path} is {path.stat().st_size:,} bytes long", hint="write the JSON object alone")
    try:
        return text_of(path.read_bytes())
    except (OSError, Unreadable) as error:
        raise InputFileError(f"{path} cannot be read: {error}", hint="write it as UTF-8 text") from error


def _spelled(caption: str) -> str:
    """A caption as a part of a file's name."""
    return re.sub(r"[^a-z0-9]+", "-", caption.lower()).strip("-")[:40]
