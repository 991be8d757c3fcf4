# SPDX-License-Identifier: GPL-3.0-or-later
"""A virtual loudspeaker with a hidden spring, from its measurement to its linearization."""

from __future__ import annotations

import copy

import numpy as np
import pytest

import excursion


def test_the_parameters_of_a_virtual_loudspeaker(linear, linear_fit):
    for name in ("Re", "Le", "Bl", "m", "Rms", "K"):
        assert linear_fit.model[name] == pytest.approx(linear.truth["driver"][name], rel=0.01), name
    assert linear.hidden == []
    diagnosis = excursion.diagnose(linear.take, linear_fit.model)
    assert (diagnosis.verdict, diagnosis.missing, diagnosis.reason) == ("complete", None, "")


def test_the_hidden_effect_is_named(stiff, stiff_fit):
    diagnosis = excursion.diagnose(stiff.take, stiff_fit.model)
    assert (diagnosis.verdict, diagnosis.missing) == ("missing-effect", "stiffness")
    table = diagnosis.table()
    assert table.index[0] == "stiffness" and table.loc["stiffness", "confidence"] > 0.9
    assert bool(table.loc["stiffness", "refitted"]) and "K(x)" in diagnosis.reason
    assert table.loc["stiffness", "displacement dB"] < diagnosis.error.loc["displacement", "db"] - 30


def test_a_comparison_agrees_with_the_fit(stiff, stiff_fit):
    comparison = excursion.compare(stiff.take, stiff_fit.model)
    np.testing.assert_allclose(comparison.error["db"], stiff_fit.error["db"], atol=0.05)
    table = comparison.table()
    assert list(table.index.get_level_values("channel").unique()) == ["current", "displacement"]
    assert len(comparison.levels) == len(table.loc["current"])
    spectrum = comparison.spectrum("displacement")
    assert 20 * np.log10(np.linalg.norm(spectrum["error"]) / np.linalg.norm(spectrum["measured"])) == pytest.approx(
        table.loc["displacement", "db"].iloc[-1], abs=1.0
    )
    curves = {(curve.residual, curve.against): curve for curve in comparison.residuals}
    force = curves["force", "x"]
    # The model lacks the force -(K(x) - K) x of the spring that it has not.
    law = stiff.truth["laws"]["stiffness"]
    lacking = -(np.interp(force.at, law["at"], law["value"]) - stiff_fit.model["K"]) * force.at
    assert np.corrcoef(force.mean, lacking)[0, 1] > 0.98
    assert force.db > curves["voltage", "x"].db + 15
    with pytest.raises(excursion.Error, match="no channel 'pressure'"):
        comparison.spectrum("pressure")


def test_the_ladder_ends_at_the_noise_with_the_true_law(stiff, ladder):
    assert ladder.verdict == "complete"
    assert list(ladder.known) == stiff.hidden and ladder.known["stiffness"] > 0.9
    assert [rung.added for rung in ladder.rungs] == [None, "stiffness"]
    table = ladder.table()
    assert table.loc["noise", "current dB"] == pytest.approx(table.loc[1, "current dB"], abs=0.5)
    assert ladder.rungs[-1].chi_squared_per_value == pytest.approx(1.0, abs=0.1)
    assert ladder.rungs[0].chi_squared_per_value > 100
    law = ladder.model.laws["K(x)"]
    truth = stiff.truth["laws"]["stiffness"]
    expected = np.interp(law.at, truth["at"], truth["value"])
    inner = np.abs(law.at) < 0.8 * law.at[-1]
    assert np.max(np.abs(law.value - expected)[inner] / expected[inner]) < 0.02
    assert np.all(law.half_width > 0) and law.unit == "N/m"
    assert ladder.report.lstrip().lower().startswith("<!doctype html")


def test_a_ladder_is_kept_and_read_again(ladder, tmp_path):
    ladder.model.write(tmp_path / "model.json")
    assert excursion.Model.read(tmp_path / "model.json").document == ladder.model.document
    ladder.save_report(tmp_path / "report.html")
    assert (tmp_path / "report.html").read_text() == ladder.report


