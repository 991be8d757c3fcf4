#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""make.py SEED OUTFOLDER --kind ... --bench ...: one take of a loudspeaker that nobody else has written.

The truth goes beside the folder, to OUTFOLDER.truth.json.
"""
import argparse
import itertools
import json
import os
import numpy as np
import bench as benches
import draw
import takes

POWER = {"micro": 2.5, "tweeter": 10, "midrange": 25, "midbass": 50, "woofer": 100, "sub": 200}
LETTERS = {"V": "u", "I": "i", "x": "x", "v": "v", "a": "a", "p": "p"}
QUANTITY = {"u": ("voltage", "V"), "i": ("current", "A"), "x": ("displacement", "m"), "v": ("velocity", "m/s"),
            "a": ("acceleration", "m/s^2"), "p": ("pressure", "Pa")}


def options():
    o = argparse.ArgumentParser(description=__doc__)
    o.add_argument("seed", type=int)
    o.add_argument("out")
    o.add_argument("--kind", default="few", choices=["control", "few", "whole", "unknown", "box", "ports"])
    o.add_argument("--bench", default="real", choices=["clean", "real", "rough"])
    o.add_argument("--hide", default="", help="effects that are to be in, with commas")
    o.add_argument("--no", default="", help="effects that are not to be in")
    o.add_argument("--channels", default="V+I+x")
    o.add_argument("--driver", default="", choices=["", *draw.CLASSES])
    o.add_argument("--box", default="", choices=["", "none", "closed", "vented"])
    o.add_argument("--unknown", default="", choices=["", *draw.UNKNOWN])
    o.add_argument("--signal", default="multisine", choices=["multisine", "pink", "music"])
    return o.parse_args()


def choose_effects(d, o, letters, box):
    want = [e for e in o.hide.split(",") if e]
    barred = {e for e in o.no.split(",") if e} | {"vented-box", "port-and-air"}
    for e in want:
        if e not in draw.EFFECTS:
            raise SystemExit(f"no effect {e}; there are " + ", ".join(draw.EFFECTS))
    if "p" not in letters:
        barred |= {"doppler", "cone-breakup"}
    count = {"control": 0, "few": d.r.integers(1, 4), "whole": d.r.integers(5, 9), "unknown": d.r.integers(1, 4),
             "box": d.r.integers(2, 4), "ports": d.r.integers(1, 3)}[o.kind]
    pool = [e for e in draw.EFFECTS if e not in barred and e not in want]
    d.r.shuffle(pool)
    effects = want + pool[:max(0, int(count) - len(want))]
    if box == "vented":
        effects += ["vented-box"]
        if "port-and-air" not in o.no and (o.kind in ("ports", "box", "few", "whole") or "port-and-air" in o.hide):
            effects += ["port-and-air"]
    return list(dict.fromkeys(e for e in draw.EFFECTS if e in effects))


def plan(d, info, bench):
    """Rate, period and counts that give 4 to 10 s, with enough lines below the resonance. The coupling of an
    amplifier takes its time to settle."""
    fast = info["class"] in ("micro", "tweeter")
    good = []
    for rate, n, levels, reals, periods in itertools.product(
            [44100, 48000, 96000], [4096, 8192, 16384, 32768], [3, 3, 4], [2, 3, 4], [2, 3, 4]):
        settle = int(np.ceil((0.3 if bench == "clean" else 0.6) * rate / n))
        seconds = n / rate * levels * reals * (settle + periods)
        if 4 <= seconds <= 10 and rate / n <= info["fs"] / 5 and (rate == 96000) <= fast and n / rate >= 0.08:
            good.append((rate, n, levels, reals, settle, periods))
    if not good:
        good = [(44100, 16384, 3, 2, 2, 2)]
    return good[d.r.integers(len(good))]


def db(y, of):
    return float(20 * np.log10(max(np.std(y), 1e-300) / np.std(of)))


class Take:
    """A driver with its effects and signal; everything that make() needs to run it again with one thing changed."""

    def __init__(self, d, o):
        self.d, self.o = d, o
        name = o.driver or str(d.r.choice(list(draw.CLASSES)))
        self.letters = [LETTERS[c] for c in o.channels.split("+")]
        self.p, self.info = draw.driver(d, name)
        kind = o.box or {"ports": "vented", "box": "closed" if d.r.random() < 0.5 else "vented"}.get(o.kind, "none")
        self.box = kind
        self.effects = choose_effects(d, o, self.letters, kind)
        self.kinds = {}
        if "eddy-currents" in self.effects:
            self.kinds["eddy-currents"] = draw.eddy(d, self.p)
        if "creep" in self.effects:
            self.kinds["creep"] = draw.creep(d, self.p, self.info["fs"])
        self.extra = []
        if kind != "none":
            draw.box(d, self.p, self.info, kind)
            if kind == "closed":
                self.extra = ["closed-box", "closed-air"]
        self.p["mic.distance"] = d.log(4, 12) * np.sqrt(self.p["Sd"] / np.pi)
        self.signal()

    def signal(self):
        d, info = self.d, self.info
        self.rate, self.n, levels, reals, self.settle, self.periods = plan(d, info, self.o.bench)
        self.resolution = self.rate / self.n
        top = min(info["top"] * d.u(0.7, 1.2), 0.4 * self.rate)
        self.band = [max(info["fs"] * d.u(0.12, 0.3), 5.0, self.resolution * 0.99), top]
        self.p["top.hz"] = top
        self.grid = str(d.r.choice(["odd-random", "odd-random", "odd", "full"]))
        self.shape = str(d.r.choice(["pink", "pink", "white"]))
        if info["class"] in ("micro", "tweeter"):
            self.shape = "red" if self.shape == "white" else "pink"   # or the coil burns before the cone moves
        self.oversample = {44100: 8, 48000: 8, 96000: 4}[self.rate]
        if self.o.signal != "multisine":
            self.spectra, self.steps_db, reals = [], [0.0], 1
            spectrum, self.n = takes.aperiodic(d, self.rate, 10.0, self.o.signal, self.band)
            self.spectra, self.lines, self.periods, self.settle = [[spectrum]], None, 1, 0
        else:
            self.lines = takes.lines_of(self.grid, self.n, self.rate, self.band, d)
            fresh = d.r.random() < 0.3             # other phases at each level, or the same at all
            first = [takes.multisine(d, self.n, self.lines, self.shape) for _ in range(reals)]
            self.spectra = [first if not fresh else [takes.multisine(d, self.n, self.lines, self.shape)
                                                     for _ in range(reals)] for _ in range(levels)]
            self.steps_db, self.fresh = list(np.linspace(-d.u(12, 20), 0, levels)), fresh
        self.levels, self.reals, self.gain = len(self.spectra), reals, 1.0

    def cut(self, level, real, substeps=1):
        return takes.fine(self.spectra[level][real], self.n, 2 * self.oversample * substeps)

    def loud(self, on, realizations=1, repeats=None, gain=None, substeps=1, p=None):
        repeats = repeats or self.settle + self.periods
        blocks = [(self.cut(-1, r, substeps), gain or self.gain, repeats, 1.0, 1.0) for r in range(realizations)]
        return takes.run(p or self.p, on, blocks, self.rate, self.oversample, substeps)

    def on(self, without=()):
        names = [e for e in self.effects + self.extra if e not in without]
        if "stiffness" in without:
            names = [n for n in names if n != "closed-air"]
        if "vented-box" in without:
            names = [n for n in names if n != "port-and-air"]
        return names

    def set_up(self):
        """Drive and laws: the loudest level reaches a share of xmax, in the limits of the coil's power."""
        d, info = self.d, self.info
        aim = d.u(0.5, 0.95) * info["xmax"]
        linear = [e for e in ("eddy-currents", "creep", "vented-box", "closed-box") if e in self.on()]
        y = self.loud(linear, repeats=1, gain=1.0)
        peak = np.max(np.abs(y[:, 2]))
        self.gain = aim / peak
        x, v, i = (np.max(np.abs(y[:, c])) * self.gain for c in (2, 3, 1))
        power = self.p["Re"] * np.mean(y[:, 1] ** 2) * self.gain ** 2
        if power > POWER[info["class"]]:
            less = np.sqrt(POWER[info["class"]] / power)
            self.gain, x, v, i = self.gain * less, x * less, v * less, i * less
            aim *= less
        force = self.p["K"] * x
        self.kinds.update(draw.laws(d, self.p, x, v, i, info["fs"], force, self.effects))
        seconds = self.levels * self.reals * (self.settle + self.periods) * self.n / self.rate
        self.strange = []
        if self.o.kind == "unknown":
            name = self.o.unknown or str(d.r.choice(draw.UNKNOWN))
            draw.unknown(d, name, self.p, x, v, seconds, force)
            self.strange = [name]
            self.extra = self.extra + [name]
        self.p.setdefault("heat.rise", [0, 0])
        for _ in range(3):
            y = self.loud(self.on(), repeats=1)
            if "coil-heating" in self.effects:
                watts = self.p["Re"] * np.mean(y[:, 1] ** 2)
                self.p["heat.rise"] = [k / watts for k in self.p["heat.kelvin"]]
            now = np.max(np.abs(y[:, 2]))
            if abs(now / aim - 1) < 0.04:
                break
            self.gain *= (aim / now) ** 0.8

    def halving(self):
        """dB by which half the step changes the loudest period; the finer grid is chosen until it is small."""
        while True:
            a = self.loud(self.on(), repeats=1)
            b = self.loud(self.on(), repeats=1, substeps=2)
            worst = max(db(a[:, c] - b[:, c], b[:, c]) for c in range(7))
            if worst < -115 or self.oversample >= 128:
                return worst
            self.oversample *= 2

    def whole(self, k_scale, r_scale, without=()):
        blocks = [(self.cut(l, r), self.gain * 10 ** (self.steps_db[l] / 20), self.settle + self.periods,
                   k_scale[l], r_scale[l]) for l in range(self.levels) for r in range(self.reals)]
        return takes.run(self.p, self.on(without), blocks, self.rate, self.oversample)


