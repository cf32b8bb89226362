from __future__ import annotations

from typing import get_args

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import approx_fprime

from vcage.layout.relation_cost import KNEE, RelatedBox, RelationTerms, relation_terms
from vcage.plans.relations import hold, plane_gap
from vcage.schema.plan import Relation, RelationWord

WORDS = [word for word in get_args(RelationWord) if word not in ("inside", "on")]
words = st.sampled_from(WORDS)
seeds = st.integers(0, 2**32 - 1)


def relation(word: str, subject: str = "o0", reference: str = "o1") -> Relation:
    return Relation(subject=subject, relation=word, reference=reference)


def spots(rng: np.random.Generator, count: int) -> dict[str, RelatedBox]:
    return {f"o{k}": RelatedBox(k, rng.uniform(-0.05, 0.05, 2), rng.uniform(0.01, 0.1, 2)) for k in range(count)}


def box(spot: RelatedBox, centres: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """(2, 3) the spot's world box."""
    middle = turn @ centres[spot.index] + spot.offset
    return np.array([[*(middle - spot.half), 0.0], [*(middle + spot.half), 0.1]])


def rotation(yaw: float) -> np.ndarray:
    return np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])


@settings(max_examples=200, deadline=None)
@given(word=words, seed=seeds, yaw=st.sampled_from([0.0, 0.4]))
def test_a_relation_costs_nothing_exactly_where_it_holds(word, seed, yaw):
    rng, turn = np.random.default_rng(seed), rotation(yaw)
    places, centres = spots(rng, 2), rng.uniform(-0.25, 0.25, (2, 2))
    boxes = [box(places[name], centres, turn) for name in ("o0", "o1")]
    terms = relation_terms([relation(word)], places, 2, turn)
    if not yaw and word in ("beside", "near") and plane_gap(*boxes) < 0:
        return  # overlap is the collision's matter
    assert (terms.cost(centres)[0] == 0) == hold(word, *boxes)
    assert (terms.broken(centres) == 0) == hold(word, *boxes)


@settings(max_examples=60, deadline=None)
@given(plan=st.lists(words, min_size=1, max_size=8), seed=seeds, yaw=st.sampled_from([0.0, 0.7]))
def test_the_gradient_agrees_with_finite_differences(plan, seed, yaw):
    rng = np.random.default_rng(seed)
    places = spots(rng, 4) | {"fixed": RelatedBox(None, np.zeros(2), np.full(2, 0.1))}
    names = ["o0", "o1", "o2", "o3", "fixed"]
    relations = [relation(word, *rng.choice(names, 2, replace=False)) for word in plan]
    terms = relation_terms(relations, places, 4, rotation(yaw)).tightened(0.002)
    centres = rng.uniform(-0.3, 0.3, (4, 2))
    _, gradient = terms.cost(centres)
    numeric = approx_fprime(centres.ravel(), lambda flat: terms.cost(flat.reshape(-1, 2))[0], 1e-8)
    assert np.ravel(np.zeros_like(centres) if gradient is None else gradient) == pytest.approx(numeric, abs=1e-5)


def left_of(along: float) -> tuple[RelationTerms, np.ndarray]:
    """A point that belongs left of the edge at −0.1, ``along`` metres left of the reference's centre."""
    places = {"o0": RelatedBox(0, np.zeros(2), np.full(2, 0.01)), "o1": RelatedBox(None, np.zeros(2), np.full(2, 0.1))}
    return relation_terms([relation("left_of")], places, 1), np.array([[-along, 0.0]])


def test_a_small_violation_costs_its_square():
    terms, centres = left_of(0.097)
    assert terms.cost(centres)[0] == pytest.approx(0.003**2)


def test_the_pull_of_a_large_violation_is_bounded():
    slopes = [np.abs(terms.cost(centres)[1]).max() for terms, centres in (left_of(0.05), left_of(0.02))]
    assert slopes == pytest.approx([2 * KNEE, 2 * KNEE])


def test_a_tightened_relation_must_hold_by_more():
    terms, centres = left_of(0.101)
    assert terms.cost(centres)[0] == 0
    assert terms.tightened(0.002).cost(centres)[0] == pytest.approx(0.001**2)


def test_a_rigid_group_or_a_missing_object_has_no_term():
    places = {"o0": RelatedBox(0, np.zeros(2), np.ones(2)), "o1": RelatedBox(0, np.ones(2), np.ones(2))}
    assert relation_terms([relation("near"), relation("near", "o0", "elsewhere")], places, 1) is None


def test_inside_and_on_are_no_terms():
    places = spots(np.random.default_rng(0), 2)
    assert relation_terms([relation("inside"), relation("on")], places, 2) is None


@given(seed=seeds)
@settings(max_examples=20, deadline=None)
def test_leaving_out_a_relation_leaves_the_others(seed):
    rng = np.random.default_rng(seed)
    places, centres = spots(rng, 3), rng.uniform(-0.3, 0.3, (3, 2))
    # in the order of the terms: direction words first
    relations = [relation("left_of"), relation("behind", "o2", "o1"), relation("near"), relation("center", "o2", "o0")]
    terms = relation_terms(relations, places, 3)
    for k in range(len(relations)):
        rest = relation_terms(relations[:k] + relations[k + 1 :], places, 3)
        assert terms.without(k).violations(centres) == pytest.approx(rest.violations(centres))
