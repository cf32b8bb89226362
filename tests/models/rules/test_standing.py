"""Where an object is looked for: where the layout put it, and elsewhere."""

from __future__ import annotations

from typing import cast

import numpy as np
import pytest

from vcage.base.geometry import Pose
from vcage.models.rules.standing import Sought, Standing
from vcage.vision.protocols import Reference, View

PLANNED = Standing(Pose([0, 0, 0]), (0.1, 0.1, 0.1), 10.0, np.ones((1, 1), bool))
OTHER = Standing(Pose([1, 0, 0]), (0.1, 0.1, 0.1), 4.0, np.ones((1, 1), bool))


@pytest.mark.parametrize(("bare", "found"), [([], OTHER), ([OTHER], PLANNED), ([PLANNED], OTHER)])
def test_a_place_that_fits_better_counts_only_where_something_is_seen_there(
    monkeypatch: pytest.MonkeyPatch, bare: list[Standing], found: Standing
):
    monkeypatch.setattr(Sought, "where_planned", lambda *_: PLANNED)
    monkeypatch.setattr(Sought, "standing", lambda *_: OTHER)
    monkeypatch.setattr(Sought, "gone", lambda _, there, __: any(there is one for one in bare))
    sought = Sought(cast(Reference, None), lambda *_: None, None, 0.74)  # pyrefly: ignore
    assert sought.found({"top": cast(View, None)}) is found
