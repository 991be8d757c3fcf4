# SPDX-License-Identifier: GPL-3.0-or-later
"""Amplifier, sensors and converters, and what is wrong with them."""
import struct
import numpy as np


def draw(d, name, info):
    b = {"name": name}
    if name == "clean":
        b["noise"] = {c: d.u(-85, -55) for c in "uixvap"}
        b["noise"]["u"] = d.u(-90, -75)
        b["pink"] = 0.0
        return b
    b["ohms"], b["corner"] = d.log(0.02, 0.3), d.u(1, 3)
    b["noise"] = {c: d.u(-80, -62) for c in "uixvap"}
    b["noise"]["u"] = d.u(-88, -75)
    b["pink"] = d.u(0.1, 0.5)
    b["laser.corner"], b["laser.q"], b["laser.late"] = d.log(5e3, 20e3), d.u(0.55, 0.8), d.u(-2e-6, 2e-6)
    b["mic.corner"] = d.u(3, 15)          # the latency is what is left of it once it was calibrated
    b["bits"] = int(d.r.choice([16, 24, 24]))
    b["hum"] = d.u(-95, -75)
    b["skew"] = {c: d.sign() * d.u(0.01, 0.03) if c != "u" else 0.0 for c in "uixvap"}
    b["drift.K"], b["drift.R"] = d.u(0.001, 0.005), d.u(0.0005, 0.003)
    if name == "rough":
        b["laser.bend"] = 0.005 * d.sign()
        b["room.db"], b["room.ms"] = -d.u(15, 25), d.u(3, 8)
        b["drift.R"] = d.u(0.003, 0.008)
        b["noise"][str(d.r.choice(["i", "x", "p"]))] = -45.0
    return b


def filtered(y, rate, response):
    """A linear sensor on a record that starts at rest, by its transfer function."""
    n = len(y)
    size = n + int(rate * 1.5)
    s = 2j * np.pi * np.fft.rfftfreq(size, 1 / rate)
    return np.fft.irfft(np.fft.rfft(y, size) * response(s), size)[:n]


def sense(d, b, letter, clean, rate, loud):
    """What the converter gives for one channel. loud: the slice of the loudest level."""
    y = clean.copy()
    size = np.std(y[loud])
    if b["name"] != "clean":
        late = b["skew"][letter] / rate
        if letter == "x":
            w, q = 2 * np.pi * b["laser.corner"], b["laser.q"]
            if b.get("laser.bend"):
                y = y + b["laser.bend"] * y * y / np.max(np.abs(y))
            # A careful hand has taken the filter's delay at low frequencies off, as the program asks for.
            late_laser = b["laser.late"] - (1 / (w * q) if b["name"] == "real" else 0)
            y = filtered(y, rate, lambda s: np.exp(-s * (late + late_laser)) / (1 + s / (w * q) + s * s / w ** 2))
        elif letter == "p":
            w = 2 * np.pi * b["mic.corner"]
            if b.get("room.db"):
                g, t = 10 ** (b["room.db"] / 20), b["room.ms"] * 1e-3
                y = filtered(y, rate, lambda s: 1 + g * np.exp(-s * t))
            y = filtered(y, rate, lambda s: np.exp(-s * late) * s / (s + w))
        elif late:
            y = filtered(y, rate, lambda s: np.exp(-s * late))
    rms = size * 10 ** (b["noise"][letter] / 20)
    noise = d.r.standard_normal(len(y))
    if b["pink"]:
        spectrum = np.fft.rfft(d.r.standard_normal(len(y)))
        f = np.maximum(np.fft.rfftfreq(len(y), 1 / rate), 1.0)
        pink = np.fft.irfft(spectrum * f ** -0.5, len(y))
        noise = np.sqrt(1 - b["pink"]) * noise + np.sqrt(b["pink"]) * pink / np.std(pink)
    noise *= rms
    if b["name"] != "clean":
        t = np.arange(len(y)) / rate
        noise += size * 10 ** (b["hum"] / 20) * np.sqrt(2) * (
            np.sin(2 * np.pi * 49.96 * t + d.u(0, 6)) + 0.3 * np.sin(2 * np.pi * 3 * 49.96 * t + d.u(0, 6)))
    y = y + noise
    peak = np.max(np.abs(y)) * 1.1
    full = 2.0 ** np.ceil(np.log2(peak))
    z = y / full
    if b["name"] != "clean":
        step = 2.0 ** (1 - b["bits"])
        z = np.round(z / step + d.r.uniform(-0.5, 0.5, len(z)) + d.r.uniform(-0.5, 0.5, len(z))) * step
        noise_all = np.sqrt(rms ** 2 + (full * step) ** 2 / 4)
    else:
        noise_all = rms
    return z, full, noise_all, size


def write_wav(path, rate, channels, double):
    """RIFF float, 64 or 32 bits."""
    data = np.stack(channels, 1).astype("<f8" if double else "<f4")
    width, n = data.itemsize, data.shape[1]
    body = data.tobytes()
    head = struct.pack("<HHIIHH", 3, n, int(round(rate)), int(round(rate)) * n * width, n * width, 8 * width)
    head += struct.pack("<H", 0)
    fact = b"fact" + struct.pack("<II", 4, len(data))
    with open(path, "wb") as out:
        out.write(b"RIFF" + struct.pack("<I", 4 + 8 + len(head) + len(fact) + 8 + len(body)) + b"WAVE")
        out.write(b"fmt " + struct.pack("<I", len(head)) + head + fact)
        out.write(b"data" + struct.pack("<I", len(body)) + body)