def strengths(t, y, scale, noise, loud):
    """dB over the noise of each channel at the loudest level by which switching an effect off changes it."""
    found = {}
    base = t.loud(t.on(), 1)
    use = slice(t.settle * t.n, None)
    air = ["closed-air"] if "closed-box" in t.extra and "stiffness" not in t.effects else []
    for e in t.effects + t.strange + air:
        if e in ("jump", "wander", "coil-heating"):
            a, b, part = y, t.whole(*scale, without=[e]), loud
        else:
            a, b, part = base, t.loud(t.on([e]), 1), use
        found[e] = {}
        for c in t.letters[1:]:                    # the voltage is the input: what changes there is no evidence
            change = np.std((a - b)[part, takes.BEST["laser" if c == "x" else c]])
            found[e][QUANTITY[c][0]] = round(max(20 * np.log10(max(change, 1e-300) / noise[c]), -99), 1)
    return found


def main():
    o = options()
    d = draw.Draw(o.seed)
    t = Take(d, o)
    b = benches.draw(d, o.bench, t.info)
    if "ohms" in b:
        t.p["amp.ohms"], t.p["amp.corner"] = b["ohms"], b["corner"]
    t.set_up()
    halving = t.halving()
    wobble = ([1 + d.u(-1, 1) * b.get("drift.K", 0) for _ in range(t.levels)],
              [1 + d.u(-1, 1) * b.get("drift.R", 0) for _ in range(t.levels)])
    y = t.whole(*wobble)

    per_level = len(y) // t.levels
    loud = slice(len(y) - per_level, None)
    channels, words, noise, snr = [], [], {}, {}
    for c in t.letters:
        ideal = y[:, takes.BEST["laser" if c == "x" else c]]
        z, full, noise[c], size = benches.sense(d, b, c, ideal, t.rate, loud)
        channels.append(z)
        words.append({"quantity": QUANTITY[c][0], "unit": QUANTITY[c][1], "fullScale": full})
        snr[QUANTITY[c][0]] = round(20 * np.log10(size / noise[c]), 1)
    os.makedirs(o.out, exist_ok=True)
    benches.write_wav(f"{o.out}/take.wav", t.rate, channels, o.bench == "clean")
    u = channels[0] * words[0]["fullScale"]
    levels = [float(np.std(u[l * per_level:(l + 1) * per_level])) for l in range(t.levels)]
    take = {"format": "excursion-measurement", "version": 1, "sampleRate": float(t.rate), "audio": "take.wav",
            "channels": words,
            "driver": {"name": f"stranger {o.seed}", "coneArea": t.p["Sd"], "microphoneDistance": t.p["mic.distance"]}}
    if t.lines is None:
        take["excitation"] = {"kind": "noise" if o.signal == "pink" else "music"}
    else:
        take["excitation"] = {"kind": "multisine", "period": t.n, "settlePeriods": t.settle, "periods": t.periods,
                              "realizations": t.reals, "levels": levels, "grid": t.grid, "shape": t.shape,
                              "band": t.band, "lines": [int(k) for k in t.lines]}
    with open(f"{o.out}/measurement.json", "w") as out:
        json.dump(take, out, indent=2)

    found = strengths(t, y, wobble, noise, loud)
    truth = {"format": "independent-bench-truth", "version": 1, "seed": o.seed, "kind": o.kind, "bench": o.bench,
             "class": t.info["class"], "box": t.box, "rate": t.rate, "seconds": len(y) / t.rate,
             "channels": [QUANTITY[c][0] for c in t.letters],
             "effects": [{"id": e, "shape": t.kinds.get(e, ""), "overNoiseDb": found[e]} for e in t.effects],
             "unknown": [{"id": e, "overNoiseDb": found[e]} for e in t.strange],
             "remark": "the box's air is adiabatic: it looks like an uneven stiffness" if t.box == "closed" else "",
             "airOverNoiseDb": found.get("closed-air"),
             "levels": levels, "samePhasesAtAllLevels": not getattr(t, "fresh", False),
             "peaks": {c: float(np.max(np.abs(y[:, k]))) for c, k in takes.BEST.items()},
             "peakOverXmax": float(np.max(np.abs(y[:, 2])) / t.info["xmax"]), "signalToNoiseDb": snr,
             "stiffnessScales": wobble[0], "resistanceScales": wobble[1], "halvingDb": round(halving, 1),
             "oversample": t.oversample, "benchFaults": b, "info": t.info,
             "parameters": {k: v if np.isscalar(v) else list(v) for k, v in t.p.items()}}
    with open(f"{o.out.rstrip('/')}.truth.json", "w") as out:
        json.dump(truth, out, indent=1, default=float)
    shown = ", ".join(f"{e}({max(found[e].values()):.0f})" for e in t.effects + t.strange) or "nothing"
    print(f"{os.path.basename(o.out)}: {o.bench} {t.info['class']}{'' if t.box == 'none' else ' ' + t.box} "
          f"{'+'.join(t.letters)} {t.rate} Hz N={t.n} {t.levels}x{t.reals}x({t.settle}+{t.periods}) {t.grid}/{t.shape} "
          f"{len(y) / t.rate:.1f} s, {'/'.join(f'{l:.2f}' for l in levels)} V, {truth['peakOverXmax']:.2f} xmax, "
          f"half step {halving:.0f} dB @x{t.oversample}: {shown}")


if __name__ == "__main__":
    main()
