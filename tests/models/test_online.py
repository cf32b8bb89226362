"""Both wire shapes, against the loopback stand-in: every role, and what servers do besides answering well."""

from __future__ import annotations

import base64
import json
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from tests.layout.items import capacity
from tests.model_server import ModelServer, Special, no_picture, raw_answer, text_answer
from tests.models.catalogue import CATALOGUE, unchecked
from tests.models.scripted import chosen as chosen_as
from tests.models.scripted import goal, read, selected
from tests.models.tabletop import BLOCKS, BOX, MARKERS, PLATE, draw, scene_of, table_picture
from tests.models.tabletop import critic_question as asked
from vcage.base.errors import (
    ConfigurationError,
    EndpointFailed,
    MissingKey,
    ModelRefused,
    NoAssetFits,
    UnknownName,
    UnreadInstruction,
)
from vcage.layout.capacities import size_complaints
from vcage.models import pictures
from vcage.models.checked_reading import Instructed
from vcage.models.exchanges import Exchanges
from vcage.models.pictures import encode_base64
from vcage.models.protocols import CriticQuestion, EditRequest, Models
from vcage.models.registry import Choice, build_models
from vcage.models.selection_check import validate_selection
from vcage.models.wordings import TaskToWord
from vcage.plans.check import plan_complaints
from vcage.schema.goals import AskedGoal, Goal
from vcage.schema.plan import LayoutPlan, Relation
from vcage.schema.subtasks import PairQuestion

RNG = np.random.default_rng(0)
PROVIDERS = ("gemini", "openai", "openrouter")
TEXT_PROVIDERS = ("gemini", "openai", "anthropic")


def build(provider: str, server: ModelServer, monkeypatch: pytest.MonkeyPatch) -> Models:
    monkeypatch.setenv(f"VCAGE_{provider.upper()}_API_KEY", server.key)
    monkeypatch.setenv(f"VCAGE_{provider.upper()}_BASE_URL", server.base_urls[provider])
    return build_models(Choice(provider))


@pytest.fixture(params=TEXT_PROVIDERS)
def models(request: pytest.FixtureRequest, server: ModelServer, monkeypatch: pytest.MonkeyPatch) -> Models:
    return build(request.param, server, monkeypatch)


@pytest.fixture(params=PROVIDERS)
def editing(request: pytest.FixtureRequest, server: ModelServer, monkeypatch: pytest.MonkeyPatch) -> Models:
    return build(request.param, server, monkeypatch)


def edit_request() -> EditRequest:
    things = [PLATE, *BLOCKS]
    picture, ids = draw(things)
    relation = Relation(subject="plate", relation="center", reference="table")
    return EditRequest(picture, table_picture(), ids, scene_of(things), LayoutPlan(text="…", relations=[relation]))


def critic_question(moved: bool) -> CriticQuestion:
    before = [BOX, *MARKERS]
    after = [BOX, MARKERS[0].moved(at=BOX.at, base=0.005), *MARKERS[1:]] if moved else before
    goal = Goal(subject="black-marker", relation="inside", reference="box")
    return asked(before, after, goal, "Put the black marker into the box.")


def test_the_provider_names_the_model(models: Models) -> None:
    assert models.providers("reasoner", "critic")["reasoner"].split(":")[0] in TEXT_PROVIDERS
    assert models.detector.provider == models.embedder.provider == "offline"


def test_selection_names_assets_of_the_catalogue(models: Models) -> None:
    chosen = models.reasoner.select_assets("Put the blocks on the plate", CATALOGUE, RNG, unchecked).objects
    assert [(o.asset, o.role) for o in chosen if o.role != "context"] == [("block", "content")] * 3 + [
        ("plate", "receptacle")
    ]


def test_an_object_the_model_misses_is_no_asset_fits(models: Models) -> None:
    with pytest.raises(NoAssetFits, match="helicopter"):
        models.reasoner.select_assets("Fly the helicopter to the moon", CATALOGUE, RNG, unchecked)


