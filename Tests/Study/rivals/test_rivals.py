# SPDX-License-Identifier: GPL-3.0-or-later
"""The rivals on signals whose laws are known exactly. Run: python3 -m unittest in this folder."""

import contextlib
import io
import json
import tempfile
import unittest
from pathlib import Path

import numpy as np
from scipy.io import wavfile

import contest
import poles
import rivals
import scores
import sparse
from operators import resonators
from problem import make_problem
from takes import make_take, read_take

RATE, PERIOD = 8000.0, 4096
EXCITATION = {"period": PERIOD, "settlePeriods": 1, "periods": 2, "realizations": 2,
              "levels": [0.3, 1.0], "band": [20.0, 1500.0]}


def bench(bl_slope=0.0, spring_slope=0.0, noise_db=-70.0, seed=1):
    """Signals of a loudspeaker whose motion is given: the current follows from the force balance,
    the voltage from the voltage equation, and both are exact. Slopes are relative, at the peak."""
    random = np.random.default_rng(seed)
    s = 2j * np.pi * np.arange(PERIOD // 2 + 1) * RATE / PERIOD
    omega = s.imag
    excited = (omega > 2.0 * np.pi * 20.0) & (omega < 2.0 * np.pi * 700.0)
    excited[::2] = False
    channels = {"voltage": [], "current": [], "displacement": []}
    for level in (0.3, 0.3, 1.0, 1.0):
        phase = np.exp(2j * np.pi * random.random(len(s)))
        spectrum = np.where(excited, phase / (1.0 + (omega / 400.0) ** 2), 0.0)
        x = np.fft.irfft(spectrum)
        x *= 2e-3 * level / np.abs(x).max()
        lines = np.fft.rfft(x)
        v, a = np.fft.irfft(s * lines), np.fft.irfft(s ** 2 * lines)
        q = x / 2e-3
        bl = 5.0 * (1.0 + bl_slope * q)
        i = (0.012 * a + 0.9 * v + 1800.0 * (1.0 + spring_slope * q) * x) / bl
        u = 4.0 * i + 4e-4 * np.fft.irfft(s * np.fft.rfft(i)) + bl * v
        for name, signal in (("voltage", u), ("current", i), ("displacement", x)):
            channels[name].append(np.tile(signal, 3))
    result = {}
    for name, parts in channels.items():
        signal = np.concatenate(parts)
        hiss = random.standard_normal(len(signal)) * 10.0 ** (noise_db / 20.0)
        result[name] = signal + hiss * np.std(parts[-1])
    return result


def problem_of(**settings):
    return make_problem(make_take(bench(**settings), RATE, EXCITATION))


class Laws(unittest.TestCase):
    def named(self, problem, key, threshold):
        rival = contest.RIVALS[key]
        place = int(np.argmin(np.abs(rival.grid - threshold)))
        return contest.answers(problem)[key].named[place]

    def test_two_laws_are_found_by_all(self):
        problem = problem_of(bl_slope=-0.2, spring_slope=0.3, noise_db=-200.0)
        thresholds = {"slab": 1500.0, "forward": 1.0, "leave": 1.0, "stlsq": 1.0, "sr3": 1.0}
        for key in contest.present():
            self.assertEqual(self.named(problem, key, thresholds[key]),
                             {"force-factor", "stiffness"}, key)

    def test_a_linear_loudspeaker_is_left_alone(self):
        problem = problem_of()
        for key, answer in contest.answers(problem).items():
            middle = len(answer.named) * 2 // 3
            self.assertEqual(answer.named[middle], set(), key)
            if answer.textbook is not None:
                self.assertEqual(answer.textbook, set(), key)

    def test_a_law_in_noise_is_found(self):
        problem = problem_of(spring_slope=0.1)
        self.assertEqual(self.named(problem, "forward", 0.5), {"stiffness"})
        self.assertEqual(self.named(problem, "slab", 300.0), {"stiffness"})

    def test_without_motion_there_is_nothing_to_say(self):
        channels = bench()
        del channels["displacement"]
        self.assertIsNone(make_problem(make_take(channels, RATE, EXCITATION)))
        self.assertEqual(contest.answers(None)["forward"].textbook, set())


class Poles(unittest.TestCase):
    def test_a_pole_between_those_of_the_grid_is_found(self):
        s = 2j * np.pi * np.linspace(10.0, 400.0, 800)
        frequencies = np.geomspace(60.0, 170.0, 9)
        weight = np.ones(len(s))
        stack = np.array(resonators(s, frequencies, poles.QUALITIES))
        columns = np.concatenate([stack.real, stack.imag], axis=1).T
        true = np.array(resonators(s, [103.0], (7.0,)))
        target = np.concatenate([true.real, true.imag], axis=1).T @ (1.0, -2.0)
        grid = poles.Grid(columns, s, weight, frequencies)
        frequency, quality = poles.tune(grid, target, np.zeros((len(target), 1)))
        self.assertAlmostEqual(frequency / 103.0, 1.0, delta=0.01)
        self.assertAlmostEqual(quality / 7.0, 1.0, delta=0.1)


class Counting(unittest.TestCase):
    def test_faint_ones_are_neither_right_nor_wrong(self):
        truth = {"hidden": ["creep", "doppler"], "showDb": [20.0, 3.0]}
        score = scores.score([truth], [{"creep", "doppler", "friction"}])
        self.assertEqual((score.shown, score.found, score.false), (1, 1, 1))
        self.assertAlmostEqual(score.f1(), 2.0 / 3.0)

    def test_kin_of_what_is_unknown_is_no_mistake(self):
        truth = {"hidden": ["creep"], "showDb": [20.0], "oddity": "contact"}
        self.assertEqual(scores.score([truth], [{"creep", "stiffness"}]).false, 0)


class Command(unittest.TestCase):
    def test_a_folder_is_read_and_judged(self):
        with tempfile.TemporaryDirectory() as folder:
            for seed in (1, 2):
                take = Path(folder, str(seed), "take")
                take.mkdir(parents=True)
                channels = bench(spring_slope=0.3, seed=seed)
                full = {name: 2.0 * np.abs(c).max() for name, c in channels.items()}
                wavfile.write(take / "take.wav", int(RATE), np.array(
                    [c / full[name] for name, c in channels.items()]).T)
                (take / "measurement.json").write_text(json.dumps({
                    "sampleRate": RATE, "audio": "take.wav", "excitation": EXCITATION,
                    "channels": [{"quantity": n, "fullScale": f} for n, f in full.items()]}))
                Path(folder, str(seed), "truth.json").write_text(json.dumps(
                    {"hidden": ["stiffness"], "strengths": [0.3], "showDb": [40.0]}))
            again = read_take(take).spectra["current"]
            direct = make_take(channels, RATE, EXCITATION).spectra["current"]
            self.assertLess(np.abs(again - direct).max(), 1e-12 * np.abs(direct).max())
            out = Path(folder, "out.json")
            with contextlib.redirect_stdout(io.StringIO()) as text, \
                    contextlib.redirect_stderr(io.StringIO()):
                self.assertEqual(rivals.main([folder, "--json", str(out)]), 0)
            self.assertIn("forward selection", text.getvalue())
            document = json.loads(out.read_text())
            self.assertEqual(document["rivals"]["forward"]["best"]["f1"], 1.0)
            self.assertEqual("stlsq" in document["rivals"], sparse.available())


if __name__ == "__main__":
    unittest.main()
