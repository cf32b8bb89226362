"""The stand-in server is taken for the real services by the vendors' own clients, and refuses what they refuse."""

from __future__ import annotations

import base64
import json
import subprocess
import sys
from functools import cached_property, partial
from typing import Any, get_args, get_type_hints

import anthropic
import openai
import pytest
import requests
from anthropic.types import message_create_params
from google import genai
from google.genai import errors, types
from openai.types import image_edit_params
from openai.types.chat import completion_create_params

from tests.model_server import ModelServer, Special
from tests.model_server import anthropic as anthropic_service
from tests.model_server import openai as openai_service
from tests.model_server.answers import answer_question
from tests.model_server.server import MOST_BYTES
from tests.model_server.service import Refused
from tests.model_server.special import Faults
from tests.models.tabletop import BLOCKS, draw
from vcage.models.llm_critic import Judgement
from vcage.models.pictures import data_url, decode_base64, encode_base64, encode_png
from vcage.models.structured import flat_schema

PICTURE = draw(BLOCKS)[0]
SCHEMA = flat_schema(Judgement)
FORM = {"type": "json_schema", "json_schema": {"name": "answer", "strict": True, "schema": SCHEMA}}


class Sdk:
    """A vendor's client, asked in its own words."""

    def __init__(self, server: ModelServer, key: str | None = None):
        self.url, self.key = server.base_urls, key or server.key


class Google(Sdk):
    model, picture_model, wrong_key = "gemini-pro-latest", "gemini-nano-banana-2.1", (errors.ClientError, 400)

    @cached_property
    def client(self) -> genai.Client:
        return genai.Client(api_key=self.key, http_options=types.HttpOptions(base_url=self.url["gemini"]))

    def text(self, model: str | None = None, **more: Any) -> str | None:
        part = types.Part.from_bytes(data=encode_png(PICTURE), mime_type="image/png")
        config = types.GenerateContentConfig(response_mime_type="application/json", response_json_schema=SCHEMA, **more)
        return self.client.models.generate_content(
            model=model or self.model, contents=["Judge.", part, part], config=config
        ).text

    def picture(self) -> str:
        part = types.Part.from_bytes(data=encode_png(PICTURE), mime_type="image/png")
        config = types.GenerateContentConfig(response_modalities=["TEXT", "IMAGE"])
        reply = self.client.models.generate_content(
            model=self.picture_model, contents=["Edit it.", part], config=config
        )
        found = [part.inline_data for part in reply.candidates[0].content.parts if part.inline_data]
        assert found[0].mime_type == "image/png"
        return base64.b64encode(found[0].data).decode()

    def listed(self) -> list[str]:
        models = list(self.client.models.list())
        assert all("generateContent" in model.supported_actions for model in models)
        return [model.name.removeprefix("models/") for model in models]

    def one(self) -> str:
        return self.client.models.get(model=self.model).name.removeprefix("models/")


class OpenAi(Sdk):
    model, picture_model, wrong_key = "gpt-6.1-terra", "gpt-image-2", (openai.AuthenticationError, 401)
    service = "openai"

    @cached_property
    def client(self) -> openai.OpenAI:
        return openai.OpenAI(api_key=self.key, base_url=self.url[self.service], max_retries=0)

    def text(self, model: str | None = None, **more: Any) -> str | None:
        shown = {"type": "image_url", "image_url": {"url": data_url(PICTURE)}}
        content = [{"type": "text", "text": "Judge."}, shown, shown]
        reply = self.client.chat.completions.create(
            model=model or self.model,
            messages=[{"role": "user", "content": content}],
            response_format=FORM,
            **more,
        )
        return reply.choices[0].message.content

    def picture(self) -> str:
        source = ("source.png", encode_png(PICTURE), "image/png")
        reply = self.client.images.edit(model=self.picture_model, image=source, prompt="Edit it.")
        assert reply.usage.input_tokens and reply.output_format == "png"
        return reply.data[0].b64_json

    def listed(self) -> list[str]:
        models = self.client.models.list().data
        assert {model.id: model.shutdown_date for model in models}["gpt-image-1-mini"] == "2026-12-01"
        return [model.id for model in models]

    def one(self) -> str:
        return self.client.models.retrieve(self.model).id


class OpenRouter(OpenAi):
    """It has no client of its own for chat: its pages show OpenAI's."""

    model, service = "~google/gemini-pro-latest", "openrouter"

    def listed(self) -> list[str]:
        return ["~google/gemini-pro-latest", *(model.id for model in self.client.models.list().data)]


