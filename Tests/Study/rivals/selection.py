# SPDX-License-Identifier: GPL-3.0-or-later
"""Selection of groups by least squares: forward, and leaving one out.

The error of a set of effects is the sum over the equations of n ln(sum of squares), the
likelihood with an unknown variance for each equation; in dB it is the sum of the errors in dB."""

import numpy as np

DB = 10.0 / np.log(10.0)
NOTHING = 1e-4  # of noise and floor, in power: smaller errors are none


class Fits:
    """Sums of squares of sets of effects, each computed once."""

    def __init__(self, problem):
        self.problem = problem
        self.known = {}

    def part(self, part, effects):
        """Sum of squares and number of columns of one equation."""
        mine = tuple(e for e in part.groups if e in effects)
        key = (part.name, mine)
        if key not in self.known:
            rest, count = part.target, 0
            if mine:
                matrix = np.hstack([part.groups[e] for e in mine])
                solution, _, count, _ = np.linalg.lstsq(matrix, rest, rcond=1e-10)
                rest = rest - matrix @ solution
            self.known[key] = float(rest @ rest) + NOTHING * part.rows, int(count)
        return self.known[key]

    def error_db(self, effects):
        return sum(DB * np.log(self.part(p, effects)[0]) for p in self.problem.parts)

    def bic(self, effects):
        result = 0.0
        for part in self.problem.parts:
            squares, count = self.part(part, effects)
            result += part.rows * np.log(squares / part.rows) + count * np.log(part.rows)
        return result


def forward(problem):
    """Order of the effects that lower the error most, the gain in dB and the BIC after each."""
    fits, chosen, path = Fits(problem), [], []
    left = problem.effects()
    error, first = fits.error_db(chosen), fits.bic(chosen)
    while left:
        best = min(left, key=lambda e: (fits.error_db([*chosen, e]), e))
        left.remove(best)
        chosen.append(best)
        after = fits.error_db(chosen)
        path.append((best, error - after, fits.bic(chosen)))
        error = after
    return path, first


def forward_by_gain(path, threshold_db):
    named = set()
    for effect, gain, _ in path:
        if gain < threshold_db:
            break
        named.add(effect)
    return named


def forward_by_bic(path, first):
    named, best = set(), first
    for effect, _, bic in path:
        if bic >= best:
            break
        named.add(effect)
        best = bic
    return named


def leave_one_out(problem):
    """What the error grows by, in dB, without one effect's columns and with all others."""
    fits, effects = Fits(problem), problem.effects()
    full = fits.error_db(effects)
    return {e: fits.error_db([o for o in effects if o != e]) - full for e in effects}
