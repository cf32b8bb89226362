"""The critic on what is hit, from its measurements."""

from __future__ import annotations

import pytest

from vcage.models.rules.evidence.hit import Struck


@pytest.mark.parametrize(
    ("seen", "beside", "over", "accepted"),
    [(0.77, 0.55, 0.59, True), (0.45, 0.39, 0.44, False), (0.71, 0.9, 0.58, False), (0.36, 0.2, 0.2, False)],
)
def test_a_tool_must_be_seen_clearly_better_on_a_thing_than_beside_or_over_it(
    seen: float, beside: float, over: float, accepted: bool
) -> None:
    """As measured where another thing was hit (45 %), and where the head came down beside (71 %)."""
    verdict = Struck(left=1.0, seen=seen, beside=beside, over=over).verdict("hammer", "jar")
    assert verdict.accepted == accepted, verdict.reason