class Anthropic(Sdk):
    model, wrong_key = "claude-sonnet-5-5", (anthropic.AuthenticationError, 401)

    @cached_property
    def client(self) -> anthropic.Anthropic:
        return anthropic.Anthropic(api_key=self.key, base_url=self.url["anthropic"], max_retries=0)

    def text(self, model: str | None = None, **more: Any) -> str | None:
        source = {"type": "base64", "media_type": "image/png", "data": encode_base64(PICTURE)}
        shown = {"type": "image", "source": source}
        reply = self.client.messages.create(
            model=model or self.model,
            max_tokens=1000,
            messages=[{"role": "user", "content": [{"type": "text", "text": "Judge."}, shown, shown]}],
            output_config={"format": {"type": "json_schema", "schema": SCHEMA}},
            **more,
        )
        assert (reply.stop_reason, reply.usage.input_tokens) == ("end_turn", 70)
        return reply.content[0].text

    def listed(self) -> list[str]:
        models = self.client.models.list().data
        (ending,) = [model for model in models if model.lifecycle == "deprecated"]
        assert ending.retires_at is not None and ending.retires_at.year == 2026
        return [model.id for model in models]

    def one(self) -> str:
        return self.client.models.retrieve(self.model).id


SDKS = [Google, OpenAi, OpenRouter, Anthropic]


@pytest.mark.parametrize("sdk", SDKS)
def test_a_vendors_client_reads_text_that_keeps_the_schema(sdk: type[Any], server: ModelServer) -> None:
    assert Judgement.model_validate_json(sdk(server).text()).done == "no"


@pytest.mark.parametrize("sdk", [Google, OpenAi])
def test_a_vendors_client_reads_an_edited_picture(sdk: type[Any], server: ModelServer) -> None:
    height, width, _ = PICTURE.shape
    assert decode_base64(sdk(server).picture(), "x").shape == (height * 5 / 4, width * 5 / 4, 3)


@pytest.mark.parametrize("sdk", SDKS)
def test_a_vendors_client_lists_the_served_models(sdk: type[Any], server: ModelServer) -> None:
    assert sdk.model in sdk(server).listed()


@pytest.mark.parametrize("sdk", [Google, OpenAi, Anthropic])
def test_a_vendors_client_looks_at_one_model(sdk: type[Any], server: ModelServer) -> None:
    assert sdk(server).one() == sdk.model


@pytest.mark.parametrize("sdk", SDKS)
def test_a_vendors_client_takes_a_wrong_key_for_one(sdk: type[Any], server: ModelServer) -> None:
    kind, status = sdk.wrong_key
    with pytest.raises(kind) as caught:
        sdk(server, key="another-key").text()
    assert _status(caught.value) == status


@pytest.mark.parametrize(
    ("sdk", "kind", "status"),
    [
        (Google, errors.ClientError, 404),
        (OpenAi, openai.NotFoundError, 404),
        (OpenRouter, openai.BadRequestError, 400),
        (Anthropic, anthropic.NotFoundError, 404),
    ],
)
def test_a_vendors_client_takes_an_unknown_model_for_one(
    sdk: type[Any], kind: type[Exception], status: int, server: ModelServer
) -> None:
    with pytest.raises(kind, match="no-such-model") as caught:
        sdk(server).text(model="no-such-model")
    assert _status(caught.value) == status


FAILED = {
    Google: {402: errors.ClientError, 429: errors.ClientError, 500: errors.ServerError, 503: errors.ServerError},
    OpenAi: {403: openai.PermissionDeniedError, 429: openai.RateLimitError, 500: openai.InternalServerError},
    OpenRouter: {402: openai.APIStatusError, 429: openai.RateLimitError, 503: openai.InternalServerError},
    Anthropic: {
        403: anthropic.PermissionDeniedError,
        429: anthropic.RateLimitError,
        500: anthropic.InternalServerError,
        503: anthropic.InternalServerError,
    },
}


@pytest.mark.parametrize(("sdk", "status"), [(sdk, status) for sdk in FAILED for status in FAILED[sdk]])
def test_a_vendors_client_raises_its_own_error(sdk: type[Any], status: int, server: ModelServer) -> None:
    server.queue(Special(status=status))
    with pytest.raises(FAILED[sdk][status]) as caught:
        sdk(server).text()
    assert _status(caught.value) == status


def _status(error: Any) -> int:
    return error.code if isinstance(error, errors.APIError) else error.status_code


def test_a_block_by_openai_is_reported_with_its_code(server: ModelServer) -> None:
    server.queue(Special(blocked=True))
    with pytest.raises(openai.BadRequestError) as caught:
        OpenAi(server).picture()
    assert caught.value.code == "moderation_blocked"


