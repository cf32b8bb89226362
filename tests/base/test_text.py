from __future__ import annotations

import pytest

from vcage.base.text import listed


@pytest.mark.parametrize(("count", "line"), [(0, ""), (2, "0; 1"), (3, "0; 1 and 1 more")])
def test_a_long_list_says_how_many_more_there_are(count: int, line: str) -> None:
    assert listed(range(count), most=2, between="; ") == line