def test_a_layout_mentions_every_object(models: Models) -> None:
    scene = scene_of([PLATE, *BLOCKS])
    plan = models.reasoner.plan_layout(scene, CATALOGUE, RNG, partial(plan_complaints, scene=scene))
    assert {r.subject for r in plan.relations} == {o.id for o in scene.objects}


def layout_answer(*triples: tuple[str, str, str]) -> Special:
    relations = [{"subject": s, "relation": r, "reference": o} for s, r, o in triples]
    return text_answer(json.dumps({"text": "x", "relations": relations}))


AROUND = scene_of([PLATE, *BLOCKS])
RED_AROUND = [("plate", "center", "table"), ("green-block", "left_of", "plate"), ("blue-block", "behind", "plate")]


@pytest.mark.parametrize(
    ("triples", "complaint"),
    [
        ([*RED_AROUND, ("red-block", "near", "red-block")], "red-block is near itself"),
        ([*RED_AROUND, ("red-block", "center", "table")], "plate and red-block cannot both be in the center of table"),
        (
            [*RED_AROUND, ("red-block", "left_of", "green-block"), ("red-block", "right_of", "plate")],
            "green-block left of plate left of red-block left of green-block: that is a circle",
        ),
        (RED_AROUND, "nothing says where red-block go"),
        ([], "relations: is empty"),
    ],
)
def test_a_contradictory_layout_goes_back_with_the_complaint(
    models: Models, server: ModelServer, triples: list[tuple[str, str, str]], complaint: str
) -> None:
    right = [*RED_AROUND, ("red-block", "in_front_of", "plate")]
    server.queue(layout_answer(*triples), layout_answer(*right))
    plan = models.reasoner.plan_layout(AROUND, CATALOGUE, RNG, partial(plan_complaints, scene=AROUND))
    assert [(r.subject, r.relation, r.reference) for r in plan.relations] == right
    assert len(server.requests) == 2 and complaint in str(server.requests[1])


def test_an_object_too_large_goes_back_with_both_sizes(models: Models, server: ModelServer) -> None:
    scene = scene_of([PLATE, *BLOCKS])
    rooms = {"plate": capacity(PLATE.size, "on", (0.03, 0.03)), "red-block": capacity(BLOCKS[0].size)}
    server.queue(layout_answer(*RED_AROUND, ("red-block", "on", "plate")))
    models.reasoner.plan_layout(
        scene, CATALOGUE, RNG, partial(plan_complaints, scene=scene, sizes=partial(size_complaints, items=rooms))
    )
    complaint = "red-block (4.0 x 4.0 cm) is too large for plate, which has room for 3.0 x 3.0 cm"
    assert len(server.requests) == 2 and complaint in str(server.requests[1])


def test_a_layout_that_never_becomes_possible_is_a_refusal_with_the_complaints(
    models: Models, server: ModelServer
) -> None:
    wrong = layout_answer(*RED_AROUND, ("red-block", "inside", "green-block"), ("green-block", "inside", "red-block"))
    server.queue(wrong, wrong, wrong)
    with pytest.raises(ModelRefused, match="green-block inside or on red-block inside or on green-block") as caught:
        models.reasoner.plan_layout(AROUND, CATALOGUE, RNG, partial(plan_complaints, scene=AROUND))
    assert len(server.requests) == 3 and caught.value.details["problems"]


def test_a_selection_states_the_starting_containers(models: Models, server: ModelServer) -> None:
    apple, bowl = chosen_as("apple/red", "content", "bowl"), chosen_as("bowl/white", "context")
    server.queue(text_answer(json.dumps({"missing": [], "objects": [apple, bowl]})))
    chosen = models.reasoner.select_assets("Take the apple out of the bowl", CATALOGUE, RNG, unchecked)
    assert [(o.asset, o.starts_in) for o in chosen.objects] == [("apple", "bowl"), ("bowl", None)]


