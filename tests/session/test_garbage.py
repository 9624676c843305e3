"""The search for garbage waits until a program has started, and never for good."""

from __future__ import annotations

import gc

import pytest

from dismech_cli.session.garbage import search, search_postponed


@pytest.fixture(autouse=True)
def searched():
    assert gc.isenabled()
    yield
    gc.unfreeze()
    gc.enable()


def test_it_starts_again_where_asked_and_leaves_out_what_was_there():
    with search_postponed():
        assert not gc.isenabled()
        search()
        assert gc.isenabled()
        assert gc.get_freeze_count() > 0
    assert gc.isenabled()


def test_it_starts_again_after_the_block_whatever_happens_in_it():
    with pytest.raises(KeyError), search_postponed():
        raise KeyError
    assert gc.isenabled()
    assert gc.get_freeze_count() == 0


def test_where_nobody_put_it_off_nothing_is_left_out():
    search()
    assert gc.get_freeze_count() == 0


def test_who_searches_never_goes_on_so():
    gc.disable()
    with search_postponed():
        pass
    assert not gc.isenabled()
