# SPDX-License-Identifier: GPL-3.0-or-later
"""Resonances tuned to the take, so that no rival loses one between the columns of a grid.

A resonator anywhere within a grid of poles is a sum of the grid's resonators to within some
0.1 %. So its column can be had from the grid's reduced columns, and the pole that lowers the error
most is searched for without going back to the spectra."""

import numpy as np
from scipy.optimize import minimize

from operators import resonators

QUALITIES = (4.0, 11.0)  # of the grid
TRIED = (3.0, 5.0, 8.0, 14.0)


def thinned(s, weight, count=400):
    """Fewer lines, evenly spread over log frequency, with the weight of those between."""
    begin = np.unique(np.geomspace(1, len(s), count).astype(int)) - 1
    begin = np.unique(np.r_[0, begin[begin < len(s)]])
    square = np.add.reduceat(weight ** 2, begin)
    centre = np.add.reduceat(weight ** 2 * s.imag, begin) / np.where(square > 0.0, square, 1.0)
    centre = np.where(square > 0.0, centre, s.imag[begin])
    return 1j * centre, np.sqrt(square)


class Grid:
    """The grid of one effect in one equation.
    columns: its reduced columns; s, weight: lines, and their share in the columns."""

    def __init__(self, columns, s, weight, frequencies):
        self.columns = columns
        self.s, self.weight = thinned(s, weight)
        self.frequencies = np.asarray(frequencies)
        self.basis = self.stack(resonators(self.s, frequencies, QUALITIES))
        self.inverse = np.linalg.pinv(self.basis, rcond=1e-9)
        count = 3 * len(self.frequencies)
        self.candidates = [(f, q, self.at(f, q)) for f in np.geomspace(
            self.frequencies[0], self.frequencies[-1], count) for q in TRIED]

    def stack(self, responses):
        weighted = np.array(responses) * self.weight
        return np.concatenate([weighted.real, weighted.imag], axis=1).T

    def at(self, frequency, quality):
        """The two reduced columns of a pole."""
        wanted = self.stack(resonators(self.s, [frequency], (quality,)))
        return self.columns @ (self.inverse @ wanted)


def span(columns):
    """An orthonormal basis."""
    directions, sizes, _ = np.linalg.svd(columns, full_matrices=False)
    return directions[:, sizes > 1e-9 * sizes[0]]


def tune(grid, target, others):
    """Frequency and quality of the pole that lowers the error most beside other columns."""
    others = span(others)
    rest = target - others @ (others.T @ target)
    low, high = np.log(grid.frequencies[[0, -1]])

    def error(columns):
        own = span(columns - others @ (others.T @ columns))
        left = rest - own @ (own.T @ rest)
        return np.log(left @ left + 1e-300)

    def refined(place):
        outside = max(0.0, low - place[0], place[0] - high, place[1] - np.log(20.0),
                      np.log(2.0) - place[1])
        return error(grid.at(*np.exp(place))) + 100.0 * outside

    best = min(grid.candidates, key=lambda c: error(c[2]))
    start = np.log(best[:2])
    found = minimize(refined, start, method="Nelder-Mead", options={
        "maxfev": 60, "initial_simplex": [start, start + (0.03, 0.0), start + (0.0, 0.3)]})
    return tuple(np.exp(found.x)) if found.fun < refined(start) else best[:2]


def tune_all(grids, target, others, poles, rounds=2):
    """Tuned columns by effect. grids: by effect; poles: how many each effect may have.
    One after another beside all other columns, then each once more beside all tuned ones."""
    tuned = {}
    for _ in range(rounds):
        for effect, grid in grids.items():
            for n in range(poles[effect]):
                beside = [columns for key, columns in tuned.items() if key != (effect, n)]
                place = tune(grid, target, np.hstack([others, *beside]))
                tuned[effect, n] = grid.at(*place)
    return {effect: np.hstack([tuned[effect, n] for n in range(poles[effect])])
            for effect in grids}