def test_a_start_in_an_unchosen_container_goes_back(models: Models, server: ModelServer) -> None:
    apple = chosen_as("apple/red", "content", "bowl")
    server.queue(text_answer(json.dumps({"missing": [], "objects": [apple]})))
    models.reasoner.select_assets("Put the blocks on the plate", CATALOGUE, RNG, unchecked)
    assert "apple starts in 'bowl', which is not another chosen object" in str(server.requests[1])


def chosen_answer(*chosen: tuple[str, str, str]) -> Special:
    return text_answer(json.dumps(selected(*(chosen_as(*one) for one in chosen))))


def test_starts_that_run_in_a_circle_go_back(models: Models, server: ModelServer) -> None:
    server.queue(chosen_answer(("bowl/white", "content", "mug"), ("mug/red", "context", "bowl")))
    models.reasoner.select_assets("Put the blocks on the plate", CATALOGUE, RNG, unchecked)
    assert "bowl starts in mug starts in bowl: that is a circle" in str(server.requests[1])


def test_objections_to_a_selection_go_back(models: Models, server: ModelServer) -> None:
    wrong = chosen_answer(("apple/red", "content", "stapler"), ("stapler/black", "context", "none"))
    right = chosen_answer(("apple/red", "content", "bowl"), ("bowl/white", "context", "none"))
    server.queue(wrong, right)
    check = partial(validate_selection, entries=CATALOGUE)
    chosen = models.reasoner.select_assets("Take the apple out of the bowl", CATALOGUE, RNG, check)
    assert "apple cannot start in or on stapler, which has no room for things" in str(server.requests[1])
    assert chosen.objects[0].starts_in == "bowl"
    server.queue(wrong, wrong, wrong)
    with pytest.raises(ModelRefused, match="no room for things"):
        models.reasoner.select_assets("Take the apple out of the bowl", CATALOGUE, RNG, check)


def test_pairs_are_answered_in_order(models: Models) -> None:
    sizes = {"object_size": (0.1, 0.02, 0.02), "opening_size": (0.2, 0.2, 0.1)}
    questions = [
        PairQuestion(object="m", object_words="marker pen", receptacle=r, receptacle_words=words, holds="in", **sizes)
        for r, words in (("s", "stapler"), ("b", "packaging box"))
    ]
    answers = models.reasoner.judge_pairs(questions)
    assert [(a.receptacle, a.sensible) for a in answers] == [("s", False), ("b", True)]


THINGS = {
    kind.name: kind.model_copy(update={"variants": kind.variants[:1]})
    for kind in CATALOGUE
    if kind.name in ("block", "plate", "mug")
}


def test_goals_name_objects_and_the_words_that_they_answer(models: Models) -> None:
    (asked,) = models.reasoner.read_goals(Instructed("Put the red block on the plate", THINGS)).goals
    assert asked.goal == Goal(subject="block", relation="on", reference="plate")
    assert asked.words == "Put the red block on the plate"


def test_words_the_model_could_not_read_are_refused(models: Models) -> None:
    with pytest.raises(UnreadInstruction, match="stir the soup"):
        models.reasoner.read_goals(Instructed("Put the block on the plate and stir the soup", THINGS))


def test_a_goal_in_words_that_the_instruction_has_not_goes_back_to_the_model(
    models: Models, server: ModelServer
) -> None:
    wrong = text_answer(json.dumps(read(goal("block", "on", "plate", words="block up"))))
    server.queue(wrong)
    models.reasoner.read_goals(Instructed("Put the red block on the plate", THINGS))
    assert "words are not copied from the instruction" in str(server.requests[1])


