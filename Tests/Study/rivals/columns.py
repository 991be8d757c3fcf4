# SPDX-License-Identifier: GPL-3.0-or-later
"""The design matrix: three regressions on measured signals, their columns grouped by effect.

    voltage:  u = Re i + Le di/dt + Bl v + what is missing
    force:    i = (m a + Rms v + K x + what is missing)/Bl
    pressure: p = gain a(t - delay) + what is missing

All columns are spectra of averaged periods, sections by lines."""

from dataclasses import dataclass, field

import numpy as np

from motion import SOUND, lines, wave
from operators import hysteresis

BOX_RATIO = np.geomspace(0.6, 1.7, 9)  # of port and resonance frequency
SIDE_RATIO = np.geomspace(1.9, 11.0, 13)  # of hung part and resonance frequency

MODE_RATIO = np.geomspace(0.28, 1.05, 13)  # of a mode of the cone and the band's upper edge


@dataclass
class Equation:
    name: str
    target: np.ndarray
    noise: np.ndarray  # variance of the equation's error by the sensors' noise
    base: list = field(default_factory=list)
    groups: dict = field(default_factory=dict)
    resonances: dict = field(default_factory=dict)  # effect: (input, frequencies, poles)

    def add(self, effect, columns):
        self.groups.setdefault(effect, []).extend(columns)


def powers(q, times, orders):
    """Spectra of q^k times another signal, q relative to its peak."""
    relative = q / np.abs(q).max()
    return [lines(relative ** k * times) for k in orders]


def lag(s, rate):
    return rate / (s + rate)


def voltage_equation(states):
    take, s = states.take, states.s
    i, x = wave(states.current, take.period), wave(states.displacement, take.period)
    v = wave(states.velocity(), take.period)
    resistance, inductance, bl = states.coil
    noise = (take.noise["voltage"] + np.abs(resistance + s * inductance) ** 2
             * take.noise["current"] + np.abs(bl * s) ** 2 * states.displacement_noise)
    equation = Equation("voltage", take.spectra["voltage"], noise)
    equation.base = [states.current, s * states.current, states.velocity()]
    equation.add("force-factor", powers(x, v, range(1, 5)))
    low, high = (2.0 * np.pi * f for f in take.band)
    loops = [low, np.sqrt(low * high), high]
    equation.add("inductance-position", [s * c for c in powers(x, i, range(1, 5))])
    equation.add("inductance-position",  # loops in the iron that move with the coil
                 [s * lag(s, r) * c for c in powers(x, i, (1, 2)) for r in loops])
    equation.add("inductance-current", [s * c for c in powers(i, i, range(1, 5))])
    equation.add("eddy-currents", [s / (s + r) * states.current
                                   for r in np.geomspace(low / 3.0, high * 3.0, 8)])
    if take.heat is not None:
        equation.add("coil-heating", [h[:, None] / take.heat.max() * states.current
                                      for h in take.heat.T])
    return equation


def force_equation(states):
    take, s = states.take, states.s
    i, x = wave(states.current, take.period), wave(states.displacement, take.period)
    v = wave(states.velocity(), take.period)
    noise = take.noise["current"] + np.abs(states.force_model) ** 2 * states.raw_noise
    equation = Equation("force", states.current, noise)
    equation.base = [s ** 2 * states.raw, s * states.raw, states.raw]
    equation.add("force-factor", powers(x, i, range(1, 5)))
    equation.add("stiffness", powers(x, x, range(1, 5)))
    equation.add("inductance-position", powers(x, i * i, range(3)))
    equation.add("damping-velocity", [lines(np.abs(v) * v), *powers(v, v, (1, 2, 4))])
    lowest = 2.0 * np.pi * take.band[0]
    equation.add("creep", [lag(s, r) * states.displacement for r in np.geomspace(
        lowest / 20.0, 2.0 * np.pi * 3.0 * states.resonance, 6)])
    equation.add("friction", [lines(np.tanh(v / (part * np.abs(v).max()))) for part in (0.02, 0.1)])
    equation.add("friction", hysteresis(states.displacement, take.period))
    equation.resonances["vented-box"] = states.displacement, states.resonance * BOX_RATIO, 1
    equation.resonances["side-resonance"] = states.displacement, states.resonance * SIDE_RATIO, 2
    return equation


def flight_time(states):
    """s, at which the delayed acceleration explains the pressure best."""
    take = states.take
    a, p = states.acceleration(), take.spectra["pressure"]
    top = min(take.band[1], 15.0 * states.resonance)
    inside = (take.frequency >= 2.0 * states.resonance) & (take.frequency <= top)
    if not inside.any():
        inside = (take.frequency >= take.band[0]) & (take.frequency <= take.band[1])
    cross = np.where(inside, p * np.conj(a), 0.0)
    cross = (cross / (np.abs(cross) + 1e-300 + 1e-3 * np.abs(cross).max())).sum(axis=0)
    padded = np.fft.irfft(cross, 16 * take.period)
    place = int(np.argmax(padded))
    if place > len(padded) // 2:
        place -= len(padded)
    return place / (16.0 * take.rate)


def pressure_equation(states):
    take, s = states.take, states.s
    later = np.exp(-s * flight_time(states))
    a, x = states.acceleration() * later, states.displacement * later
    p = take.spectra["pressure"]
    inside = (take.frequency >= take.band[0]) & (take.frequency <= take.band[1])
    gain = np.sqrt((np.abs(p[:, inside]) ** 2).sum() / (np.abs(a[:, inside]) ** 2).sum())
    noise = take.noise["pressure"] + np.abs(gain * s ** 2) ** 2 * states.displacement_noise
    equation = Equation("pressure", p, noise)
    equation.base = [a, s * a]
    heard = np.where(np.abs(p) ** 2 > 4.0 * take.noise["pressure"], p, 0.0)
    near = wave(x, take.period) / SOUND
    equation.add("doppler", [lines(near * wave(s * heard, take.period)),
                             lines(near ** 2 * wave(s ** 2 * heard, take.period))])
    equation.resonances["vented-box"] = a, states.resonance * BOX_RATIO, 1
    equation.resonances["cone-breakup"] = (s ** 2 * a / (2.0 * np.pi * take.band[1]) ** 2,
                                           take.band[1] * MODE_RATIO, 3)
    return equation


def equations(states):
    """All regressions that a take allows."""
    result = [voltage_equation(states), force_equation(states)]
    if "pressure" in states.take.spectra and states.take.motion():
        result.append(pressure_equation(states))
    return result
