# SPDX-License-Identifier: GPL-3.0-or-later
"""What many tests look at: a virtual loudspeaker with a hidden spring, and its ladder."""

from __future__ import annotations

import dataclasses
import os
import tempfile

import matplotlib
import pytest

import excursion

matplotlib.use("Agg")


def measured(seed: int, hidden: dict[str, float], noise: float, **options) -> excursion.Virtual:
    """A virtual midrange; of its take two levels of two realizations, as the tests have to be quick."""
    speaker = excursion.virtual(
        seed,
        driver="midrange",
        hidden=hidden,
        channels=["current", "displacement"],
        noise=noise,
        rate=32000,
        seconds=1,
        **options,
    )
    take, e = speaker.take, speaker.take.excitation
    block = e.period * (e.settle_periods + e.periods)
    shape = (len(e.levels), e.realizations, block)
    kept = {quantity: values[: e.samples].reshape(shape)[-2:, :2].ravel() for quantity, values in take.samples.items()}
    shorter = dataclasses.replace(e, levels=e.levels[-2:], realizations=2)
    speaker.take = excursion.Take(take.rate, excitation=shorter, driver=take.driver, **kept)
    return speaker


@pytest.fixture(scope="session")
def stiff() -> excursion.Virtual:
    """A midrange whose stiffness depends on x; with it everything else is linear."""
    return measured(3, {"stiffness": 0.3}, noise=-70)


@pytest.fixture(scope="session")
def told() -> list[tuple[float, str]]:
    """What is told while the linear one is measured."""
    return []


@pytest.fixture(scope="session")
def linear(told: list[tuple[float, str]]) -> excursion.Virtual:
    """A midrange with nothing hidden in it."""
    return measured(3, {}, noise=-80, progress=lambda share, what: told.append((share, what)))


@pytest.fixture(scope="session")
def linear_fit(linear: excursion.Virtual) -> excursion.Fit:
    return excursion.fit(linear.take)


@pytest.fixture(scope="session")
def stiff_fit(stiff: excursion.Virtual) -> excursion.Fit:
    return excursion.fit(stiff.take)


@pytest.fixture(scope="session")
def ladder(stiff: excursion.Virtual) -> excursion.Ladder:
    return excursion.improve(stiff.take)


@pytest.fixture
def scratch(tmp_path, monkeypatch):
    """A folder for temporary folders, to see what is left in it."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    yield folder
    assert os.listdir(folder) == []