def test_task_sentences_pass_the_review(models: Models, server: ModelServer) -> None:
    goal = AskedGoal(goal=Goal(subject="block", relation="on", reference="plate"), step=1, words="it")
    phrases = {"block": "red block", "plate": "white plate", "mug": "white mug"}
    task = TaskToWord("Put the block on the plate", [goal], [], [], THINGS, phrases, {}, [], CATALOGUE)
    wrong, right = "Put the mug on the plate.", "Set the block down on the plate."
    server.queue(text_answer(json.dumps({"sentences": [{"sentence": wrong}, {"sentence": right}]})))
    assert models.reasoner.word_task(task, []) == ([right], 1)


@pytest.mark.parametrize("moved", [True, False])
def test_the_critic_looks_at_the_pictures(models: Models, moved: bool) -> None:
    assert models.critic.judge(critic_question(moved)).accepted is moved


def test_a_fenced_answer_is_read(models: Models, server: ModelServer) -> None:
    said = {"observations": "", "done": "yes", "failure": "none", "also_moved": [], "reason": "in", "confidence": 1}
    answer = json.dumps(said)
    server.queue(text_answer(f"```json\n{answer}\n```"))
    assert models.critic.judge(critic_question(True)).reason == "in"


@pytest.mark.parametrize("finish", ["MAX_TOKENS", "SAFETY", "content_filter"])
def test_an_answer_that_was_cut_off_is_a_refusal(models: Models, server: ModelServer, finish: str) -> None:
    server.queue(text_answer("" if finish == "SAFETY" else '{"obs', finish))
    with pytest.raises(ModelRefused):
        models.critic.judge(critic_question(True))


def test_a_refusal_of_openai_is_a_refusal(server: ModelServer, monkeypatch: pytest.MonkeyPatch) -> None:
    server.queue(Special(refusal="I will not."))
    with pytest.raises(ModelRefused, match="I will not"):
        build("openai", server, monkeypatch).critic.judge(critic_question(True))


def test_a_wrong_key_is_a_configuration_error(server: ModelServer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server, "key", "another-key-entirely")
    models = build("gemini", server, monkeypatch)
    monkeypatch.setattr(server, "key", "the-right-key-now")
    with pytest.raises(ConfigurationError, match="key"):
        models.critic.judge(critic_question(True))


def test_the_edited_picture_may_have_another_size(editing: Models) -> None:
    assert editing.editor.rearrange(edit_request()).shape == (600, 800, 3)