def test_an_effect_is_added(stiff, stiff_fit):
    added = excursion.add(stiff.take, "stiffness", stiff_fit.model)
    assert excursion.fit(stiff.take, "stiffness").model.effects == ["stiffness"]  # one name needs no list
    assert added.added == "stiffness" and added.model.effects == ["stiffness"]
    assert added.error.loc["displacement", "db"] < added.error_before.loc["displacement", "db"] - 30
    assert added.model["stiffness", "c1"] == added.parameters.loc[("stiffness", "c1"), "value"]
    with pytest.raises(KeyError):
        added.model["c1"]
    with pytest.raises(excursion.Error, match="already has the effect") as refused:
        excursion.add(stiff.take, "stiffness", added.model)
    assert refused.value.kind == "usage"


def test_a_model_follows_what_has_drifted(stiff, ladder):
    before = copy.deepcopy(ladder.model.document)
    for parameter in before["base"]["parameters"]:
        if parameter["name"] in ("Re", "K"):
            parameter["value"] *= 0.9
    adapted = excursion.adapt(excursion.Model(before), stiff.take)
    table = adapted.table()
    assert list(table.index) == ["Re", "Rms", "K"]
    for name in ("Re", "K"):
        assert table.loc[name, "after"] == pytest.approx(stiff.truth["driver"][name], rel=0.01), name
        assert table.loc[name, "share"] == pytest.approx(1 / 0.9 - 1, abs=0.02), name
    assert adapted.warmer == pytest.approx((1 / 0.9 - 1) / 0.0039, rel=0.1)
    assert adapted.error.loc["current", "db"] < adapted.error_before.loc["current", "db"] - 20
    assert adapted.sentence and adapted.model["Re"] == table.loc["Re", "after"]
    only = excursion.adapt(excursion.Model(before), stiff.take, ["Re"])
    assert list(only.drift.index) == ["Re"]
    with pytest.raises(excursion.Error):
        excursion.adapt(excursion.Model(before), stiff.take, ["nonsense"])


