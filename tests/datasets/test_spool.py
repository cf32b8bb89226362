from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from vcage.datasets.spool import spooled


@given(pieces=st.lists(st.binary(), min_size=1))
def test_pieces_come_back_in_order_as_often_as_they_are_asked_for(tmp_path_factory, pieces):
    with spooled(iter(pieces), tmp_path_factory.getbasetemp()) as spool:
        assert (len(spool), spool.longest) == (len(pieces), max(map(len, pieces)))
        assert list(spool) == list(spool) == pieces


def test_nothing_is_left_in_the_folder(tmp_path):
    with spooled([b"piece"], tmp_path):
        assert list(tmp_path.iterdir()) == []
    assert list(tmp_path.iterdir()) == []
