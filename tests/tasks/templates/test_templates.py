"""Attempts and refusals of templates, and the calls that they give to the robot."""

from __future__ import annotations

import ast

import pytest

from tests.example_scenes import block_and_plate, subtask, thing
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.templates.place import PLACE


@pytest.mark.parametrize("template", TEMPLATES.values())
def test_a_script_only_calls_the_task(template):
    calls = template.calls(subtask())
    assert calls and all(call.startswith("task.") for call in calls)
    names = {node.id for call in calls for node in ast.walk(ast.parse(call)) if isinstance(node, ast.Name)}
    assert names <= {"task", "GRASPS", "contact", "arm", "_"}


def test_a_pair_is_tried_at_each_contact_point_of_one_and_functional_point_of_the_other():
    block, plate = block_and_plate()
    pairs, _ = PLACE.proposals([block, plate], ())
    assert [(pair.thing.id, pair.receptacle.id, pair.candidates) for pair in pairs if pair.thing.id == "block"] == [
        ("block", "plate", len(block.asset.annotation.contact_points))
    ]


def test_a_pair_without_the_points_is_refused_with_the_missing_ones():
    _, refused = PLACE.proposals([thing("marker"), thing("plate"), thing("packaging_box")], ())
    assert {(r.object, r.receptacle, r.reason) for r in refused} == {
        ("plate", "marker", "black marker pen has no place to put something in or on"),
        ("packaging_box", "marker", "black marker pen has no place to put something in or on"),
        ("plate", "packaging_box", "white plate has no contact point to carry it by"),
    }
