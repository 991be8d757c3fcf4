# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes: from arrays, to files and back, and everything that makes no take."""

from __future__ import annotations

import json

import numpy as np
import pytest
import soundfile

import excursion

RATE = 8000
EXCITATION = excursion.Excitation(
    period=64,
    settle_periods=1,
    periods=2,
    realizations=2,
    levels=(0.5, 2.0),
    grid="odd",
    shape="pink",
    band=(125.0, 3000.0),
    lines=(1, 3, 7),
)


def some(draw: np.random.Generator, samples: int = 768) -> dict[str, np.ndarray]:
    scales = {"voltage": 7.3, "current": 1.1, "displacement": 3e-3, "pressure": 12.0}
    return {quantity: scale * draw.standard_normal(samples) for quantity, scale in scales.items()}


def test_a_take_is_read_as_it_was_written_to_the_last_bit(tmp_path):
    samples = some(np.random.default_rng(1))
    driver = excursion.Driver("Tieftöner", cone_area=0.0213, microphone_distance=0.5)
    remarks = ["The voltage is assumed."]
    take = excursion.Take(44100.5, excitation=EXCITATION, driver=driver, coupling=2.5, remarks=remarks, **samples)
    take.write(tmp_path / "größer als µ")
    again = excursion.Take.read(tmp_path / "größer als µ")
    assert again.rate == 44100.5
    assert again.excitation == EXCITATION
    assert again.driver == driver
    assert again.coupling == 2.5
    assert again.remarks == ("The voltage is assumed.",)
    assert list(again) == list(samples)
    for quantity, values in samples.items():
        np.testing.assert_array_equal(again[quantity], values)


def test_the_program_sees_the_same_numbers():
    samples = some(np.random.default_rng(2), 40000)
    table = excursion.check(excursion.Take(RATE, **samples)).table()
    for quantity, values in samples.items():
        assert table.loc[quantity, "rms"] == pytest.approx(np.sqrt(np.mean(values**2)), rel=1e-3)
        assert table.loc[quantity, "peak"] == pytest.approx(np.max(np.abs(values)), rel=1e-9)


def test_arrays_may_be_in_other_units():
    one = np.array([1.0, -2.0, 3.0])
    take = excursion.Take(
        RATE,
        voltage=[1, 2, 3],
        current=one,
        displacement=one,
        pressure=one,
        units={"current": "mA", "displacement": "µm", "pressure": "kPa"},
    )
    np.testing.assert_allclose(take["voltage"], [1.0, 2.0, 3.0])
    np.testing.assert_allclose(take["current"], one * 1e-3)
    np.testing.assert_allclose(take["displacement"], one * 1e-6)
    np.testing.assert_allclose(take["pressure"], one * 1e3)
    assert take.units == {"voltage": "V", "current": "A", "displacement": "m", "pressure": "Pa"}
    analogue = excursion.Take(RATE, force=one, displacement=one, units={"force": "V", "displacement": "V"})
    assert analogue.units == {"force": "V", "displacement": "V"}


def test_a_recording_of_a_sound_card_is_read(tmp_path):
    counts = np.array([[16384, -32768], [0, 8192]], dtype=np.int16)
    soundfile.write(tmp_path / "recorded.wav", counts, RATE, subtype="PCM_16")
    (tmp_path / "measurement.json").write_text(
        json.dumps(
            {
                "format": "excursion-measurement",
                "version": 1,
                "sampleRate": RATE,
                "audio": "recorded.wav",
                "channels": [
                    {"quantity": "voltage", "unit": "V", "fullScale": 20.0},
                    {"quantity": "displacement", "unit": "mm", "fullScale": 4.0},
                ],
                "excitation": {"kind": "music"},
            }
        )
    )
    take = excursion.Take.read(tmp_path)
    np.testing.assert_array_equal(take["voltage"], [10.0, 0.0])
    np.testing.assert_allclose(take["displacement"], [-4e-3, 1e-3])
    assert take.excitation is None


def test_periods_come_level_by_level():
    e = EXCITATION
    take = excursion.Take(RATE, excitation=e, voltage=np.arange(e.samples, dtype=float))
    loudest = take.periods("voltage", -1, 1)
    assert loudest.shape == (2, 64)
    assert loudest[0, 0] == (2 * 2 * 3 - 2) * 64
    assert loudest[-1, -1] == e.samples - 1
    assert take.periods("voltage", 0, 0)[0, 0] == 64
    np.testing.assert_array_equal(take.periods("voltage", 1, 1), loudest)
    with pytest.raises(excursion.Error, match="2 levels of 2 realizations"):
        take.periods("voltage", 2)
    with pytest.raises(excursion.Error, match="no periods"):
        excursion.Take(RATE, voltage=[1.0]).periods("voltage")


def test_a_table_has_the_time():
    table = excursion.Take(RATE, voltage=[1.0, 2.0], current=[3.0, 4.0]).table()
    assert list(table.columns) == ["voltage", "current"]
    np.testing.assert_array_equal(table.index, [0.0, 1 / RATE])


