"""Small objects made of boxes, sound ones and ones with a fault."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
import trimesh

from vcage.apps.proof.trials import TrialPlaces
from vcage.objects.asset import Asset
from vcage.objects.model import read_model, write_model
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint
from vcage.schema.asset import Annotation, ContactPoint, FunctionalPoint, Variant, Words
from vcage.sim.robots import load_robot, load_template

Make = Callable[..., Asset]

TRAY = [
    [(-0.06, -0.05, 0), (0.06, 0.05, 0.005)],
    [(-0.06, -0.05, 0.005), (-0.055, 0.05, 0.03)],
    [(0.055, -0.05, 0.005), (0.06, 0.05, 0.03)],
    [(-0.055, -0.05, 0.005), (0.055, -0.045, 0.03)],
    [(-0.055, 0.045, 0.005), (0.055, 0.05, 0.03)],
]
"""Bounds (2, 3) of floor and walls of an open tray, metres."""

CUBE = [[(-0.02, -0.02, 0), (0.02, 0.02, 0.04)]]


def contact(**fields) -> ContactPoint:
    """The sides of the cube, or what the fields say."""
    sides = {"position": (0, 0, 0.025), "approach": (0, 0, -1), "closing": (0, 1, 0)}
    return ContactPoint(**{"id": 0, "name": "sides", **sides, **fields})


def inside(**fields) -> FunctionalPoint:
    """The floor of the tray, or what the fields say."""
    return FunctionalPoint(**{"id": 0, "name": "inside", "holds": "in", "position": (0, 0, 0.005), **fields})


@pytest.fixture
def make(tmp_path: Path) -> Make:
    """Makes an asset of boxes: the visible mesh, and other hulls if given."""

    def make(
        seen: Sequence,
        hulls: Sequence | None = None,
        *,
        mass: float = 0.05,
        friction: float = 0.7,
        subdivisions: int = 0,
        contacts: Sequence[ContactPoint] = (),
        functional: Sequence[FunctionalPoint] = (),
    ) -> Asset:
        boxes = [trimesh.creation.box(bounds=np.array(bounds, dtype=float)) for bounds in seen]
        solid = [trimesh.creation.box(bounds=np.array(bounds, dtype=float)) for bounds in (hulls or seen)]
        mesh = trimesh.util.concatenate(boxes)
        for _ in range(subdivisions):
            mesh = mesh.subdivide()
        part = paint(mesh, np.full((4, 4, 3), 150, dtype=np.uint8), tiled(0.1))
        folder = tmp_path / f"model-{len(list(tmp_path.iterdir()))}"
        folder.mkdir()
        write_model(BuiltObject([part], solid, mass, friction), folder)
        variant = Variant(id="grey", colour="grey")
        words = Words(name="thing", plural="things", description="A thing of boxes.", category="test")
        annotation = Annotation(
            name="thing",
            words=words,
            variants=[variant],
            contact_points=list(contacts),
            functional_points=list(functional),
        )
        return Asset(annotation, variant, read_model(folder))

    return make


@pytest.fixture(scope="session")
def places() -> TrialPlaces:
    """The default table, and a robot that reaches all of it."""
    return TrialPlaces(load_template("table"), load_robot("dual_panda"))
