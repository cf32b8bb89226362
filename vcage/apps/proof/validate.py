"""The validation of a library: objects in parallel processes, each proof stored as soon as it is finished."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import cache, partial
from pathlib import Path

from vcage.apps.proof.prove import Prover, Trial
from vcage.base.errors import InputFileError, VcageError
from vcage.base.files import RunFolder
from vcage.base.keeper import Keeper
from vcage.base.progress import Progress, silent
from vcage.base.workers import map_in_processes
from vcage.objects.library import Library
from vcage.schema.proof import ObjectProof, Proof, ProofCheck, VariantProof

PROOF = "proof.json"


def validate(
    names: Sequence[str],
    folder: Path,
    trial: Trial,
    *,
    workers: int = 1,
    force: bool = False,
    progress: Progress = silent,
) -> Proof:
    """Prove objects and write ``proof.json``; earlier proofs that still hold are reused.

    Args:
        names: of the objects; all of the library when empty.
        folder: for ``proof.json`` and ``objects/<name>.json``.
        trial: how they are tried.
        workers: processes.
        force: prove again what was proven.

    Raises:
        UnknownName: there is no such object.
        OutputFolderError: the folder cannot be written.
    """
    library = Library.load()
    names = list(dict.fromkeys(names)) or library.names
    for name in names:
        library.annotation(name)
    RunFolder(folder).make()
    prover = Prover(library, trial)
    proofs = {} if force else _kept(prover, names, folder)
    wanted = [name for name in names if name not in proofs]
    done = len(proofs)
    for name, proof in _proven(prover, wanted, workers):
        progress(name, done, len(names))
        done += 1
        proof.write(folder / "objects" / f"{name}.json")
        proofs[name] = proof
    proof = summary_of([variant for name in names for variant in proofs[name].variants], prover)
    proof.write(folder / PROOF)
    return proof


def summary_of(results: list[VariantProof], prover: Prover) -> Proof:
    """Count over all variants; tries that variants share count once."""
    checks = [check for result in results for check in result.checks]
    counts = Counter(check.check for check in checks)
    handles = sum(int(check.measured.get("handles", 0)) for check in checks)
    simulated = [check for result in results if result.same_as is None for check in result.checks]
    return Proof(
        robot=prover.places.template.robot,
        seed=prover.trial.seed,
        quick=prover.trial.quick,
        objects=len({result.asset for result in results}),
        variants=len(results),
        contact_points=counts["contact_point"] + handles,
        functional_points=counts["functional_point"],
        joints=counts["joint"],
        tries=sum(check.tries for check in simulated if check.check not in ("mesh", "rest")),
        failed=[failure for result in results for failure in result.failed],
        results=results,
    )


def _kept(prover: Prover, names: Sequence[str], folder: Path) -> dict[str, ObjectProof]:
    """Return earlier proofs that still hold."""
    kept = {}
    for name in names:
        with contextlib.suppress(InputFileError):  # an object that cannot be loaded is tried again, and that says why
            proof = Keeper(folder / "objects" / f"{name}.json", ObjectProof, prover.key(name)).kept()
            if proof is not None:
                kept[name] = proof
    return kept


def _proven(prover: Prover, names: Sequence[str], workers: int) -> Iterator[tuple[str, ObjectProof]]:
    """Yield proofs as they are finished."""
    if workers <= 1 or len(names) < 2:  # with what is loaded here
        yield from ((name, proof_or_failure(prover, name)) for name in names)
        return
    yield from map_in_processes(partial(_prove_in_worker, prover.trial), names, workers)


def proof_or_failure(prover: Prover, name: str) -> ObjectProof:
    """Prove an object; one that cannot be loaded has failed."""
    try:
        return prover.prove(name)
    except VcageError as error:
        annotation = prover.library.annotation(name)
        check = ProofCheck(check="mesh", passed=False, reasons=[error.message])
        variants = [
            VariantProof(asset=name, variant=v.id, source=annotation.source, checks=[check])
            for v in annotation.variants
        ]
        return ObjectProof(key="", variants=variants)


def _prove_in_worker(trial: Trial, name: str) -> tuple[str, ObjectProof]:
    return name, proof_or_failure(_worker_prover(trial), name)


@cache
def _worker_prover(trial: Trial) -> Prover:
    """Made once in each worker process."""
    return Prover(Library.load(), trial)
