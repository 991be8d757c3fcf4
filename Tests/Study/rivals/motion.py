# SPDX-License-Identifier: GPL-3.0-or-later
"""The states of the loudspeaker as the sensors show them: i, x, v and a on all lines.

The motion is differentiated or integrated in the frequency domain. Where its sensor drowns in its
noise, well above the resonance, the cone moves as the linear force balance says, which is
fitted to the lines that are clean; the two are averaged by their variances."""

from dataclasses import dataclass

import numpy as np

from operators import resonators
from takes import smooth

SOUND = 343.0  # m/s
TRUST = 0.05  # relative error of the linear force balance above the resonance
ABOVE = 2.5  # the cone follows its mass from here on, in resonance frequencies


@dataclass
class States:
    take: object
    s: np.ndarray  # j omega, per line
    current: np.ndarray
    raw: np.ndarray  # displacement as measured
    raw_noise: np.ndarray
    displacement: np.ndarray  # with the force balance where the sensor shows nothing
    displacement_noise: np.ndarray
    force_model: np.ndarray  # displacement to current, A/m, per line
    resonance: float  # Hz
    coil: tuple  # Re, Le, Bl of the linear voltage equation

    def velocity(self):
        return self.s * self.displacement

    def acceleration(self):
        return self.s ** 2 * self.displacement


def weighted_solve(columns, target, weight, smallest=1e-12):
    """Real coefficients of complex columns, without directions below the smallest."""
    stack = [(c * weight).ravel() for c in columns]
    matrix = np.array([np.r_[c.real, c.imag] for c in stack]).T
    right = (target * weight).ravel()
    scale = np.linalg.norm(matrix, axis=0)
    scale[scale == 0.0] = 1.0
    return np.linalg.lstsq(matrix / scale, np.r_[right.real, right.imag], rcond=smallest)[0] / scale


def level_power(take, spectrum, inside):
    """Mean power of a line in the band, per section: that of its level."""
    power = np.mean(np.abs(spectrum[:, inside]) ** 2, axis=1)
    return np.array([power[take.level_of == level].mean() for level in take.level_of])[:, None]


def force_balance(s, raw, raw_noise, current, noise, inside):
    """Displacement to current in A/m on all lines, and the resonance in Hz: mass, damping and
    spring, then with relaxations and resonances of what hangs on the cone: those near its
    resonance, and those further up where they lower the error by a fifth."""
    base = [s ** 2, s + 0.0, np.ones_like(s)]
    shown = inside & (np.abs(raw) ** 2 > 6.0 * raw_noise)
    clean = inside & (np.abs(raw) ** 2 > 100.0 * raw_noise)
    fit = weighted_solve([c * raw for c in base], current, clean / np.sqrt(noise))
    resonance = np.sqrt(abs(fit[2] / fit[0])) / (2.0 * np.pi)
    lags = [r / (s + r) for r in 2.0 * np.pi * resonance * np.array((0.1, 0.5, 2.0))]
    balance = sum(f * c for f, c in zip(fit, base))
    for _ in range(3):
        error = np.sqrt(noise + np.abs(balance) ** 2 * raw_noise)
        fit = weighted_solve([c * raw for c in base], current, shown / error)
        least = np.inf
        for top in (3.0, 8.0):
            hung = resonators(s, resonance * np.geomspace(0.6, top, 10), (6.0,))
            terms = [*base, *lags, *hung]
            more = weighted_solve([c * raw for c in terms], current, clean / error, 1e-3)
            tried = sum(f * c for f, c in zip(more, terms))
            left = (np.abs((current - tried * raw) * clean / error) ** 2).sum()
            if left < 0.8 * least:
                least, balance = left, tried
    return balance, np.sqrt(max(fit[2] / fit[0], 0.0)) / (2.0 * np.pi)


def to_displacement(take, s):
    """The channel that shows the motion, and its factor to displacement on each line; or None."""
    inverse = np.zeros_like(s)
    inverse[1:] = 1.0 / s[1:]
    factors = {"displacement": np.ones_like(s), "velocity": inverse, "acceleration": inverse ** 2,
               "pressure": inverse ** 2 * np.exp(s * take.distance / SOUND)}
    source = take.motion() or ("pressure" if "pressure" in take.spectra else None)
    return (source, factors[source]) if source else None


def measure(take):
    """States of a take, or None if no channel shows the motion or the current. With pressure
    alone, the displacement has an unknown scale, which the regressions do not mind."""
    s = 2j * np.pi * take.frequency
    found = to_displacement(take, s)
    if found is None or "current" not in take.spectra:
        return None
    source, factor = found
    low, high = take.band
    inside = (take.frequency >= low) & (take.frequency <= high)
    raw = take.spectra[source] * factor
    raw_noise = take.noise[source] * np.abs(factor) ** 2
    shown = np.abs(raw) ** 2 > 6.0 * raw_noise
    current, current_noise = take.spectra["current"], take.noise["current"]
    floor = 1e-6 * level_power(take, current, inside)
    balance, resonance = force_balance(s, raw, raw_noise, current, current_noise + floor, inside)
    if not low < resonance < high:
        resonance = np.sqrt(low * high)

    follows = take.frequency > ABOVE * resonance
    divisor = np.where(follows, balance, 1.0)
    predicted = np.where(follows, current / divisor, 0.0)
    doubt = (smooth(np.abs(predicted) ** 2, take.level_of) * TRUST ** 2
             + current_noise / np.abs(divisor) ** 2)
    share = np.where(follows, doubt / (doubt + raw_noise + 1e-300), shown)
    best = share * raw + (1.0 - share) * predicted
    best_noise = raw_noise * share
    if source == "displacement":
        best[:, 0] = raw[:, 0]

    columns = [current, s * current, s * best]
    floor = 1e-6 * level_power(take, take.spectra["voltage"], inside)
    coil = weighted_solve(columns, take.spectra["voltage"], inside / np.sqrt(floor))
    return States(take, s, current, raw, raw_noise, best, best_noise, balance, resonance,
                  tuple(coil))


def wave(spectrum, period):
    """Time signals of spectra that are scaled as rfft over the period."""
    return np.fft.irfft(spectrum, period, axis=1) * period


def lines(signal):
    return np.fft.rfft(signal, axis=1) / signal.shape[1]
