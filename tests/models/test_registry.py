from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from vcage.base.errors import InputFileError, MissingDependency, UnknownName, UsageError
from vcage.models.registry import Choice, build_detector, build_embedder, build_models, split_weights
from vcage.models.transport import Transport
from vcage.vision.detector import BackgroundDetector
from vcage.vision.embedder import ClassicalEmbedder
from vcage.vision.networks import loading


def test_the_defaults_need_no_weights() -> None:
    models = build_models(Choice("offline"))
    assert isinstance(models.detector, BackgroundDetector) and isinstance(models.embedder, ClassicalEmbedder)


def test_keys_are_looked_for_where_opencv_is_not_installed() -> None:
    asked = "import sys; sys.modules['cv2'] = None; from vcage.models.providers import found_keys; print(found_keys())"
    found = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True)
    assert found.stdout == "{}\n", found.stderr


@pytest.mark.parametrize(
    ("spelled", "parts"),
    [
        ("background", ("background", None)),
        ("dinov2:", ("dinov2", None)),
        ("dinov2:facebook/dinov2-base", ("dinov2", "facebook/dinov2-base")),
        ("grounding-dino:/a/b:c", ("grounding-dino", "/a/b:c")),
    ],
)
def test_weights_stand_after_the_first_colon(spelled: str, parts: tuple) -> None:
    assert split_weights(spelled) == parts


def test_an_unknown_name_is_refused_with_the_known_ones() -> None:
    with pytest.raises(UnknownName, match="background, grounding-dino"):
        build_models(Choice("offline"), detector="yolo")
    with pytest.raises(UnknownName, match="classical, dinov2, efficientnet"):
        build_models(Choice("offline"), embedder="clip")


def test_weights_for_an_unweighted_choice_are_refused() -> None:
    with pytest.raises(UsageError, match="background has no weights"):
        build_detector("background", "somewhere")
    with pytest.raises(UsageError, match="classical has no weights"):
        build_embedder("classical", "somewhere")


@pytest.mark.parametrize("name", ["dinov2", "grounding-dino"])
def test_without_transformers_the_extra_is_named(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loading.importlib.util, "find_spec", lambda module: None)
    build = build_embedder if name == "dinov2" else build_detector
    with pytest.raises(MissingDependency) as caught:
        build(name)
    assert "vcage[vision]" in caught.value.command


def test_without_its_packages_efficientnet_names_the_command_that_installs_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(loading.importlib.util, "find_spec", lambda module: None)
    with pytest.raises(MissingDependency) as caught:
        build_embedder("efficientnet")
    assert caught.value.command.endswith("vcage setup efficientnet")


def test_a_missing_folder_is_no_hub_id(tmp_path: Path) -> None:
    pytest.importorskip("transformers")
    with pytest.raises(InputFileError, match="neither a folder"):
        build_embedder("dinov2", str(tmp_path / "nowhere"))


def test_a_folder_without_a_model_is_refused_at_once(tmp_path: Path) -> None:
    pytest.importorskip("transformers")
    with pytest.raises(InputFileError, match="holds no model"):
        build_detector("grounding-dino", str(tmp_path))


def test_hub_weights_are_named_in_full_without_being_read() -> None:
    pytest.importorskip("transformers")
    models = build_models(Choice("offline"), "grounding-dino:someone/large", "dinov2")
    assert models.providers("detector", "embedder") == {
        "detector": "grounding-dino:someone/large",
        "embedder": "dinov2:facebook/dinov2-small",
    }


# --- who plays which role ----------------------------------------------------------------------------------


def test_auto_reports_the_chosen_provider_and_why(monkeypatch: pytest.MonkeyPatch) -> None:
    roles = ("reasoner", "editor", "critic")
    assert "rules (offline) for reasoner, editor, critic, since there is no key" in Choice("auto").announcement(roles)
    monkeypatch.setenv("OPENROUTER_API_KEY", "key-1")
    monkeypatch.setenv("ANTHROPIC_API_KEY", "key-2")
    told = Choice("auto", critic="offline").announcement(roles)
    assert "openrouter for reasoner, editor, since its key is in OPENROUTER_API_KEY; anthropic too" in told
    assert "key-" not in told
    assert (
        Choice("offline").announcement(roles)
        == Choice("gemini").announcement(roles)
        == Choice("auto").announcement(())
        == ""
    )


def test_a_provider_without_images_leaves_drawing_to_rules_unless_named(monkeypatch: pytest.MonkeyPatch) -> None:
    assert Choice("anthropic").of("editor") == Choice("agent").of("editor") == "offline"
    for name in ("anthropic", "agent"):
        with pytest.raises(UsageError, match=f"{name} does not draw") as caught:
            Choice(editor=name).of("editor")
        assert caught.value.command.endswith("vcage inpaint-plan --help")


def test_a_key_of_a_provider_without_images_leaves_drawing_to_rules(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ANTHROPIC_API_KEY", "key-1")
    roles = ("reasoner", "editor", "critic")
    assert [Choice("auto").of(role) for role in roles] == ["anthropic", "offline", "anthropic"]
    assert "anthropic for reasoner, critic, rules (offline) for editor" in Choice("auto").announcement(roles)


@pytest.fixture
def lists(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The ids that a Gemini endpoint lists; nothing is sent."""
    ids: list[str] = []
    monkeypatch.setenv("GEMINI_API_KEY", "key-1")
    monkeypatch.setattr(Transport, "get_json", lambda *_: {"models": [{"name": f"models/{name}"} for name in ids]})
    return ids


def test_a_role_with_an_unserved_model_falls_back_on_rules_only_on_request(
    lists: list[str], caplog: pytest.LogCaptureFixture
) -> None:
    lists.append("gemini-pro-latest")
    assert build_models(Choice("gemini")).editor.provider == "gemini:gemini-nano-banana-2.1"
    models = build_models(Choice("gemini", fallback="offline"))
    assert models.providers("reasoner", "editor", "critic") == {
        "reasoner": "gemini:gemini-pro-latest", "editor": "offline", "critic": "gemini:gemini-pro-latest"
    }  # fmt: skip
    assert "gemini does not serve gemini-nano-banana-2.1; it serves gemini-pro-latest" in caplog.text
    assert "rules (offline) play the editor" in caplog.text
