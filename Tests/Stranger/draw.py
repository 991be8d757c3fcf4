# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a driver, its effects and what must not be known, all from one random generator."""
import numpy as np

EFFECTS = ["force-factor", "stiffness", "inductance-position", "damping-velocity", "eddy-currents", "creep",
           "inductance-current", "friction", "coil-heating", "vented-box", "doppler", "cone-breakup",
           "side-resonance", "port-and-air"]
UNKNOWN = ["contact", "wander", "bow-tie", "jump", "rub"]

# class: fs Hz, Sd cm2, mass g, Bl, Re, Le mH, Qms, xmax mm, highest frequency of interest Hz
CLASSES = {
    "micro":    [(350, 800), (0.8, 2.2), (0.05, 0.13), (0.5, 1.0), (6.0, 7.8), (0.02, 0.06), (1.2, 4), (.35, .6), 9000],
    "tweeter":  [(600, 1100), (6, 9), (0.25, 0.5), (2.0, 3.4), (3.2, 6), (0.015, 0.06), (1.5, 4), (0.3, 0.6), 12000],
    "midrange": [(110, 320), (22, 60), (1.5, 4.5), (2.8, 5.5), (3.2, 6.8), (0.08, 0.35), (2.5, 6), (0.9, 2.0), 7000],
    "midbass":  [(38, 75), (88, 150), (9, 18), (4.8, 8), (3.2, 6.4), (0.2, 0.8), (2.5, 8), (3, 6), 4000],
    "woofer":   [(24, 42), (210, 350), (28, 62), (8, 13), (3.1, 6.2), (0.5, 1.6), (3, 8), (5, 9), 2500],
    "sub":      [(18, 30), (480, 850), (100, 240), (12, 21), (2, 6), (0.8, 2.8), (4, 9), (9, 16), 1200],
}


class Draw:
    def __init__(self, seed):
        self.r = np.random.default_rng(seed)

    def u(self, a, b, n=None):
        return self.r.uniform(a, b, n)

    def log(self, a, b, n=None):
        return np.exp(self.r.uniform(np.log(a), np.log(b), n))

    def sign(self):
        return 1 if self.r.random() < 0.5 else -1


def driver(d, name):
    f, s, m, b, re, le, q, xm, top = CLASSES[name]
    p = {"Sd": d.log(*s) * 1e-4, "m": d.log(*m) * 1e-3, "Bl": d.log(*b), "Re": d.log(*re), "Le": d.log(*le) * 1e-3}
    fs, qms, xmax = d.log(*f), d.log(*q), d.log(*xm) * 1e-3
    p["K"] = p["m"] * (2 * np.pi * fs) ** 2
    p["Rms"] = 2 * np.pi * fs * p["m"] / qms
    return p, {"class": name, "fs": fs, "Qms": qms, "xmax": xmax, "top": top}


def eddy(d, p):
    """One R2||L2 loop, or a chain that follows s^a over four decades."""
    if d.r.random() < 0.4:
        corner = 2 * np.pi * d.log(250, 2500)
        p["eddy.L"] = [p["Le"] * d.u(0.3, 1.0)]
        p["eddy.R"] = [p["eddy.L"][0] * corner]
        kind = "one loop"
    else:
        a, cells = d.u(0.5, 0.8), int(d.r.integers(6, 10))
        rho = 2 * np.pi * np.geomspace(15, 25000, cells)
        strength = d.u(0.35, 0.9) * p["Le"] * (2 * np.pi * 1000) ** (1 - a)
        R = strength * np.sin(np.pi * a) / np.pi * rho ** a * np.log(rho[1] / rho[0]) * d.u(0.85, 1.15, cells)
        p["eddy.R"], p["eddy.L"] = list(R), list(R / rho)
        p["Le"] *= d.u(0.35, 0.6)
        kind = f"{cells} loops, s^{a:.2f}"
    p["eddy.share"] = 0.0 if d.r.random() < 0.3 else d.u(0.5, 1)
    p["eddy.lossPower"] = d.u(0.5, 2)
    return kind


