"""Measuring a peer and gaussmap itself, on few points, without the packages of the peers."""

import dataclasses

import pytest
from gaussmap.benchmarks.peers import measure
from gaussmap.benchmarks.peers.catalogue import RECIPE
from gaussmap.benchmarks.peers.forms import FORMS
from gaussmap.benchmarks.peers.metrics import Places
from gaussmap.benchmarks.peers.peer import Turns

FORM = pytest.mark.parametrize("form", FORMS, ids=lambda x: x.name)


@pytest.fixture(autouse=True)
def small(monkeypatch):
    monkeypatch.setattr(measure, "MILLION", 2_000)
    monkeypatch.setattr(measure, "JUDGED", 500)
    measure.normals_for.cache_clear()


@FORM
def test_a_peer_is_timed_and_judged(form):
    peer = dataclasses.replace(RECIPE, count=1_000, rounds=1)
    found = measure.measure(form, Places.of(form, 300), peer)
    assert (found.points, found.missing) == (1_000, "")
    assert min(found.rate, found.times_same, found.times_million) > 0.0
    assert 0.0 < found.errors[1] <= 180.0


def test_ratios_are_of_rates(monkeypatch):
    """Work takes 3 times as long as gaussmap and gives half the points that were asked."""
    monkeypatch.setattr(
        measure, "in_turns", lambda work, others, rounds: Turns(0.1, 50, dict.fromkeys(others, 3.0))
    )
    peer = dataclasses.replace(RECIPE, count=100)
    found = measure.measure(FORMS[0], Places.of(FORMS[0], 10), peer)
    assert (found.rate, found.times_same, found.times_million) == (500.0, 6.0, 120.0)


def test_a_missing_peer_is_not_prepared():
    peer = dataclasses.replace(RECIPE, module="no_such_package_here")
    found = measure.measure(FORMS[0], Places.of(FORMS[0], 10), peer)
    assert found == measure.Measured(peer, peer.missing)
    assert found.missing
