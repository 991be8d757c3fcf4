# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes with periodic multisines, and what is known to be hidden in them."""

import json
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.io import wavfile

MOTIONS = ("displacement", "velocity", "acceleration")


@dataclass
class Take:
    """Averaged periods: spectra[quantity] is sections by lines, a section is one realization of
    one level. noise[quantity] has the variance of the averaged spectrum, of the same shape."""

    rate: float
    period: int
    level_of: np.ndarray
    band: tuple
    spectra: dict
    noise: dict
    heat: np.ndarray  # sections by histories, A^2: how warm the coil is
    distance: float

    @property
    def frequency(self):
        return np.arange(self.period // 2 + 1) * self.rate / self.period

    def motion(self):
        return next((q for q in MOTIONS if q in self.spectra), None)


def read_take(folder):
    """Reads a folder with measurement.json and its WAV."""
    folder = Path(folder)
    about = json.loads((folder / "measurement.json").read_text())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", wavfile.WavFileWarning)
        _, samples = wavfile.read(folder / about["audio"])
    samples = samples.reshape(len(samples), -1)
    channels = {c["quantity"]: samples[:, n].astype(float) * c["fullScale"]
                for n, c in enumerate(about["channels"])}
    return make_take(channels, about["sampleRate"], about["excitation"],
                     about.get("driver", {}).get("microphoneDistance") or 0.0)


def make_take(channels, rate, excitation, distance=0.0):
    """Averages the kept periods of every section.
    channels: by quantity, samples in SI units; excitation: as in measurement.json."""
    period, settle, kept = (excitation[k] for k in ("period", "settlePeriods", "periods"))
    levels, realizations = len(excitation["levels"]), excitation["realizations"]
    sections = levels * realizations
    shape = (sections, settle + kept, period)
    level_of = np.repeat(np.arange(levels), realizations)
    spectra, noise = {}, {}
    for quantity, samples in channels.items():
        periods = samples[:np.prod(shape)].reshape(shape)[:, settle:]
        lines = np.fft.rfft(periods, axis=2) / period
        spectra[quantity] = lines.mean(axis=1)
        scatter = np.abs(lines - spectra[quantity][:, None]) ** 2
        variance = scatter.sum(axis=1) / max(1, kept * (kept - 1))
        noise[quantity] = smooth(variance, level_of)
    heat = None
    if "current" in channels:
        heat = heat_histories(channels["current"], shape, settle, rate)
    return Take(rate, period, level_of, tuple(excitation["band"]), spectra, noise, heat, distance)


def smooth(variance, level_of, width=41):
    """The mean over neighbouring lines and over the realizations of a level."""
    kernel = np.ones(width)
    count = np.convolve(np.ones(variance.shape[1]), kernel, mode="same")
    result = np.empty_like(variance)
    for level in np.unique(level_of):
        mine = level_of == level
        result[mine] = np.convolve(variance[mine].mean(axis=0), kernel, mode="same") / count
    return result


def heat_histories(current, shape, settle, rate, constants=(0.3, 1.0, 3.0, 10.0)):
    """Mean i^2 of each section, and i^2 through first-order lags (time constants in s) along the
    whole record, averaged over the section's kept periods."""
    sections, periods, period = shape
    block = max(1, period // 64)
    power = current[:sections * periods * period] ** 2
    power = power[:len(power) // block * block].reshape(-1, block).mean(axis=1)
    rows = [power]
    for constant in constants:
        keep = np.exp(-block / rate / constant)
        state, out = 0.0, np.empty_like(power)
        for n, value in enumerate(power):
            state = keep * state + (1.0 - keep) * value
            out[n] = state
        rows.append(out)
    means = []
    for section in range(sections):
        begin = (section * periods + settle) * period // block
        end = (section + 1) * periods * period // block
        means.append([row[begin:end].mean() for row in rows])
    return np.array(means)


def read_study(folder):
    """Yields name, folder of the take and truth of every take that a study kept."""
    def order(path):
        return (0, int(path.name), "") if path.name.isdigit() else (1, 0, path.name)

    for entry in sorted((p.parent for p in Path(folder).glob("*/truth.json")), key=order):
        truth = json.loads((entry / "truth.json").read_text())
        yield entry.name, entry / "take", truth
