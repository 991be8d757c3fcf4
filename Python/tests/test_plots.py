# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures show the numbers that the tables hold, with their units."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.figure import Figure

import excursion


@pytest.fixture(autouse=True)
def closed():
    yield
    pyplot.close("all")


def line(axis, label: str) -> np.ndarray:
    """The ordinates of the line of this label."""
    return next(np.asarray(one.get_ydata(), dtype=float) for one in axis.get_lines() if one.get_label() == label)


def test_a_take(stiff):
    axes = stiff.take.plot(start=2.5, seconds=0.5).flat
    assert [axis.get_ylabel() for axis in axes] == ["voltage\nV", "current\nA", "displacement\nmm"]
    shown = axes[2].get_lines()[0]
    np.testing.assert_allclose(shown.get_ydata(), 1e3 * stiff.take["displacement"][80000:96000])
    assert shown.get_xdata()[0] == 2.5
    with pytest.raises(excursion.Error, match="ends at"):
        stiff.take.plot(start=100)


def test_a_response(stiff):
    response = excursion.bla(stiff.take)
    magnitude, phase = response.plot()[:, 0]
    np.testing.assert_allclose(line(magnitude, "magnitude"), np.abs(response.value))
    np.testing.assert_allclose(line(magnitude, "deviation by noise") ** 2, response.noise_variance)
    assert magnitude.get_ylabel() == "admittance, A/V" and phase.get_xlabel() == "Hz"
    assert response.inverse().plot()[0, 0].get_ylabel() == "impedance, Ω"
    assert excursion.Response([1.0, 2.0], [1.0, 2.0]).plot()[0, 0].get_title() == ""


def test_a_comparison_and_its_residuals(stiff, stiff_fit):
    comparison = excursion.compare(stiff.take, stiff_fit.model)
    axes = comparison.plot().flat
    assert axes[1].get_ylabel() == "displacement\ndB re 1 m"
    expected = comparison.spectrum("displacement")["error"]
    np.testing.assert_allclose(line(axes[1], "error"), 20 * np.log10(expected))
    residuals = comparison.plot_residuals()
    assert residuals.shape == (2, 3)
    assert {curve.residual for curve in comparison.residuals_over_time} == {"stiffness", "resistance"}
    assert all(len(curve.at) == 4 for curve in comparison.residuals_over_time)
    assert residuals[0, 0].get_ylabel() == "force, mN" and residuals[1, 2].get_xlabel() == "i, A"


def test_a_ladder_and_its_laws(ladder):
    axis = ladder.plot()[0, 0]
    np.testing.assert_allclose(line(axis, "current"), ladder.table()["current dB"].iloc[:2])
    assert [tick.get_text() for tick in axis.get_xticklabels()] == ["linear", "+ stiffness"]
    law = ladder.model.laws["K(x)"]
    axis = ladder.model.plot()[0, 0]
    assert axis.get_title() == "K(x), N/m" and axis.get_xlabel() == "x, mm"
    np.testing.assert_allclose(axis.get_lines()[0].get_ydata(), law.value)
    assert law.table().loc[law.at[0], "value"] == law.value[0]


def test_distortion_by_effect(ladder):
    even, odd = ladder.whatif.plot("displacement").flat
    expected = ladder.whatif.bands(channel="displacement")["even"]
    np.testing.assert_allclose(line(even, "as it is"), expected.where(expected > -120))
    assert "without stiffness: none" in [text.get_text() for text in odd.get_legend().get_texts()]


def test_without_matplotlib_everything_but_pictures_works(ladder, monkeypatch):
    for module in ("matplotlib", "matplotlib.pyplot"):
        monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match="pip install"):
        ladder.plot()


def test_a_figure_of_ones_own(ladder):
    figure = Figure()
    axes = ladder.plot(figure=figure)
    assert axes[0, 0].figure is figure and pyplot.get_fignums() == []


def test_what_cannot_be_drawn_is_told(linear, linear_fit):
    with pytest.raises(excursion.Error, match="has no law"):
        linear_fit.plot()
    empty = excursion.Ladder({"rungs": [], "verdict": "bad-measurement", "sentence": ""})
    with pytest.raises(excursion.Error, match="has no rung"):
        empty.plot()