def test_a_block_by_gemini_is_reported_beside_no_candidate(server: ModelServer) -> None:
    server.queue(Special(blocked=True))
    config = types.GenerateContentConfig(response_mime_type="application/json", response_json_schema=SCHEMA)
    sdk = Google(server)
    reply = sdk.client.models.generate_content(model=sdk.model, contents=["Judge."], config=config)
    assert reply.prompt_feedback.block_reason == "PROHIBITED_CONTENT" and reply.text is None


@pytest.mark.parametrize("deprecated", ["temperature", "top_p", "top_k"])
def test_gemini_takes_no_deprecated_parameter(deprecated: str, server: ModelServer) -> None:
    with pytest.raises(errors.ClientError, match="generation_config"):
        Google(server).text(**{deprecated: 1})


# --- what is taken -------------------------------------------------------------------------------------


def test_every_used_parameter_is_one_of_the_vendors_own() -> None:
    chat = {name for kind in get_args(completion_create_params.CompletionCreateParams) for name in get_type_hints(kind)}
    edit = {name for kind in get_args(image_edit_params.ImageEditParams) for name in get_type_hints(kind)}
    said = {name for kind in get_args(message_create_params.MessageCreateParams) for name in get_type_hints(kind)}
    assert chat >= openai_service.CHAT and edit >= openai_service.EDIT and said >= anthropic_service.PARAMETERS


def gemini_body(**config: Any) -> dict[str, Any]:
    form = {"responseMimeType": "application/json", "responseJsonSchema": SCHEMA, **config}
    return {"contents": [{"role": "user", "parts": [{"text": "Judge."}]}], "generationConfig": form}


def openai_body(**changes: Any) -> dict[str, Any]:
    return {
        "model": "gpt-6.1-terra",
        "messages": [{"role": "user", "content": "Hi"}],
        "response_format": FORM,
        **changes,
    }


def anthropic_body(**changes: Any) -> dict[str, Any]:
    form = {"format": {"type": "json_schema", "schema": SCHEMA}}
    messages = [{"role": "user", "content": "Hi"}]
    return {"model": "claude-opus-5", "max_tokens": 9, "messages": messages, "output_config": form, **changes}


def images_body(**changes: Any) -> dict[str, Any]:
    source = {"type": "image_url", "image_url": {"url": data_url(PICTURE)}}
    return {"model": "google/gemini-nano-banana-2.1", "prompt": "Edit it.", "input_references": [source], **changes}


def in_openai(schema: dict[str, Any]) -> dict[str, Any]:
    return {"type": "json_schema", "json_schema": {"name": "answer", "strict": True, "schema": schema}}


def in_anthropic(schema: dict[str, Any]) -> dict[str, Any]:
    return {"format": {"type": "json_schema", "schema": schema}}


def with_field(**field: Any) -> dict[str, Any]:
    return {"type": "object", "properties": {"x": field}, "required": ["x"], "additionalProperties": False}


PATHS = {
    "gemini": "/v1beta/models/gemini-pro-latest:generateContent",
    "openai": "/chat/completions",
    "openrouter": "/images",
    "anthropic": "/v1/messages",
}


def sent(server: ModelServer, service: str, body: Any, **headers: str) -> requests.Response:
    own = {
        "gemini": {"x-goog-api-key": server.key},
        "anthropic": {"x-api-key": server.key, "anthropic-version": "2023-06-01"},
    }.get(service, {"Authorization": f"Bearer {server.key}"})
    data = body if isinstance(body, bytes) else json.dumps(body).encode()
    own |= {"Content-Type": "application/json", **headers}
    return requests.post(server.base_urls[service] + PATHS[service], data=data, headers=own, timeout=20)


@pytest.mark.parametrize(
    ("service", "body", "said"),
    [
        ("gemini", gemini_body(topK=3), "unknown or unsupported topK"),
        ("gemini", gemini_body(responseJsonSchema=with_field(enum=["a", ""])), "empty string"),
        ("gemini", gemini_body(responseJsonSchema=with_field(enum=[f"a{n}" for n in range(61)])), "too many states"),
        ("gemini", gemini_body(responseModalities=["IMAGE"]), "does not support"),
        ("gemini", {**gemini_body(), "contents": []}, "contents is not specified"),
        ("openai", openai_body(temperature=1), "unknown or unsupported temperature"),
        ("openai", openai_body(response_format=in_openai({**SCHEMA, "required": []})), "'required' must include"),
        (
            "openai",
            openai_body(response_format=in_openai({**SCHEMA, "additionalProperties": True})),
            "'additionalProperties' is required",
        ),
        ("openai", openai_body(response_format=in_openai(with_field(enum=["a" * 61] * 251))), "enum is too long"),
        (
            "openai",
            openai_body(messages=[{"role": "user", "content": [{"type": "image_url", "image_url": {"url": "x"}}]}]),
            "no data URL",
        ),
        ("openrouter", images_body(strength=1), "unknown or unsupported strength"),
        ("openrouter", images_body(input_references=[]), "input_references"),
        ("anthropic", anthropic_body(temperature=1), "unknown or unsupported temperature"),
        ("anthropic", {**anthropic_body(), "max_tokens": None}, "max_tokens"),
        (
            "anthropic",
            anthropic_body(output_config=in_anthropic(with_field(type="string", minLength=1))),
            "minLength not supported",
        ),
        ("anthropic", anthropic_body(output_config=in_anthropic(with_field(minimum=1))), "minimum not supported"),
    ],
)
def test_a_request_that_a_service_would_not_take_is_400(
    service: str, body: Any, said: str, server: ModelServer
) -> None:
    answered = sent(server, service, body)
    assert answered.status_code == 400 and said in answered.json()["error"]["message"]


