#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""play.py EXCURSION MODEL SEED OUT [options of make.py]: what predistortion is worth on the loudspeaker itself.

The loudspeaker of `make.py SEED OUT ...` plays an odd multisine that no fit has heard, as it is and predistorted by the
model that was found from the take OUT; no amplifier's high-pass in between. Told is the power between the excited lines
over that on them, dB, of displacement and pressure.
"""
import os
import subprocess
import sys
import tempfile
import numpy as np
import bench
import draw
import make
import takes

SHARE = 0.9                        # of the excursion in the take
LEVELS = (0, -6, -12, -20)         # dB


def read_wav(path):
    """The first channel of a RIFF of floats."""
    data = open(path, "rb").read()
    at, width = 12, 4
    while data[at:at + 4] != b"data":
        size = int.from_bytes(data[at + 4:at + 8], "little")
        if data[at:at + 4] == b"fmt ":
            width = int.from_bytes(data[at + 22:at + 24], "little") // 8
        at += 8 + size + size % 2
    size = int.from_bytes(data[at + 4:at + 8], "little")
    return np.frombuffer(data[at + 8:at + 8 + size], {4: "<f4", 8: "<f8"}[width]).astype(float)


def odd_random(spectrum, seed):
    """The odd lines of a multisine, without one at random of each four."""
    lines = np.flatnonzero(spectrum)
    lines = takes.without_one_of_four(lines[lines % 2 == 1], np.random.default_rng(seed))
    left = np.zeros_like(spectrum)
    left[lines] = spectrum[lines]
    return left, lines


def distortion(y, lines):
    power = np.abs(np.fft.rfft(y)) ** 2
    excited = np.zeros(len(power), bool)
    excited[lines] = True
    within = np.arange(len(power))
    within = (within >= lines[0]) & (within <= lines[-1])
    return 10 * np.log10(power[within & ~excited].sum() / power[excited].sum())


def main():
    program, model = sys.argv[1:3]
    sys.argv[1:3] = []
    o = make.options()
    d = draw.Draw(o.seed)
    t = make.Take(d, o)
    faults = bench.draw(d, o.bench, t.info)
    if "ohms" in faults:
        t.p["amp.ohms"], t.p["amp.corner"] = faults["ohms"], faults["corner"]
    t.set_up()
    t.halving()
    p = {name: value for name, value in t.p.items() if not name.startswith("amp.")}
    settle = max(3, int(np.ceil(1.2 * t.rate / t.n)))

    def play(spectrum, gain):
        """One settled period, two before the end, where the decimation rings; without what drifts from end to end."""
        fine = takes.fine(spectrum, t.n, 2 * t.oversample)
        y = takes.run(p, t.on(), [(fine, gain, settle + 2, 1.0, 1.0)], t.rate, t.oversample)
        drift = y[-t.n - 1] - y[-2 * t.n - 1]
        return y[-2 * t.n:-t.n] - np.arange(1, t.n + 1)[:, None] / t.n * drift

    farthest = np.max(np.abs(t.loud(t.on(), 1)[:, 2]))
    spectrum, lines = odd_random(t.spectra[-1][0], 3)
    gain = t.gain
    for _ in range(4):
        gain *= SHARE * farthest / np.max(np.abs(play(spectrum, gain)[:, 2]))
    print(f"{t.info['class']}, box: {t.box}, {SHARE * farthest / t.info['xmax']:.2f} xmax, {', '.join(t.effects)}")
    for level in LEVELS:
        loud = gain * 10 ** (level / 20)
        u = loud * np.fft.irfft(spectrum * t.n, t.n)
        full = 4 * np.max(np.abs(u))
        with tempfile.TemporaryDirectory() as work:
            heard, bent = os.path.join(work, "in.wav"), os.path.join(work, "out.wav")
            bench.write_wav(heard, t.rate, [np.tile(u, settle + 3) / full], True)
            done = subprocess.run([program, "predistort", model, heard, bent, "--full-scale", repr(float(full)),
                                   "--limit-x", repr(float(3 * farthest))], capture_output=True, text=True)
            if done.returncode > 1:
                sys.exit(done.stderr)
            v = read_wav(bent) * full
        whole = len(v) // t.n
        before = play(spectrum, loud)
        after = play(np.fft.rfft(v[(whole - 2) * t.n:(whole - 1) * t.n]) / t.n, 1.0)
        print(f"{level:4d} dB:", "; ".join(
            f"{name} {distortion(before[:, c], lines):.1f} -> {distortion(after[:, c], lines):.1f} dB"
            for name, c in (("displacement", 2), ("pressure", 6))), flush=True)


if __name__ == "__main__":
    main()