@pytest.mark.parametrize(
    ("arguments", "kind", "says"),
    [
        ({"voltage": [1.0, np.nan, 2.0]}, "input", "Sample 1 of voltage is not a finite number"),
        ({"voltage": [1.0, 2.0], "current": [np.inf, 1.0]}, "input", "Sample 0 of current"),
        ({"voltage": [1.0, 2.0], "current": [1.0]}, "data", "2 samples of voltage, but 1 of current"),
        ({"voltage": [1.0], "loudness": [1.0]}, "usage", "no quantity 'loudness'.*voltage, current"),
        ({"voltage": [1.0], "units": {"voltage": "mm"}}, "input", "unit 'mm' is none of voltage"),
        ({"voltage": [1.0], "units": {"volume": "V"}}, "usage", "no quantity 'volume'"),
        ({"current": [1.0]}, "data", "needs a voltage, or a force"),
        ({"voltage": np.ones((2, 3))}, "usage", r"shape \(2, 3\)"),
        ({"voltage": []}, "usage", r"shape \(0,\)"),
        ({"voltage": 1.0}, "usage", r"shape \(\)"),
        ({"voltage": [1j]}, "usage", "complex128, expected real"),
        ({"voltage": ["1"]}, "usage", "expected real"),
        ({"voltage": [1.0], "rate": 0}, "usage", "1 Hz to 100 MHz"),
        ({"voltage": [1.0], "rate": np.nan}, "usage", "1 Hz to 100 MHz"),
        ({"voltage": np.ones(700), "excitation": EXCITATION}, "data", "768 samples long, but the take has 700"),
    ],
)
def test_what_is_no_take_is_refused(arguments, kind, says):
    with pytest.raises(excursion.Error, match=says) as refused:
        excursion.Take(**{"rate": RATE, **arguments})
    assert refused.value.kind == kind


def test_what_was_changed_afterwards_is_looked_at_again(tmp_path):
    take = excursion.Take(RATE, voltage=np.ones(8))
    take["voltage"][5] = np.nan
    with pytest.raises(excursion.Error, match="Sample 5 of voltage"):
        take.write(tmp_path / "take")
    with pytest.raises(excursion.Error, match="Sample 5 of voltage"):
        excursion.check(take)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"period": 3}, "3 for period"),
        ({"period": 64.5}, "64.5 for period"),
        ({"periods": 0}, "0 for periods"),
        ({"realizations": 0}, "0 for realizations"),
        ({"settle_periods": -1}, "-1 for settle_periods"),
        ({"levels": (2.0, 1.0)}, "quiet to loud"),
        ({"levels": ()}, "V rms above 0"),
        ({"levels": (0.0,)}, "V rms above 0"),
    ],
)
def test_impossible_excitations_are_refused(change, says):
    with pytest.raises(excursion.Error, match=says) as refused:
        excursion.Excitation(**{"period": 64, "periods": 2, "levels": (1.0,), **change})
    assert refused.value.kind == "usage"


@pytest.fixture
def kept(tmp_path):
    excursion.Take(RATE, excitation=EXCITATION, **some(np.random.default_rng(3))).write(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"version": 2}, "version 2 of excursion-measurement, expected 1"),
        ({"version": None}, "version None"),
        ({"format": "excursion-model"}, "format 'excursion-model', expected excursion-measurement"),
        ({"audio": "gone.wav"}, "gone.wav' cannot be read"),
        ({"audio": "../take.wav"}, "WAV in the same folder"),
        ({"channels": [{"quantity": "voltage", "unit": "V", "fullScale": 1.0}]}, "4 channels, but 1 are named"),
        ({"channels": [{"quantity": "voltage", "unit": "V", "fullScale": 1.0}] * 4}, "A quantity is there twice"),
        ({"channels": [{"quantity": "speed", "unit": "V", "fullScale": 1.0}] * 4}, "no quantity 'speed'"),
        ({"channels": [{"quantity": "voltage", "unit": "mm", "fullScale": 1.0}] * 4}, "unit 'mm' is none of voltage"),
        ({"channels": [{"quantity": "voltage"}]}, "not a measurement.json: KeyError at 'unit'"),
        ({"channels": 7}, "not a measurement.json"),
        ({"sampleRate": "fast"}, "not a measurement.json"),
        ({"sampleRate": 0.1}, "1 Hz to 100 MHz"),
        ({"excitation": {"kind": "multisine"}}, "KeyError"),
        (
            {
                "excitation": {
                    "kind": "multisine",
                    "period": 64,
                    "settlePeriods": 0,
                    "periods": 2,
                    "realizations": 2,
                    "levels": [2.0, 1.0],
                }
            },
            "quiet to loud",
        ),
    ],
)
def test_broken_folders_are_refused(kept, change, says):
    place = kept / "measurement.json"
    place.write_text(json.dumps({**json.loads(place.read_text()), **change}))
    with pytest.raises(excursion.Error, match=says) as refused:
        excursion.Take.read(kept)
    assert refused.value.kind == "input"
    assert str(kept) in str(refused.value)


def test_broken_files_are_refused(kept, tmp_path):
    with pytest.raises(excursion.Error, match="cannot be read"):
        excursion.Take.read(tmp_path / "nowhere")
    (tmp_path / "empty").mkdir()
    with pytest.raises(excursion.Error, match=r"has no measurement\.json"):
        excursion.Take.read(tmp_path / "empty")
    wav = (kept / "take.wav").read_bytes()
    (kept / "take.wav").write_bytes(wav[: len(wav) // 2])
    with pytest.raises(excursion.Error, match="768 samples long, but the take has"):
        excursion.Take.read(kept)
    (kept / "take.wav").write_bytes(b"")
    with pytest.raises(excursion.Error, match="cannot be read"):
        excursion.Take.read(kept)
    for text in ("", "{", "[]", "\x00", '{"format": 1}'):
        (kept / "measurement.json").write_text(text)
        with pytest.raises(excursion.Error) as refused:
            excursion.Take.read(kept)
        assert refused.value.kind == "input"
    (kept / "measurement.json").write_bytes(b"\xff\xfe{}")
    with pytest.raises(excursion.Error, match="UTF-8"):
        excursion.Take.read(kept)
    with pytest.raises(excursion.Error, match="cannot be written"):
        excursion.Take(RATE, voltage=[1.0]).write(kept / "take.wav" / "below a file")