@pytest.mark.parametrize(
    ("service", "body"),
    [
        ("gemini", gemini_body()),
        ("openai", openai_body()),
        ("openrouter", images_body()),
        ("anthropic", anthropic_body()),
    ],
)
def test_a_right_request_needs_the_key_in_the_services_own_header(service: str, body: Any, server: ModelServer) -> None:
    assert sent(server, service, body).status_code == 200
    missing = {"x-goog-api-key": "", "x-api-key": "", "Authorization": ""}
    assert sent(server, service, body, **missing).status_code in (401, 403)


def test_a_picture_that_does_not_decode_or_is_of_another_type_is_400(server: ModelServer) -> None:
    png = encode_base64(PICTURE)
    for url, said in ((f"data:image/jpeg;base64,{png}", "is image/png"), ("data:image/png;base64,AAAA", "is None")):
        body = images_body(input_references=[{"type": "image_url", "image_url": {"url": url}}])
        answered = sent(server, "openrouter", body)
        assert answered.status_code == 400 and said in answered.text


def test_a_request_of_another_type_or_too_large_is_refused(server: ModelServer) -> None:
    assert sent(server, "openai", openai_body(), **{"Content-Type": "text/plain"}).status_code == 415
    assert sent(server, "gemini", b" " * (MOST_BYTES + 1)).status_code == 413


def test_pictures_of_openrouter_come_with_their_type_and_cost(server: ModelServer) -> None:
    reply = sent(server, "openrouter", images_body()).json()
    assert decode_base64(reply["data"][0]["b64_json"], "x").shape[2] == 3
    assert reply["data"][0]["media_type"] == "image/png" and reply["usage"]["cost"] > 0


# --- by hand -------------------------------------------------------------------------------------------


def test_the_log_has_a_line_for_each_request_and_no_key(server: ModelServer) -> None:
    lines: list[str] = []
    with ModelServer(log=lines.append) as logging:
        sent(logging, "openai", openai_body())
        requests.get(f"{logging.url}/v1beta/models?key={logging.key}", timeout=20)
    assert len(lines) == 2 and "openai POST /v1/chat/completions" in lines[0] and ": 200, " in lines[0]
    assert not any(logging.key in line for line in lines)


def test_the_same_seed_draws_the_same_faults_for_its_share() -> None:
    drawn = [[faults.draw() for _ in range(1000)] for faults in map(partial(Faults, 0.2), (1, 1, 2))]
    assert drawn[0] == drawn[1] != drawn[2]
    assert 150 < sum(fault is not None for fault in drawn[0]) < 250


def test_started_by_hand_it_prints_the_variables_to_set() -> None:
    line = [sys.executable, "-m", "tests.model_server", "--key", "another-key", "--faults", "0.2", "--seed", "1"]
    with subprocess.Popen(line, stdout=subprocess.PIPE, text=True) as running:
        exported = dict(running.stdout.readline().split()[1].split("=") for _ in range(9))
        url = exported["VCAGE_ANTHROPIC_BASE_URL"]
        listed = requests.get(
            f"{url}/v1/models",
            headers={"x-api-key": exported["VCAGE_ANTHROPIC_API_KEY"], "anthropic-version": "2023-06-01"},
            timeout=20,
        )
        running.terminate()
    assert url.startswith("http://127.0.0.1:") and listed.json()["data"]


def test_the_stand_in_answers_without_our_rules() -> None:
    asked = (
        "import sys, tests.model_server.answers; print([n for n in sys.modules if n.startswith('vcage.models.rules')])"
    )
    found = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True)
    assert found.stdout == "[]\n", found.stderr


def test_an_instruction_that_no_table_holds_is_named() -> None:
    with pytest.raises(Refused, match="neither objects nor missing of 'Sing a song'"):
        answer_question({"properties": {"objects": {}}}, "# The task\nSing a song\n", [])
