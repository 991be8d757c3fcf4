# SPDX-License-Identifier: GPL-3.0-or-later
"""Signals, and runs of the simulator."""
import os
import subprocess
import tempfile
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
SIMULATE = os.environ.get("STRANGER_SIMULATE", os.path.join(HERE, "../../build/Tests/Stranger/stranger_simulate"))
BEST = {"u": 0, "i": 1, "x": 2, "v": 3, "a": 4, "laser": 5, "p": 6}


def without_one_of_four(lines, random):
    """Of each group of four lines one is left out at random; an incomplete last group stays."""
    keep = np.ones(len(lines), bool)
    for group in range(0, len(lines) - 3, 4):
        keep[group + random.integers(0, 4)] = False
    return lines[keep]


def lines_of(grid, period, rate, band, d):
    lo, hi = int(np.ceil(band[0] * period / rate)), int(band[1] * period / rate)
    k = np.arange(max(lo, 1), hi + 1)
    if grid == "full":
        return k
    k = k[k % 2 == 1]
    if grid == "odd":
        return k
    return without_one_of_four(k, d.r)


def multisine(d, period, lines, shape):
    """Spectrum of one period of unit rms: amplitudes by shape, random phases."""
    amplitude = {"white": np.ones(len(lines)), "pink": lines ** -0.5, "red": 1.0 / lines}[shape]
    amplitude = amplitude / np.sqrt(np.sum(amplitude ** 2) / 2)
    spectrum = np.zeros(period // 2 + 1, complex)
    spectrum[lines] = amplitude / 2 * np.exp(2j * np.pi * d.r.random(len(lines)))
    return spectrum


def fine(spectrum, period, factor):
    """The same period on a grid that is `factor` times finer."""
    full = np.zeros(period * factor // 2 + 1, complex)
    full[:len(spectrum)] = spectrum
    return np.fft.irfft(full, period * factor) * period * factor


def aperiodic(d, rate, seconds, kind, band):
    """Pink noise, or bursts and chords with a beat, as the spectrum of one long record that fades in and out."""
    n = int(rate * seconds)
    f = np.fft.rfftfreq(n, 1 / rate)
    shape = np.where((f >= band[0]) & (f <= band[1]), np.maximum(f, 1) ** -0.5, 0)
    noise = np.fft.irfft(shape * np.exp(2j * np.pi * d.r.random(len(f))), n)
    t = np.arange(n) / rate
    if kind == "music":
        beat = np.zeros(n)
        for k in range(int(seconds * 2)):
            tone = d.log(band[0] * 2, band[0] * 12)
            late = np.maximum(t - k / 2 - 0.01, 0)
            beat += d.u(0.3, 1) * np.exp(-late * d.u(3, 12)) * np.sin(2 * np.pi * tone * late) * (t > k / 2 + 0.01)
        noise = noise / np.std(noise) * (0.3 + 0.7 * np.sin(np.pi * t * 0.37) ** 2) + 2 * beat / np.std(beat)
    noise *= np.clip(np.minimum(t, seconds - t) / 0.05, 0, 1)
    spectrum = np.fft.rfft(noise / np.std(noise)) / n
    spectrum[(f < band[0] * 0.5) | (f > band[1])] = 0
    return spectrum, n


def run(p, on, blocks, rate, oversample, substeps=1, keep=None):
    """blocks: (samples on the grid of 2*oversample*substeps, gain, repeats, K scale, R scale)."""
    with tempfile.TemporaryDirectory() as work:
        text = [f"rate {rate!r}", f"oversample {oversample}", f"substeps {substeps}"]
        text += [f"on.{name} 1" for name in on]
        for name, value in p.items():
            value = [value] if np.isscalar(value) else value
            text.append(name + " " + " ".join(repr(float(v)) for v in value))
        files = {}
        for samples, gain, repeats, k, r in blocks:
            if id(samples) not in files:
                files[id(samples)] = f"{work}/{len(files)}.f64"
                samples.tofile(files[id(samples)])
            text.append(f"block {files[id(samples)]} {float(gain)!r} {repeats} {float(k)!r} {float(r)!r}")
        with open(f"{work}/setup.txt", "w") as out:
            out.write("\n".join(text) + "\n")
        if keep:
            with open(keep, "w") as out:
                out.write("\n".join(text) + "\n")
        done = subprocess.run([SIMULATE, f"{work}/setup.txt", f"{work}/out.f64"],
                              capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(done.stderr)
        return np.fromfile(f"{work}/out.f64").reshape(-1, 7)
