"""The common part of the services: a call, its refusal, and the checks of the request."""

from __future__ import annotations

import base64
import binascii
import email
import email.policy
import json
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from tests.model_server.special import Special


@dataclass(frozen=True)
class Call:
    """A request; ``body`` is the JSON object, or the fields of a form with lists of bytes for files."""

    method: str
    path: str
    headers: Mapping[str, str]
    body: dict[str, Any]


class Refused(Exception):
    """The service says no, with more than the status where it tells it by a ``reason`` of its own."""

    def __init__(self, status: int, message: str, reason: str = ""):
        super().__init__(message)
        self.status, self.message, self.reason = status, message, reason


class Service(ABC):
    """One of the services.

    Args of a subclass:
        name: as ``--models`` spells it.
        base: path of the base URL that clients are given.
    """

    name: str
    base: str

    @abstractmethod
    def check_key(self, headers: Mapping[str, str], key: str) -> None:
        """Refuse a call without the right key in the service's own header."""

    @abstractmethod
    def answer(self, call: Call, special: Special) -> dict[str, Any]:
        """The reply to a call that is right."""

    @abstractmethod
    def error(self, refused: Refused) -> dict[str, Any]:
        """A refusal in the service's own shape."""


def require(condition: object, message: str) -> None:
    if not condition:
        raise Refused(400, message)


def require_only(found: Mapping[str, Any], allowed: Iterable[str], where: str) -> None:
    """No field that the service does not take."""
    unknown = sorted(set(found) - set(allowed))
    require(not unknown, f"{where}: unknown or unsupported {', '.join(unknown)}")


def require_bearer(headers: Mapping[str, str], key: str, missing: str, wrong: str, reason: str = "") -> None:
    sent = headers.get("Authorization")
    if sent != f"Bearer {key}":
        raise Refused(401, wrong if sent else missing, reason)


def json_body(headers: Mapping[str, str], data: bytes) -> dict[str, Any]:
    kind = headers.get("Content-Type", "").partition(";")[0]
    if kind != "application/json":
        raise Refused(415, f"Content-Type is {kind or 'missing'}, not application/json")
    try:
        body = json.loads(data)
    except ValueError as error:
        raise Refused(400, f"not JSON: {error}") from error
    require(isinstance(body, dict), "the body is not an object")
    return body


def form_body(headers: Mapping[str, str], data: bytes) -> dict[str, Any]:
    head = f"Content-Type: {headers['Content-Type']}\r\n\r\n".encode()
    message = email.message_from_bytes(head + data, policy=email.policy.HTTP)
    form: dict[str, Any] = {}
    for part in message.iter_parts():
        name = part.get_param("name", header="content-disposition")
        content = part.get_payload(decode=True)
        if part.get_filename():
            form.setdefault(name, []).append(content)
        else:
            form[name] = content.decode()
    return form


# --- pictures ------------------------------------------------------------------------------------------

TYPES = {b"\x89PNG": "image/png", b"\xff\xd8\xff": "image/jpeg", b"RIFF": "image/webp"}


def picture_of_base64(text: object, said: object) -> np.ndarray:
    """A received picture; its content matches its type."""
    require(isinstance(text, str), "a picture is not base64")
    try:
        data = base64.b64decode(str(text), validate=True)
    except binascii.Error as error:
        raise Refused(400, f"a picture is not base64: {error}") from error
    kind = next((kind for head, kind in TYPES.items() if data.startswith(head)), None)
    require(kind == said, f"a picture is said to be {said} and is {kind}")
    return picture_of_bytes(data)


def picture_of_url(url: object) -> np.ndarray:
    """A picture in a ``data:`` URL."""
    head, comma, data = str(url).partition(",")
    require(comma and head.startswith("data:") and head.endswith(";base64"), "a picture is no data URL")
    return picture_of_base64(data, head[len("data:") : -len(";base64")])


def picture_of_bytes(data: bytes) -> np.ndarray:
    picture = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR) if data else None
    if picture is None:
        raise Refused(400, "a picture cannot be decoded")
    return picture


def drawn(picture: np.ndarray, special: Special) -> str:
    """Base64 of the edited picture, or what is to be sent for it: a little larger and brighter, as models draw it."""
    if special.picture is not None:
        return special.picture
    larger = cv2.resize(picture, None, fx=1.25, fy=1.25, interpolation=cv2.INTER_CUBIC)
    brighter = np.clip(larger.astype(np.float32) * 1.02 + 1, 0, 255).astype(np.uint8)
    return base64.b64encode(cv2.imencode(".png", brighter)[1].tobytes()).decode()
