from __future__ import annotations

import numpy as np
import pytest

from tests.layout.items import roll, tray
from vcage.base.errors import UnknownName, UsageError
from vcage.layout.validation import check_items
from vcage.objects.openings import Opening


@pytest.mark.parametrize(
    ("items", "words"),
    [
        ([tray(inside="tray")], "circle"),
        ([tray("a", inside="b"), tray("b", inside="a")], "circle"),
        ([tray(), tray()], "two objects"),
        ([tray(), roll(target=(np.nan, 0))], "roll"),
        ([tray(), roll(yaw=np.inf)], "roll"),
        ([tray(), roll(size=(0.1, 0.0, 0.1))], "size"),
        ([tray(), roll(centre=(np.nan, 0.0))], "roll"),
        ([tray(), roll(allowed=[[[0, 0], [np.inf, 1]]])], "roll"),
        ([tray(), roll(allowed=[1, 2, 3])], "no rectangles .* where roll may stand"),
        ([tray(), roll(allowed=[[[1, 1], [0, 0]]])], "inverted: where roll may stand"),
        ([tray(opening=Opening((0, 0), (0.0, 0.1), 0.01, np.inf))], "opening"),
        ([tray(opening=Opening((0, 0), (0.1, 0.1), 0.01, np.nan))], "opening"),
        ([tray(opening=None), roll()], "roll lies in tray, which has no room"),
    ],
    ids=[
        "in itself",
        "in each other",
        "id twice",
        "nan",
        "infinite",
        "flat",
        "no middle",
        "endless reach",
        "no rectangles",
        "inverted reach",
        "no room",
        "nan rim",
        "no opening",
    ],
)
def test_items_that_make_no_sense_are_refused(items, words):
    with pytest.raises(UsageError, match=words):
        check_items(items)


def test_an_unknown_container_is_refused():
    with pytest.raises(UnknownName, match="drawer"):
        check_items([tray(), roll(inside="drawer")])
