"""The proof of one kind of object: all checks of all its variants."""

from __future__ import annotations

import functools
import hashlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from vcage.apps.proof.grasping import check_contact
from vcage.apps.proof.mesh import check_mesh
from vcage.apps.proof.operating import check_joint
from vcage.apps.proof.releasing import check_functional, check_rest
from vcage.apps.proof.trials import TrialPlaces
from vcage.base.files import sha256_file
from vcage.objects.asset import Asset
from vcage.objects.library import Library
from vcage.schema.proof import ObjectProof, ProofCheck, VariantProof
from vcage.sim.robots import load_robot, load_template

METHOD = (
    "apps/proof",
    "sim",
    "tasks",
    "tasks/primitives",
    "tasks/templates",
    "layout",
    "layout/placement",
    "objects",
)
"""Packages whose modules decide how things are measured and tried; the models of objects have hashes of their own."""


@dataclass(frozen=True)
class Trial:
    """Settings of a proof.

    Args:
        template: name of the scene whose table and robot are used.
        seed: of all places.
        quick: only the first variant, three tries.
    """

    template: str = "table"
    robot: str | None = None
    seed: int = 0
    quick: bool = False

    @property
    def tries(self) -> int:
        """Tries of each point and joint."""
        return 3 if self.quick else 10


class Prover:
    """Proves objects with one robot on one table; kinematics and reach are computed once."""

    def __init__(self, library: Library, trial: Trial):
        self.library = library
        self.trial = trial

    @cached_property
    def places(self) -> TrialPlaces:
        """The table and the robot."""
        template = load_template(self.trial.template, self.trial.robot)
        return TrialPlaces(template, load_robot(template.robot))

    def prove(self, name: str) -> ObjectProof:
        """Run all checks of an object's variants; a variant of the same shape as an earlier one shares its tries."""
        variants = [v.id for v in self.library.annotation(name).variants]
        proofs: list[VariantProof] = []
        tried: dict[str, VariantProof] = {}
        for variant in variants[:1] if self.trial.quick else variants:
            asset = self.library.asset(name, variant)
            shape = shape_hash(asset)
            proofs.append(self._variant(asset, tried.get(shape)))
            tried.setdefault(shape, proofs[-1])
        return ObjectProof(key=self.key(name), variants=proofs)

    def key(self, name: str) -> str:
        """Hash everything that the proof of an object depends on."""
        annotation = self.library.annotation(name)
        template = load_template(self.trial.template, self.trial.robot)
        assets = [self.library.asset(name, v.id) for v in annotation.variants]
        shapes = [shape_hash(asset) for asset in assets]
        shapes += [sha256_file(Path(path)) for asset in assets for path in _visuals(asset)]
        parts = [annotation.model_dump_json(), *shapes, repr(self.trial), template.model_dump_json()]
        parts += [load_robot(template.robot).model_dump_json(), _method()]
        return hashlib.sha256("\0".join(parts).encode()).hexdigest()

    def _variant(self, asset: Asset, same: VariantProof | None) -> VariantProof:
        checks = [check_mesh(asset, self.trial.seed)]
        return VariantProof(
            asset=asset.name,
            variant=asset.variant.id,
            source=asset.annotation.source,
            same_as=same.variant if same else None,
            checks=checks + (same.checks[1:] if same else self._used(asset)),
        )

    def _used(self, asset: Asset) -> list[ProofCheck]:
        """The checks in the simulator."""
        places, tries, seed = self.places, self.trial.tries, self.trial.seed
        table = places.template.table
        yaw = float(np.random.default_rng(seed).uniform(-np.pi, np.pi))
        checks = [check_rest(asset, table, yaw)]
        carried = asset.annotation.carrying_points
        checks += [check_contact(asset, contact, places, tries, seed) for contact in carried]
        points = asset.annotation.functional_points
        checks += [check_functional(asset, point, table, tries, seed) for point in points]
        checks += [check_joint(asset, link, places, tries, seed) for link in asset.model.links]
        return checks


def shape_hash(asset: Asset) -> str:
    """Hash hulls, mass, friction and joints, but not looks: equal for variants with the same physics."""
    model = asset.model
    digest = hashlib.sha256(f"{model.lower} {model.upper} {model.mass} {model.friction}".encode())
    for path in model.hulls:
        digest.update(sha256_file(Path(path)).encode())
    for link in model.links:
        digest.update(f"{link.name} {link.parent} {link.mass} {link.joint.model_dump_json()}".encode())
        for path in link.hulls:
            digest.update(sha256_file(Path(path)).encode())
    return digest.hexdigest()


def _visuals(asset: Asset) -> list[str]:
    return [asset.model.visual, *(link.visual for link in asset.model.links)]


@functools.cache
def _method() -> str:
    """Hash the code of the checks, and of the planning and physics under them."""
    package = Path(__file__).parents[2]
    digest = hashlib.sha256()
    sources = [path for folder in METHOD for path in sorted((package / folder).glob("*.py"))]
    for path in [*sources, package / "base" / "geometry.py"]:
        digest.update(path.read_bytes())
    return digest.hexdigest()
