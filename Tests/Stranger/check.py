#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""check.py [SEED...]: does the simulator do what it should?

1. At vanishing level, with all effects in, it agrees with the closed-form linear response to -105 dB.
2. Half the step changes the loudest period by less than -115 dB.
The first compares on a line Re(s) = sigma > 0, so that neither settling nor the record's end matters.
"""
import sys
import types
try:
    import numpy as np
except ImportError:
    print("SKIPPED: numpy is not installed.")
    sys.exit(77)
import draw
import make
import takes


def closed_form(p, s, on):
    """What each reading is for 1 V of input, by hand from circuit theory."""
    get = lambda name: np.atleast_1d(p.get(name, []))
    Z = p["Re"] + s * p["Le"]
    if "eddy-currents" in on:
        for R, L in zip(get("eddy.R"), get("eddy.L")):
            Z = Z + s * L * R / (R + s * L)
    C = 1 / p["K"]
    if "creep" in on:
        C = C + sum(1 / (k + s * c) for k, c in zip(get("creep.K"), get("creep.C")))
    Zm = s * p["m"] + p["Rms"] + 1 / (C * s)
    if "friction" in on:
        Zm = Zm + p["friction.stiffness"] / s + (p["friction.viscous"] if p["friction.kind"] == 2 else 0)
    for m, f, loss in zip(get("side.mass"), get("side.hz"), get("side.loss")):
        w = 2 * np.pi * f
        pull = w * w + s * w * loss
        Zm = Zm + s * m * (pull / (s * s + pull) if "side-resonance" in on else 1)
    if "rub" in on:
        Zm = Zm + p["rub.force"] * (1 + np.tanh(-p["rub.at"] / p["rub.width"])) / 2 / p["rub.speed"]
    port = 0 * s                                 # displacement of the port per displacement of the cone
    if "vented-box" in on or "closed-box" in on:
        ka, ra, leak, Sp = 1.4 * 101325 / p["box.volume"], p.get("box.absorb", 0), p["box.leak"], p["port.area"]
        per_volume = -(ka + ra * s) / (1 + ra * leak + ka * leak / s)
        if "vented-box" in on:
            moves = s * s * p["port.mass"] + s * p["port.loss"]
            port = Sp * per_volume * p["Sd"] / (moves - Sp * Sp * per_volume)
        Zm = Zm - p["Sd"] * per_volume * (p["Sd"] + Sp * port) / s
    corner, ohms = 2 * np.pi * p.get("amp.corner", 0), p.get("amp.ohms", 0)
    source = s / (s + corner)
    i = source / (Z + ohms + p["Bl"] ** 2 / Zm)
    v = p["Bl"] * i / Zm
    a, x = v * s, v / s
    sound, spot = p["Sd"] * a, x
    if "cone-breakup" in on:
        for f, q, g, h in zip(get("bend.hz"), get("bend.q"), get("bend.sound"), get("bend.laser")):
            w = 2 * np.pi * f
            mode = a / (s * s + s * w / q + w * w)
            sound, spot = sound + g * p["Sd"] * s * s * mode, spot + h * mode
    sound = sound + p.get("port.share", 1) * p["port.area"] * port * x * s * s if "vented-box" in on else sound
    r = p["mic.distance"]
    return {"u": source - ohms * i, "i": i, "x": x, "v": v, "a": a, "laser": spot,
            "p": 1.2 / (2 * np.pi * r) * sound * np.exp(-s * r / 343.2)}


def vanishing(t):
    """Worst channel's error, dB, of a record that rises smoothly from rest."""
    rate, n = t.rate, int(0.7 * t.rate)
    d = draw.Draw(5)
    time = np.arange(n * 2 * t.oversample) / (rate * 2 * t.oversample)
    spectrum = takes.multisine(d, n, np.arange(int(t.band[0] * 0.7) + 1, int(t.band[1] * 0.7)), t.shape)
    u = takes.fine(spectrum, n, 2 * t.oversample) * np.sin(np.pi * time / 0.7) ** 6
    on = [e for e in t.on() if e not in ("wander", "jump")]
    gain = t.gain * 1e-7
    y = takes.run(t.p, on, [(u, gain, 1, 1.0, 1.0)], rate, t.oversample)
    sigma = 24 / 0.7
    weight = np.exp(-sigma * np.arange(n) / rate)
    f = np.fft.rfftfreq(n, 1 / rate)
    band = (f >= t.band[0]) & (f <= t.band[1] * 0.97)
    U = np.fft.rfft(u[::2 * t.oversample] * gain * weight)[band]
    worst = -400.0
    for name, H in closed_form(t.p, sigma + 2j * np.pi * f[band], on).items():
        Y = np.fft.rfft(y[:, takes.BEST[name]] * weight)[band]
        worst = max(worst, 10 * np.log10(np.sum(abs(Y - H * U) ** 2) / np.sum(abs(Y) ** 2)))
    return worst


def main():
    seeds = [int(w) for w in sys.argv[1:]] or range(1, 13)
    bad = 0
    for seed in seeds:
        d = draw.Draw(seed)
        name = list(draw.CLASSES)[seed % 6]
        o = types.SimpleNamespace(kind="unknown", hide="", no="", channels="V+I+x+p", driver=name,
                                  signal="multisine", bench="real",
                                  box=["none", "closed", "vented"][seed % 3], unknown=draw.UNKNOWN[seed % 5])
        o.hide = ",".join(e for e in draw.EFFECTS if o.box == "vented" or e not in ("vented-box", "port-and-air"))
        t = make.Take(d, o)
        t.p["amp.ohms"], t.p["amp.corner"] = d.u(0.02, 0.3), d.u(1, 3)
        t.set_up()
        half = t.halving()
        linear = vanishing(t)
        good = half < -115 and linear < -105
        bad += not good
        print(f"seed {seed}: {name} {o.box} + {o.unknown}, {t.kinds['friction']}, creep: {t.kinds['creep']}, "
              f"eddy: {t.kinds['eddy-currents']}: linear limit {linear:.1f} dB, half step {half:.1f} dB at "
              f"{t.rate * t.oversample / 1e3:.0f} kHz{'' if good else '  NOT GOOD'}", flush=True)
    return bad


if __name__ == "__main__":
    sys.exit(main())
