"""The whole validation: counted, written, taken up again; a bad object fails and does not stop the others."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import vcage
from vcage.apps.proof.prove import METHOD, Prover, Trial, proof_or_failure, validate
from vcage.base.errors import InputFileError, UnknownName
from vcage.objects.library import Library
from vcage.schema.proof import ObjectProof, Proof

QUICK = Trial(quick=True)


@pytest.fixture(scope="module")
def proven(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Proof]:
    folder = tmp_path_factory.mktemp("proof")
    return folder, validate(["block", "soap_bar"], folder, QUICK)


@pytest.mark.slow
def test_the_counts_match_the_annotations(proven) -> None:
    _, proof = proven
    annotations = [Library.load().annotation(name) for name in ("block", "soap_bar")]
    assert (proof.objects, proof.variants) == (2, 2)
    assert proof.contact_points == sum(len(a.contact_points) for a in annotations)
    assert proof.functional_points == sum(len(a.functional_points) for a in annotations)
    assert proof.tries == 3 * (proof.contact_points + proof.functional_points)
    assert proof.failed == []


@pytest.mark.slow
def test_the_proof_is_written(proven) -> None:
    folder, proof = proven
    assert Proof.read(folder / "proof.json") == proof


def test_proven_variants_are_not_tried_again(proven, monkeypatch: pytest.MonkeyPatch) -> None:
    folder, proof = proven
    monkeypatch.setattr(Prover, "prove", lambda *_: pytest.fail("tried again"))
    assert validate(["block", "soap_bar"], folder, QUICK) == proof


def test_a_proof_with_another_key_is_made_again(proven, monkeypatch: pytest.MonkeyPatch) -> None:
    folder, proof = proven
    path = folder / "objects" / "block.json"
    block, tried = ObjectProof.read(path), []
    monkeypatch.setattr(Prover, "prove", lambda _, name: (tried.append(name), block)[1])
    path.write_text(json.dumps({**json.loads(path.read_text()), "key": "another"}))
    assert validate(["block", "soap_bar"], folder, QUICK) == proof
    assert tried == ["block"]
    assert ObjectProof.read(path) == block


@pytest.mark.parametrize("trial", [Trial(quick=True, seed=1), Trial(quick=False)])
def test_the_key_of_a_proof_holds_how_it_was_tried(trial: Trial) -> None:
    library = Library.load()
    assert Prover(library, trial).key("block") != Prover(library, QUICK).key("block")
    assert Prover(library, QUICK).key("block") == Prover(library, QUICK).key("block")


def test_the_key_of_a_proof_holds_every_module_that_tries_an_object() -> None:
    package = Path(vcage.__file__).parent
    assert all(list((package / folder).glob("*.py")) for folder in METHOD)
    deciding = {path.parent for room in ("apps/proof", "sim", "tasks") for path in (package / room).rglob("*.py")}
    robots_of_others = package / "sim" / "robotwin"
    assert deciding - {robots_of_others} <= {package / folder for folder in METHOD}


@pytest.mark.slow
def test_two_processes_find_the_same(proven, tmp_path: Path) -> None:
    _, proof = proven
    assert validate(["block", "soap_bar"], tmp_path, QUICK, workers=2) == proof


def test_an_unknown_name_is_refused_before_anything_is_tried(tmp_path: Path) -> None:
    with pytest.raises(UnknownName, match="blok"):
        validate(["block", "blok"], tmp_path / "proof", QUICK)
    assert not (tmp_path / "proof").exists()


def test_an_object_that_cannot_be_loaded_fails_with_the_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_args: object) -> None:
        raise InputFileError("block/asset.json: field contact_points.0.position: outside the object")

    prover = Prover(Library.load(), QUICK)
    monkeypatch.setattr(prover.library, "asset", broken)
    proof = proof_or_failure(prover, "block")
    assert proof.variants[0].failed == ["block/red: mesh"]
    assert "contact_points.0.position" in proof.variants[0].checks[0].reasons[0]
