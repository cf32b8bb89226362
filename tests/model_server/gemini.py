"""Google's Gemini: ``generateContent``, and what it serves."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from tests.model_server import schemas
from tests.model_server.answers import answer_question
from tests.model_server.service import Call, Refused, Service, drawn, picture_of_base64, require, require_only
from tests.model_server.special import Special

TEXT = {
    "gemini-4-argon": "gemini-4-argon",
    "gemini-3.8-flash": "gemini-3.8-flash",
    "gemini-pro-latest": "gemini-4-argon",
    "gemini-flash-latest": "gemini-3.8-flash",
}
"""Models that answer in text, and the version that a reply names."""

PICTURES = {name: name for name in ("gemini-nano-banana-2.1", "gemini-3-pro-image")}

PARAMETERS = frozenset(("contents", "systemInstruction", "generationConfig", "safetySettings"))

CONFIG = frozenset(
    [
        "candidateCount",
        "maxOutputTokens",
        "stopSequences",
        "seed",
        "responseMimeType",
        "responseJsonSchema",
        "responseModalities",
        "imageConfig",
        "mediaResolution",
        "thinkingConfig",
    ]
)
"""What is taken of ``generationConfig``: no ``temperature``, ``topP`` and ``topK``, which are deprecated."""

RATIOS = frozenset(["1:1", "2:3", "3:2", "3:4", "4:3", "4:5", "5:4", "9:16", "16:9", "21:9"])

USAGE = {"promptTokenCount": 70, "candidatesTokenCount": 5, "thoughtsTokenCount": 2, "totalTokenCount": 77}

_STATUS = {
    400: "INVALID_ARGUMENT",
    401: "UNAUTHENTICATED",
    403: "PERMISSION_DENIED",
    404: "NOT_FOUND",
    429: "RESOURCE_EXHAUSTED",
    500: "INTERNAL",
    503: "UNAVAILABLE",
}


class Gemini(Service):
    """Under ``/v1beta`` and ``/v1``."""

    name = "gemini"
    base = ""

    def check_key(self, headers: Mapping[str, str], key: str) -> None:
        sent = headers.get("x-goog-api-key")
        if not sent:
            raise Refused(403, "Method doesn't allow unregistered callers. Please use API Key to call this API.")
        if sent != key:
            raise Refused(400, "API key not valid. Please pass a valid API key.", "API_KEY_INVALID")

    def answer(self, call: Call, special: Special) -> dict[str, Any]:
        version, path = call.path.lstrip("/").split("/", 1)
        require(version in ("v1", "v1beta"), f"no such version: {version}")
        if call.method == "GET" and path == "models":
            return {"models": [_model(name) for name in (*TEXT, *PICTURES)]}
        asked = re.fullmatch(r"models/([\w.\-]+)(:\w+)?", path)
        if asked is None or asked[2] not in (None, ":generateContent") or (asked[2] is None) != (call.method == "GET"):
            raise Refused(404, f"no such path: {call.method} {call.path}")
        if asked[1] not in TEXT | PICTURES:
            raise Refused(
                404,
                f"models/{asked[1]} is not found for API version {version}, or is not supported for generateContent",
            )
        return _model(asked[1]) if asked[2] is None else _generate(asked[1], call.body, special)

    def error(self, refused: Refused) -> dict[str, Any]:
        status = _STATUS.get(refused.status, "UNKNOWN")
        told: dict[str, Any] = {"code": refused.status, "message": refused.message, "status": status}
        if refused.reason:
            info = {"@type": "type.googleapis.com/google.rpc.ErrorInfo", "reason": refused.reason}
            told["details"] = [{**info, "domain": "googleapis.com"}]
        return {"error": told}


def _model(name: str) -> dict[str, Any]:
    return {
        "name": f"models/{name}",
        "version": (TEXT | PICTURES)[name],
        "displayName": name.replace("-", " ").title(),
        "inputTokenLimit": 1_048_576,
        "outputTokenLimit": 65_536,
        "supportedGenerationMethods": ["generateContent", "countTokens"],
    }


def _generate(model: str, body: Mapping[str, Any], special: Special) -> dict[str, Any]:
    require_only(body, PARAMETERS, "request")
    contents = body.get("contents")
    require(isinstance(contents, list) and contents, "contents is not specified")
    for content in contents:
        require_only(content, ("role", "parts"), "contents")
        require(content.get("role") in ("user", "model"), "Please use a valid role: user, model.")
        require(content.get("parts"), "contents.parts must not be empty")
    require(contents[-1]["role"] == "user", "the last turn must be the user's")
    config = body.get("generationConfig", {})
    require_only(config, CONFIG, "generation_config")
    pictures = list(_pictures(contents))
    parts, finish = (_picture if "IMAGE" in config.get("responseModalities", []) else _text)(
        model, config, contents, pictures, special
    )
    told = {"modelVersion": (TEXT | PICTURES)[model], "responseId": "stand-in", "usageMetadata": USAGE}
    if special.blocked and "IMAGE" not in config.get("responseModalities", []):
        return told | {"promptFeedback": {"blockReason": "PROHIBITED_CONTENT"}}
    content = {"role": "model", "parts": parts} if parts else {"role": "model"}
    return told | {"candidates": [{"content": content, "finishReason": finish, "index": 0}]}


def _pictures(contents: Iterable[Mapping[str, Any]]) -> Iterable[np.ndarray]:
    for part in (part for content in contents for part in content["parts"]):
        require(part.keys() in ({"text"}, {"inlineData"}), "parts: each one is text or inlineData")
        if "inlineData" in part:
            # Google's own client sends the alphabet that is safe in URLs, and the type under the name of the protocol.
            sent = part["inlineData"]
            data = str(sent.get("data")).replace("-", "+").replace("_", "/")
            yield picture_of_base64(data, sent.get("mimeType", sent.get("mime_type")))


def _picture(
    model: str, config: Mapping[str, Any], _contents: object, pictures: list[np.ndarray], special: Special
) -> tuple[list[dict[str, Any]], str]:
    require(model in PICTURES, f"Model {model} does not support the requested response modalities: image")
    require("responseMimeType" not in config, "JSON mode is not enabled for this model")
    require_only(config.get("imageConfig", {}), ("aspectRatio", "imageSize"), "image_config")
    require(config.get("imageConfig", {}).get("aspectRatio", "1:1") in RATIOS, "aspect_ratio is not supported")
    require(pictures, "contents: no picture to edit")
    if special.blocked:
        return [], "IMAGE_SAFETY"
    said = [{"text": special.text or "Here it is."}]
    data = drawn(pictures[0], special)
    return said + ([{"inlineData": {"mimeType": special.mime, "data": data}}] if data else []), special.finish


def _text(
    model: str,
    config: Mapping[str, Any],
    contents: list[dict[str, Any]],
    pictures: list[np.ndarray],
    special: Special,
) -> tuple[list[dict[str, Any]], str]:
    require(model in TEXT, f"{model} answers with pictures: responseModalities must include IMAGE")
    if "responseJsonSchema" in config:
        require(config.get("responseMimeType") == "application/json", "response schema needs application/json")
        schemas.gemini(config["responseJsonSchema"])
    text = special.text
    if text is None:
        require("responseJsonSchema" in config, "the stand-in answers questions with a schema alone")
        prompt = "\n".join(part["text"] for part in contents[0]["parts"] if "text" in part)
        text = json.dumps(answer_question(config["responseJsonSchema"], prompt, pictures))
    return ([{"text": text}] if text else []), special.finish