def creep(d, p, fs):
    """Elements that yield in series with the spring: two or three of them, or one for each third of a decade."""
    if d.r.random() < 0.5:
        n = int(d.r.integers(2, 4))
        hz = np.sort(d.log(0.3, fs * 0.8, n))
        share = d.u(0.04, 0.15, n)
        kind = f"{n} yielding elements"
    else:
        hz = np.geomspace(0.08, fs * 3, 12)
        step = np.log10(hz[1] / hz[0])
        share = np.full(12, d.u(0.06, 0.16) * step)
        kind = "log creep"
    p["creep.K"] = list(p["K"] / share)
    p["creep.C"] = list(p["K"] / share / (2 * np.pi * hz))
    return kind


def laws(d, p, x, v, i, fs, xpk_force, only):
    """The shapes of all effects that are in, given the peaks of the linear driver at the loudest level."""
    kinds = {}
    if "force-factor" in only:
        over = d.r.random() < 0.6
        gap = x * d.u(1.0, 2.0)
        p["bl.gap"], p["bl.coil"] = gap, gap * (d.u(1.5, 2.6) if over else d.u(0.5, 0.8))
        p["bl.above"], p["bl.below"] = gap * d.u(0.12, 0.45), gap * d.u(0.12, 0.45)
        p["bl.offset"] = d.sign() * x * d.u(0.03, 0.25)
        kinds["force-factor"] = "overhung" if over else "underhung"
    if "stiffness" in only:
        p["k.spider"], p["k.spiderWidth"] = d.u(0.5, 0.8), x * d.u(0.9, 2.2)
        p["k.spiderCentre"] = d.sign() * x * d.u(0.05, 0.3)
        p["k.roll"], p["k.rollWidth"] = d.u(0.1, 0.4), x * d.u(0.5, 1.2)
        p["k.rollCentre"] = d.sign() * x * d.u(0.05, 0.4)
        p["k.wallWidth"] = x * d.u(0.15, 0.35)
        p["k.wallOut"], p["k.wallOutAt"] = d.u(0.05, 0.5), x * d.u(0.9, 1.2)
        p["k.wallIn"], p["k.wallInAt"] = d.u(0.05, 0.5), x * d.u(0.9, 1.2)
        kinds["stiffness"] = "sinh spider + tanh roll + exp walls"
    if "inductance-position" in only:
        p["lx.low"], p["lx.centre"], p["lx.width"] = d.u(0.25, 0.6), d.sign() * x * d.u(0, 0.6), x * d.u(0.7, 1.8)
        p["lx.bump"], p["lx.bumpAt"], p["lx.bumpWidth"] = (0, 0, 1)
        if d.r.random() < 0.3:
            p["lx.bump"], p["lx.bumpAt"], p["lx.bumpWidth"] = -d.u(0.05, 0.15), x * d.u(-0.8, 0.8), x * d.u(0.4, 0.8)
        kinds["inductance-position"] = "tanh step" + (" + ring" if p["lx.bump"] else "")
    if "inductance-current" in only:
        p["li.knee"] = i * d.u(2, 6)
        p["li.bias"] = d.sign() * i * d.u(0.3, 1.5)
        p["li.round"] = i * d.u(0.3, 1)
        kinds["inductance-current"] = "biased Froehlich"
    if "damping-velocity" in only:
        p["rv.turbulence"], p["rv.uneven"], p["rv.scale"] = d.u(0.3, 1.2), d.u(-0.35, 0.35), v * d.u(0.3, 0.7)
        kinds["damping-velocity"] = "turbulent, uneven"
    if "friction" in only:
        k = int(d.r.integers(0, 3))
        p["friction.kind"] = k
        p["friction.limit"] = xpk_force * d.u(0.01, 0.04)
        p["friction.stiffness"] = p["friction.limit"] / (x * d.log(0.02, 0.12))
        p["friction.power"] = 1.0 if k == 2 else (d.u(0.8, 1.6) if k == 0 else d.u(0.9, 2.0))
        p["friction.beta"] = d.u(0.5, 0.8)
        p["friction.stick"], p["friction.stribeck"] = d.u(0.1, 0.4), v * d.u(0.02, 0.1)
        p["friction.viscous"] = 0.05 * p["Rms"]
        kinds["friction"] = ["Dahl", "Bouc-Wen", "LuGre"][k]
    if "coil-heating" in only:
        kinds["coil-heating"] = "two time constants"   # the rises are set once the power is known
        p["heat.time"] = [d.log(0.3, 2), d.log(8, 50)]
        p["heat.kelvin"] = [d.u(2.5, 8), d.u(4, 20)]
    if "side-resonance" in only:
        p["side.mass"], p["side.hz"], p["side.loss"] = [p["m"] * d.u(0.03, 0.12)], [fs * d.log(5, 14)], [d.u(0.05, 0.2)]
        p["m"] -= p["side.mass"][0]
        kinds["side-resonance"] = f"{p['side.hz'][0]:.0f} Hz"
    if "cone-breakup" in only:
        n = int(d.r.integers(1, 4))
        p["bend.hz"], p["bend.q"] = list(np.sort(d.log(0.35, 1.1, n)) * p["top.hz"]), list(d.log(5, 20, n))
        p["bend.sound"], p["bend.laser"] = list(d.u(-0.4, 0.4, n)), list(d.u(-0.6, 0.6, n))
        kinds["cone-breakup"] = ", ".join(f"{h:.0f} Hz" for h in p["bend.hz"])
    return kinds


