# SPDX-License-Identifier: GPL-3.0-or-later
"""What many tests look at: a virtual loudspeaker with a hidden spring, and its ladder."""

from __future__ import annotations

import os
import tempfile

import matplotlib
import pytest

import excursion

matplotlib.use("Agg")


@pytest.fixture(scope="session")
def stiff() -> excursion.Virtual:
    """A midrange whose stiffness depends on x; with it everything else is linear."""
    return excursion.virtual(
        3,
        driver="midrange",
        hidden={"stiffness": 0.3},
        channels=["current", "displacement"],
        noise=-70,
        rate=32000,
        seconds=1,
    )


@pytest.fixture(scope="session")
def told() -> list[tuple[float, str]]:
    """What is told while the linear one is measured."""
    return []


@pytest.fixture(scope="session")
def linear(told: list[tuple[float, str]]) -> excursion.Virtual:
    """A midrange with nothing hidden in it."""
    return excursion.virtual(
        3,
        driver="midrange",
        hidden=[],
        channels=["current", "displacement"],
        noise=-80,
        rate=32000,
        seconds=1,
        progress=lambda share, what: told.append((share, what)),
    )


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
