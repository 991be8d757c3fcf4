# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear systems that NumPy and SciPy solve by themselves."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.signal

import excursion

RATE, PERIOD = 32000, 4096
LINES = np.array([k for k in range(5, 400, 2) if k % 14 != 5])  # odd, with some left out to see odd distortion
FREQUENCY = LINES * RATE / PERIOD

# A woofer; the numbers are invented.
WOOFER = {"Re": 5.6, "Le": 4e-4, "Bl": 6.5, "m": 0.015, "Rms": 1.2, "K": 1200.0}


def admittance_and_motion(frequency: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """i/u and x/u of that woofer: u = (Re + s Le) i + Bl s x, (m s² + Rms s + K) x = Bl i."""
    p, s = WOOFER, 2j * np.pi * frequency
    mechanical = p["m"] * s**2 + p["Rms"] * s + p["K"]
    current = 1 / (p["Re"] + s * p["Le"] + p["Bl"] ** 2 * s / mechanical)
    return current, p["Bl"] / mechanical * current


def multisines(draw: np.random.Generator, levels: list[float], realizations: int) -> np.ndarray:
    """Spectra (rfft of one period) with random phases, one row a realization, of these rms."""
    spectra = np.zeros((len(levels) * realizations, PERIOD // 2 + 1), complex)
    for row, level in zip(spectra, np.repeat(levels, realizations)):
        row[LINES] = np.exp(2j * np.pi * draw.random(LINES.size)) * level * PERIOD / np.sqrt(2 * LINES.size)
    return spectra


def record(spectra: np.ndarray, repetitions: int) -> np.ndarray:
    """Each row's period, repeated, one row after the other."""
    return np.concatenate([np.tile(period, repetitions) for period in np.fft.irfft(spectra, PERIOD, axis=1)])


def through(spectra: np.ndarray, response: np.ndarray) -> np.ndarray:
    out = np.zeros_like(spectra)
    out[:, LINES] = spectra[:, LINES] * response
    return out


def take_of(draw: np.random.Generator, noise: float = 0.0, bend: float = 0.0, periods: int = 4) -> excursion.Take:
    """A take of the woofer in steady state, the current with white noise of this rms and, in A/V², bend u²."""
    levels, realizations = [1.0, 2.0], 4
    spectra = multisines(draw, levels, realizations)
    voltage = record(spectra, periods)
    current = record(through(spectra, admittance_and_motion(FREQUENCY)[0]), periods) + bend * voltage**2
    excitation = excursion.Excitation(
        period=PERIOD, periods=periods, realizations=realizations, levels=levels, grid="odd-random", lines=LINES
    )
    return excursion.Take(
        RATE, voltage=voltage, current=current + noise * draw.standard_normal(current.size), excitation=excitation
    )


def test_the_response_of_a_known_system():
    take = take_of(np.random.default_rng(10))
    response = excursion.bla(take)
    np.testing.assert_array_equal(response.frequency, FREQUENCY)
    np.testing.assert_allclose(response.value, admittance_and_motion(FREQUENCY)[0], rtol=1e-10)
    assert (response.input, response.output, response.method) == ("voltage", "current", "periods")
    assert response.level == 2.0 and excursion.bla(take, level=0).level == 1.0
    assert response.odd.db < -200 and response.even.db < -200
    impedance = response.inverse()
    np.testing.assert_allclose(impedance.value, 1 / admittance_and_motion(FREQUENCY)[0], rtol=1e-10)
    assert (impedance.input, impedance.output) == ("current", "voltage")


def test_the_noise_of_a_response():
    noise, periods, realizations = 1e-3, 6, 4
    take = take_of(np.random.default_rng(11), noise=noise, periods=periods)
    response = excursion.bla(take)
    line = 2.0 * PERIOD / np.sqrt(2 * LINES.size)  # of the voltage, as rfft has it
    expected = noise**2 * PERIOD / line**2 / (periods * realizations)
    assert np.mean(response.noise_variance) == pytest.approx(expected, rel=0.1)
    spread = np.abs(response.value - admittance_and_motion(FREQUENCY)[0]) ** 2
    assert np.mean(spread) == pytest.approx(expected, rel=0.25)


def test_even_distortion_of_a_known_bend():
    """What a square adds stands on even lines alone; its power is what NumPy finds there."""
    take = take_of(np.random.default_rng(12), bend=0.004)
    response = excursion.bla(take)
    power = np.zeros(PERIOD // 2 + 1)
    for realization in range(4):
        power += np.abs(np.fft.rfft(take.periods("current", -1, realization)[0])) ** 2
    band = slice(LINES[0], LINES[-1] + 1)
    even = power[band][(np.arange(LINES[0], LINES[-1] + 1) % 2) == 0].sum()
    assert response.even.db == pytest.approx(10 * np.log10(even / power[band].sum()), abs=0.2)
    assert response.even.significant and response.odd.db < -200
    table = response.table()
    np.testing.assert_allclose(table["magnitude"], np.abs(response.value))
    np.testing.assert_allclose(table["phase"], np.degrees(np.angle(response.value)))


def test_cross_spectra_of_a_record_without_periods():
    draw = np.random.default_rng(13)
    taps = scipy.signal.firwin(65, 2000, fs=RATE)
    voltage = draw.standard_normal(1 << 17)
    current = scipy.signal.lfilter(taps, 1.0, voltage)
    response = excursion.bla(excursion.Take(RATE, voltage=voltage, current=current), segment=4096)
    assert response.method == "welch"
    passed = (response.frequency > 50) & (response.frequency < 1500)
    _, expected = scipy.signal.freqz(taps, worN=response.frequency[passed], fs=RATE)
    np.testing.assert_allclose(response.value[passed], expected, atol=0.03)


def test_a_simulation_in_steady_state():
    """The last period of a simulation is the multisine times the closed form of the response."""
    spectra = multisines(np.random.default_rng(14), [2.0], 1)
    model = excursion.Model.linear(**WOOFER)
    simulation = excursion.simulate(model, record(spectra, 12), RATE)
    assert simulation.converged
    current, displacement = admittance_and_motion(FREQUENCY)
    s = 2j * np.pi * FREQUENCY
    for quantity, response in {
        "current": current,
        "displacement": displacement,
        "velocity": s * displacement,
        "acceleration": s**2 * displacement,
        "pressure": 1.2 * 0.01 / (2 * np.pi) * s**2 * displacement,
    }.items():
        expected = np.fft.irfft(through(spectra, response)[0], PERIOD)
        error = simulation[quantity][-PERIOD:] - expected
        assert np.std(error) < 1e-4 * np.std(expected), quantity
    assert simulation.table().loc["current", "rms"] == pytest.approx(np.sqrt(np.mean(simulation["current"] ** 2)))


def test_a_simulation_from_rest():
    """A cone under a slow push: scipy's lsim on a grid 8 times finer is the truth."""
    m, rms, k = 0.012, 1.5, 1500.0
    time = np.arange(0, 0.25, 1 / RATE)
    push = 3.0 * np.sin(2 * np.pi * 30 * time) * np.sin(np.pi * time / 0.25) ** 4
    found = excursion.simulate(excursion.Model.linear(m=m, Rms=rms, K=k), push, RATE)
    fine = np.arange(8 * (time.size - 1) + 1) / (8 * RATE)
    fine_push = 3.0 * np.sin(2 * np.pi * 30 * fine) * np.sin(np.pi * fine / 0.25) ** 4
    system = scipy.signal.lti([1.0], [m, rms, k])
    _, expected, _ = scipy.signal.lsim(system, fine_push, fine)
    assert np.max(np.abs(found["displacement"] - expected[::8])) < 1e-5 * np.max(np.abs(expected))


def test_a_fit_finds_known_parameters():
    """Every parameter within 5 standard errors of what the take was made of."""
    draw = np.random.default_rng(15)
    levels, realizations, repetitions = [1.0, 2.0], 3, 3
    spectra = multisines(draw, levels, realizations)
    current, displacement = admittance_and_motion(FREQUENCY)
    measured = {
        "voltage": record(spectra, repetitions),
        "current": record(through(spectra, current), repetitions),
        "displacement": record(through(spectra, displacement), repetitions),
    }
    for quantity in ("current", "displacement"):
        noise = 1e-3 * np.std(measured[quantity])
        measured[quantity] = measured[quantity] + noise * draw.standard_normal(measured[quantity].size)
    take = excursion.Take(
        RATE,
        excitation=excursion.Excitation(
            period=PERIOD, settle_periods=1, periods=2, realizations=realizations, levels=levels, lines=LINES
        ),
        **measured,
    )
    fit = excursion.fit(take)
    assert fit.converged and fit.model.effects == []
    for name, true in WOOFER.items():
        row = fit.parameters.loc["electrodynamic", name]
        assert abs(row["value"] - true) < 5 * row["standardError"], name
        assert row["standardError"] < 0.02 * true, name
        assert fit.model[name] == row["value"]
    for channel in ("current", "displacement"):
        assert fit.error.loc[channel, "db"] < fit.error.loc[channel, "noiseFloorDb"] + 0.5


def test_excitations_are_what_their_plan_says():
    plan = excursion.excite(
        [0.5, 2.0], rate=16000, period=2048, periods=2, settle=1, realizations=2, band=(50, 2000), grid="odd", seed=5
    )
    e, take = plan.excitation, plan.take
    assert (e.period, e.periods, e.settle_periods, e.realizations, e.levels) == (2048, 2, 1, 2, (0.5, 2.0))
    assert len(take) == e.samples
    for level, rms in enumerate(e.levels):
        for realization in range(2):
            first, second = take.periods("voltage", level, realization)
            np.testing.assert_allclose(first, second, atol=1e-6)
            assert np.sqrt(np.mean(first**2)) == pytest.approx(rms, rel=1e-4)
            power = np.abs(np.fft.rfft(first)) ** 2
            np.testing.assert_array_equal(np.flatnonzero(power > 1e-6 * power.max()), e.lines)
    assert all(line % 2 == 1 and 50 <= line * 16000 / 2048 <= 2000 for line in e.lines)
    np.testing.assert_allclose(plan.table()["peak"], [np.max(np.abs(half)) for half in np.split(take["voltage"], 2)])
    again = excursion.excite(
        [0.5, 2.0], rate=16000, period=2048, periods=2, settle=1, realizations=2, band=(50, 2000), grid="odd", seed=5
    )
    np.testing.assert_array_equal(again.take["voltage"], take["voltage"])


A = np.array([[-40.0, 300.0, 0.0], [-300.0, -40.0, 0.0], [0.0, 0.0, -2000.0]])
B, C, D = np.array([[1.0], [0.5], [30.0]]), np.array([[20.0, -3.0, 7.0]]), np.array([[0.1]])


def test_state_spaces_have_the_response_that_scipy_finds():
    frequency = np.geomspace(1, 5000, 200)
    model = excursion.StateSpace(A, B, C, D)
    _, expected = scipy.signal.freqresp((A, B, C, D), 2 * np.pi * frequency)
    np.testing.assert_allclose(model.response(frequency), expected, rtol=1e-9)
    discrete = scipy.signal.cont2discrete((A, B, C, D), 1 / 16000, "zoh")
    _, expected = scipy.signal.dfreqresp(discrete, 2 * np.pi * frequency / 16000)
    model = excursion.StateSpace(*discrete[:4], rate=16000)
    np.testing.assert_allclose(model.response(frequency), expected, rtol=1e-9)


def test_a_known_system_is_identified_from_its_response(tmp_path):
    frequency = np.geomspace(2, 3000, 150)
    response = excursion.Response(frequency, excursion.StateSpace(A, B, C, D).response(frequency))
    found = excursion.identify(response, [1, 2, 3])
    assert found.chosen == 3 and found.stable
    np.testing.assert_allclose(np.sort_complex(found.model.poles), np.sort_complex(np.linalg.eigvals(A)), rtol=1e-6)
    np.testing.assert_allclose(found.model.response(frequency), response.value, rtol=1e-7)
    numerator, _ = scipy.signal.ss2tf(A, B, C, D)
    np.testing.assert_allclose(np.sort_complex(found.zeros), np.sort_complex(np.roots(numerator[0])), rtol=1e-5)
    assert list(found.table().index) == [1, 2, 3]
    found.model.write(tmp_path / "model.json")
    again = excursion.StateSpace.read(tmp_path / "model.json")
    np.testing.assert_array_equal(again.A, found.model.A)


def test_a_fractional_system_is_identified():
    frequency = np.geomspace(5, 5000, 120)
    truth = excursion.StateSpace([[-30.0]], [[1.0]], [[12.0]], [[0.2]], alpha=0.6)
    value = truth.response(frequency)
    np.testing.assert_allclose(value, 0.2 + 12.0 / ((2j * np.pi * frequency) ** 0.6 + 30.0), rtol=1e-12)
    found = excursion.identify(excursion.Response(frequency, value, noise_variance=np.full(120, 1e-8)), 1, alpha="free")
    assert found.model.alpha == pytest.approx(0.6, abs=1e-3)
    np.testing.assert_allclose(found.model.response(frequency), value, rtol=1e-3)


def test_a_mixed_impedance_is_identified():
    frequency = np.geomspace(10, 10000, 150)
    s, resonance, quality = 2j * np.pi * frequency, 2 * np.pi * 60, 3.0
    impedance = 5.0 + 0.02 * s**0.7 + 2500 * s / (s**2 + resonance / quality * s + resonance**2)
    response = excursion.Response(
        frequency, impedance, input="current", output="voltage", noise_variance=np.full(150, 1e-8)
    )
    found = excursion.identify(response, alpha="free", mixed=True, output="voltage", input="current")
    expected = {
        "resistance": 5.0,
        "semiInductance": 0.02,
        "alpha": 0.7,
        "motional": 2500,
        "resonance": 60,
        "quality": 3,
    }
    for name, value in expected.items():
        assert found.table().loc[name, "value"] == pytest.approx(value, rel=1e-4), name
    assert found.error_db < -80


def test_motor_and_cone_are_told_apart():
    """The sound of a cone that is a piston up to a resonance of its own."""
    draw = np.random.default_rng(17)
    spectra = multisines(draw, [2.0], 3)
    s = 2j * np.pi * FREQUENCY
    cone = 3.0 / (1 + s / (2 * np.pi * 1500 * 2) + (s / (2 * np.pi * 1500)) ** 2)
    displacement = admittance_and_motion(FREQUENCY)[1]
    measured = {"displacement": displacement, "pressure": cone * s**2 * displacement}
    samples = {quantity: record(through(spectra, response), 3) for quantity, response in measured.items()}
    for quantity, values in samples.items():
        samples[quantity] = values + 1e-5 * np.std(values) * draw.standard_normal(values.size)
    e = excursion.Excitation(
        period=PERIOD, settle_periods=1, periods=2, realizations=3, levels=[2.0], grid="odd-random", lines=LINES
    )
    take = excursion.Take(RATE, voltage=record(spectra, 3), excitation=e, **samples)
    found = excursion.identify(take, 3, cone=2, delay=0.0)
    np.testing.assert_allclose(found.cone.response(FREQUENCY), cone, rtol=2e-3)
    np.testing.assert_allclose(found.motor.response(FREQUENCY)[:, 0, 0], displacement, rtol=2e-3)
    assert found.motor.outputs == ["displacement", "velocity", "acceleration"]
    assert found.table().loc["cascade", "errorDb"] < -50


def test_truncation_keeps_its_bound():
    frequency = np.geomspace(0.1, 1e5, 2000)
    model = excursion.StateSpace(A, B, C, D)
    reduced = excursion.reduce(model, 2)
    assert reduced.model.order == 2 and reduced.stable
    change = np.max(np.abs(reduced.model.response(frequency) - model.response(frequency)))
    assert 0 < change <= reduced.bound * (1 + 1e-9)
    assert reduced.bound == pytest.approx(2 * reduced.singular_values[2], rel=1e-9)


def test_unstable_poles_are_mirrored_and_split_off():
    unstable = excursion.StateSpace(np.diag([-100.0, 50.0]), [[1.0], [1.0]], [[3.0, 2.0]], [[0.0]])
    mirrored = excursion.stabilize(unstable, "mirror", refit=False)
    assert mirrored.stable
    np.testing.assert_allclose(np.sort(mirrored.model.poles.real), [-100.0, -50.0], rtol=1e-9)
    split = excursion.stabilize(unstable, "decompose")
    frequency = np.geomspace(0.1, 1000, 50)
    both = split.model.response(frequency) + split.unstable.response(frequency)
    np.testing.assert_allclose(both, unstable.response(frequency), rtol=1e-9)


def test_a_polynomial_model_of_its_own_class_is_found():
    """x(t+1) = 0.7 x + 0.5 u + 0.1 x², y = x: a model of order 1 and degree 2 explains all of it."""
    draw = np.random.default_rng(16)
    periods = draw.standard_normal((3, 1024)) * 0.4
    voltage = np.concatenate([np.tile(period, 3) for period in periods])
    current = np.zeros(voltage.size)
    for t in range(voltage.size - 1):
        current[t + 1] = 0.7 * current[t] + 0.5 * voltage[t] + 0.1 * current[t] ** 2
    e = excursion.Excitation(
        period=1024, settle_periods=1, periods=2, realizations=3, levels=[0.4], lines=np.arange(1, 512)
    )
    found = excursion.pnlss(
        excursion.Take(8000, voltage=voltage, current=current, excitation=e), 1, degree=2, played=True
    )
    assert found.validation_db < -100 and found.stable
    np.testing.assert_allclose(found.linear.poles, [0.7], atol=1e-3)
    assert np.std(found.played["current"] - current) < 1e-4 * np.std(current)
    judged = excursion.pnlss(excursion.Take(8000, voltage=voltage, current=current, excitation=e), model=found.model)
    assert judged.validation_db == pytest.approx(found.validation_db, abs=0.1)
    assert (2, 0) in found.table().index


def test_a_csv_becomes_a_take(tmp_path):
    (tmp_path / "measured.csv").write_text("V1;x\n1,5;2\n-0,5;4\n2;1\n3;0\n")
    take = excursion.import_take(
        tmp_path / "measured.csv", channels={"V1": "voltage", "x": "displacement:mm"}, rate=1000
    )
    assert take.rate == 1000
    np.testing.assert_allclose(take["voltage"], [1.5, -0.5, 2.0, 3.0])
    np.testing.assert_allclose(take["displacement"], [2e-3, 4e-3, 1e-3, 0.0], atol=1e-9)