def test_a_flat_band_is_a_target(ladder):
    rate, n = 48000, 24000
    f = 100.0
    voltage = 1e-3 * np.sin(2 * np.pi * f * np.arange(n) / rate)
    own = excursion.predistort(ladder.model, voltage, rate)
    flat = excursion.predistort(ladder.model, voltage, rate, target_flat=(80, 800))
    assert flat.document["target"]["kind"] == "flat"
    assert np.std(flat.voltage[n // 2 :]) != pytest.approx(np.std(own.voltage[n // 2 :]), rel=0.02)


def test_without_its_effect_the_distortion_is_gone(stiff, ladder):
    answer = excursion.whatif(ladder.model, stiff.take)
    table = answer.table("displacement")
    assert table.loc[("as it is", "whole"), "evenDb"] > -60
    assert table.loc[("stiffness", "without"), "evenDb"] < -100
    assert answer.level == pytest.approx(stiff.take.excitation.levels[-1], rel=1e-3)
    assert "K(x)" in answer.advice and len(answer.limits) > 0
    assert len(answer.bands()) == len(answer.bands("stiffness", "without"))
    with pytest.raises(excursion.Error, match="no variant"):
        answer.bands("doppler")
    with pytest.raises(excursion.Error, match="no channel"):
        answer.table("sound")
    assert ladder.whatif.advice == answer.advice


def harmonics(samples: np.ndarray, rate: int, tone: float) -> float:
    """Harmonics 2 to 5 of a tone over the tone, in dB, of the last second."""
    spectrum = np.abs(np.fft.rfft(samples[-rate:] * np.hanning(rate)))
    at = [round(k * tone) for k in range(1, 6)]
    return 20 * np.log10(np.linalg.norm(spectrum[at[1:]]) / spectrum[at[0]])


def test_a_predistorted_tone_moves_the_cone_as_a_sine(stiff, ladder):
    rate, tone = 48000, 60
    time = np.arange(2 * rate) / rate
    voltage = 2.5 * np.sin(2 * np.pi * tone * time) * np.minimum(1.0, 5 * time)
    bent = excursion.predistort(ladder.model, voltage, rate, limit_x=0.01)
    assert not bent.limited and bent.voltage.shape == voltage.shape
    before = harmonics(excursion.simulate(ladder.model, voltage, rate)["displacement"], rate, tone)
    after = harmonics(excursion.simulate(ladder.model, bent.voltage, rate)["displacement"], rate, tone)
    assert before > -50 and after < before - 40
    as_it_was = excursion.predistort(ladder.model, voltage, rate, limit_x=0.01, amount=0.0)
    # At its end the filters of the oversampling look into the silence behind it.
    np.testing.assert_allclose(as_it_was.voltage[:-100], voltage[:-100], atol=1e-5)


def test_limits_are_kept_in_every_channel(ladder):
    rate = 44100
    tones = np.stack([6.0 * np.sin(2 * np.pi * f * np.arange(rate) / rate) for f in (40.0, 400.0)], axis=1)
    limit = 0.5e-3
    bent = excursion.predistort(ladder.model, tones, rate, limit_x=limit)
    assert bent.limited and bent.voltage.shape == tones.shape and len(bent.table()) == 2
    assert (bent.table()["displacement"] <= limit * 1.001).all()
    moved = excursion.simulate(ladder.model, bent.voltage[:, 0], rate)["displacement"]
    assert 0.8 * limit < np.max(np.abs(moved)) < 1.01 * limit


def test_a_simulation_beyond_the_measured_range_warns(ladder):
    time = np.arange(4800) / 48000
    with pytest.warns(excursion.ExcursionWarning, match="beyond that its laws are a guess"):
        excursion.simulate(ladder.model, 12 * np.sin(2 * np.pi * 50 * time), 48000)


def test_classes_of_models_are_ranked(stiff):
    ranking = excursion.rank(stiff.take, output="displacement", classes=["linear", "driver"])
    table = ranking.table()
    assert set(table.index) == {"linear", "driver"} and table.index[0] == ranking.best
    assert table["validationDb"].is_monotonic_increasing
    assert ranking.noise_db == pytest.approx(-73, abs=2)
    assert ranking.linearizes_best is None  # neither knows what bends
    assert set(ranking.linearization().index) == {"linear", "driver"}


def test_an_impedance_is_enough_for_a_linear_model(tmp_path):
    """A ZMA of a closed form: what an impedance tells is found, what it does not is told."""
    frequency = np.geomspace(10, 5000, 200)
    s = 2j * np.pi * frequency
    impedance = 5.6 + 4e-4 * s + 6.5**2 * s / (0.015 * s**2 + 1.2 * s + 1200)
    lines = (f"{f:.9g} {abs(z):.12g} {np.degrees(np.angle(z)):.12g}\n" for f, z in zip(frequency, impedance))
    (tmp_path / "wöofer.zma").write_text("".join(lines))
    fit = excursion.fit(tmp_path / "wöofer.zma")
    assert fit.model["Re"] == pytest.approx(5.6, rel=1e-5) and fit.model["Le"] == pytest.approx(4e-4, rel=1e-5)
    assert fit.model["Bl"] ** 2 / fit.model["m"] == pytest.approx(6.5**2 / 0.015, rel=1e-5)
    assert np.isnan(fit.parameters.loc[("electrodynamic", "m"), "standardError"])
    comparison = excursion.compare(tmp_path / "wöofer.zma", fit.model)
    assert comparison.error.loc["current", "db"] < -100
    assert np.isnan(comparison.error.loc["current", "chiSquaredPerValue"])
    assert comparison.plot().shape == (1, 1) and comparison.residuals == []
    with pytest.raises(excursion.Error, match="no stimulus") as refused:
        excursion.whatif(fit.model, tmp_path / "wöofer.zma")
    assert refused.value.kind == "data"


def test_the_catalogue_is_listed():
    effects = excursion.effects()
    assert {"stiffness", "force-factor", "doppler"} <= set(effects.index)
    assert effects.loc["stiffness", "title"] == "Stiffness K(x)"