def test_an_answer_without_a_picture_is_asked_again_by_gemini(
    server: ModelServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    server.queue(no_picture())
    assert build("gemini", server, monkeypatch).editor.rearrange(edit_request()).shape == (600, 800, 3)
    assert len(server.requests) == 2


def test_a_safety_block_is_final(server: ModelServer, monkeypatch: pytest.MonkeyPatch) -> None:
    server.queue(no_picture("IMAGE_SAFETY"))
    with pytest.raises(ModelRefused, match="IMAGE_SAFETY"):
        build("gemini", server, monkeypatch).editor.rearrange(edit_request())
    assert len(server.requests) == 1


def test_no_picture_at_all_is_a_refusal(editing: Models, server: ModelServer) -> None:
    server.queue(*[no_picture()] * 3)
    with pytest.raises(ModelRefused, match="drew no picture"):
        editing.editor.rearrange(edit_request())


@pytest.mark.parametrize("data", ["AAAA", "%%%", base64.b64encode(b"no picture").decode()])
def test_a_picture_that_cannot_be_decoded_is_an_endpoint_failure(
    editing: Models, server: ModelServer, data: str
) -> None:
    server.queue(Special(picture=data))
    with pytest.raises(EndpointFailed, match="picture"):
        editing.editor.rearrange(edit_request())


def test_both_base64_alphabets_are_read() -> None:
    picture = np.random.default_rng(0).integers(0, 255, (91, 77, 3), dtype=np.uint8)
    url_safe = base64.urlsafe_b64encode(pictures.encode_png(picture)).decode().rstrip("=")
    assert np.array_equal(pictures.decode_base64(url_safe, "x"), picture)


def test_a_reply_without_text_is_no_picture() -> None:
    with pytest.raises(EndpointFailed, match="sent dict for a picture"):
        pictures.decode_base64({"b64_json": ""}, "x")


def test_auto_takes_the_provider_with_a_key_or_else_offline(monkeypatch: pytest.MonkeyPatch) -> None:
    assert build_models(Choice("auto")).reasoner.provider == "offline"
    monkeypatch.setenv("OPENROUTER_API_KEY", "key-1")
    assert build_models(Choice("auto")).reasoner.provider.startswith("openrouter:")
    monkeypatch.setenv("GEMINI_API_KEY", "key-2")
    assert build_models(Choice("auto")).reasoner.provider.startswith("gemini:")


def test_an_online_choice_without_a_key_says_so() -> None:
    with pytest.raises(MissingKey, match="no key for gemini"):
        build_models(Choice("gemini"))


def test_an_unknown_choice_is_named() -> None:
    with pytest.raises(UnknownName, match="clippy"):
        build_models(Choice("clippy"))


# --- kept in a run -------------------------------------------------------------------------------------


@pytest.fixture
def kept(editing: Models, tmp_path: Path) -> Models:
    """The same provider, in a run."""
    return build_models(Choice(editing.editor.provider.partition(":")[0], run=tmp_path))


def test_stored_exchanges_of_a_run_hold_no_key(kept: Models, server: ModelServer, tmp_path: Path) -> None:
    kept.reasoner.select_assets("Put the blocks on the plate", CATALOGUE, RNG, unchecked)
    kept.editor.rearrange(edit_request())
    kept.critic.judge(critic_question(moved=True))
    files = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert {path.suffix for path in files} == {".json", ".png"}
    assert not any(server.key.encode() in path.read_bytes() for path in files)


def test_a_run_that_asks_the_same_again_sends_nothing(kept: Models, server: ModelServer, tmp_path: Path) -> None:
    first = kept.editor.rearrange(edit_request())
    sent = len(server.requests)
    assert np.array_equal(kept.editor.rearrange(edit_request()), first)
    assert len(server.requests) == sent


def test_a_picture_that_is_no_edit_of_the_source_is_requested_again_with_the_reason(
    kept: Models, server: ModelServer, tmp_path: Path
) -> None:
    other = np.random.default_rng(1).integers(0, 255, edit_request().picture.shape, np.uint8)
    server.queue(Special(picture=encode_base64(other)))
    kept.editor.rearrange(edit_request())
    asked = Exchanges(tmp_path / "exchanges").all()
    assert [exchange.round for exchange in asked] == [1, 2]
    assert "shows the table that was there" in asked[1].turns[-1].text


VERSIONS = {
    "gemini:gemini-pro-latest": "gemini-4-argon",
    "openai:gpt-6.1-terra": "gpt-6.1-terra-2026-10-01",
    "openrouter:~google/gemini-pro-latest": "google/gemini-4-argon",
}


def test_an_exchange_names_the_version_and_the_tokens_of_the_reply(
    kept: Models, server: ModelServer, tmp_path: Path
) -> None:
    kept.critic.judge(critic_question(moved=True))
    (asked,) = Exchanges(tmp_path / "exchanges").all()
    assert asked.model == VERSIONS[kept.critic.provider]
    assert (asked.tokens_in, asked.tokens_out) == (70, 7)


@pytest.mark.parametrize("feedback", [1, "blocked", [1], True])
def test_an_answer_of_gemini_in_another_shape_is_an_endpoint_failure(
    server: ModelServer, monkeypatch: pytest.MonkeyPatch, feedback: object
) -> None:
    server.queue(raw_answer(json.dumps({"promptFeedback": feedback}).encode()))
    with pytest.raises(EndpointFailed, match="unknown shape"):
        build("gemini", server, monkeypatch).critic.judge(critic_question(True))
