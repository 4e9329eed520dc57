"""The search for garbage is left for later, and comes back."""

from __future__ import annotations

import gc

import pytest

from irc.model.garbage import without_garbage


def test_the_search_is_off_inside_and_on_again_behind() -> None:
    assert gc.isenabled()
    with without_garbage():
        assert not gc.isenabled()
        with without_garbage():
            pass
        assert not gc.isenabled()
    assert gc.isenabled()


def test_an_error_switches_it_on_again() -> None:
    with pytest.raises(ValueError, match="wrong"), without_garbage():
        raise ValueError("wrong")
    assert gc.isenabled()


def test_who_has_switched_it_off_finds_it_off() -> None:
    gc.disable()
    try:
        with without_garbage():
            pass
        assert not gc.isenabled()
    finally:
        gc.enable()