def unknown(d, name, p, x, v, seconds, peak_force):
    if name == "contact":
        side = d.sign()
        p["contact.at"] = side * x * d.u(0.6, 0.75)
        p["contact.stiffness"] = p["K"] * d.u(2, 8)
        p["contact.soft"] = x * d.u(0.01, 0.03)
    elif name == "wander":
        n = 5
        p["wander.depth"], p["wander.hz"] = list(d.u(0.002, 0.008, n)), list(d.log(0.15, 4, n))
        p["wander.phase"] = list(d.u(0, 2 * np.pi, n))
    elif name == "bow-tie":
        p["bow.limit"], p["bow.reach"], p["bow.width"] = peak_force * d.u(0.05, 0.15), x * d.u(0.05, 0.25), x
    elif name == "jump":
        n = int(d.r.integers(4, 9))
        p["jump.times"] = list(np.sort(d.u(0.1, 0.95, n)) * seconds)
        p["jump.by"], p["jump.seconds"] = d.sign() * x * d.u(0.02, 0.07), d.u(0.001, 0.004)
    elif name == "rub":
        p["rub.at"], p["rub.width"] = x * d.u(0.3, 0.6), x * d.u(0.03, 0.1)
        p["rub.force"], p["rub.speed"] = peak_force * d.u(0.02, 0.06), v * d.u(0.01, 0.03)


def box(d, p, info, kind, port_speed=None):
    """A box about the driver. The port's turbulence is set when the speed in it is known."""
    vas = 1.4 * 101325 * p["Sd"] ** 2 / p["K"]
    if kind == "closed":
        v = vas / d.u(0.8, 3) if info["class"] != "micro" else p["Sd"] * info["xmax"] / d.u(0.04, 0.1)
        p["box.volume"] = v
        p["box.leak"] = 0.0
        p["port.area"] = 0.0
    else:
        v = vas / d.u(0.8, 2.5)
        v = max(v, p["Sd"] * info["xmax"] * 12)
        fb = info["fs"] * d.u(0.75, 1.25)
        p["box.volume"] = v
        p["port.area"] = p["Sd"] * d.u(0.1, 0.25)
        ka = 1.4 * 101325 / v
        p["port.mass"] = ka * p["port.area"] ** 2 / (2 * np.pi * fb) ** 2
        wm = 2 * np.pi * fb * p["port.mass"]
        p["port.loss"] = wm / d.u(30, 90)
        wb = 2 * np.pi * fb / ka                    # susceptance of the box at its tuning, m^3/s/Pa
        p["box.leak"] = wb / d.u(10, 40)
        p["box.absorb"] = 1 / wb / d.u(40, 150)
        p["port.share"] = 1.0 if d.r.random() < 0.5 else d.u(0.5, 1.1)
        p["port.out"], p["port.in"], p["port.laminar"] = d.u(0.5, 1.2), d.u(0.9, 2.0), d.u(0.05, 0.3)
        info["fB"] = fb
    info["Vb litres"] = v * 1e3
