# SPDX-License-Identifier: GPL-3.0-or-later
"""Spike and slab by group: collapsed Gibbs sampling of which effects are in the model.

Each group's coefficients are zero (spike) or normal with unit information (slab, a g prior with
g = number of rows); coefficients and each equation's variance are integrated out:
    ln p(y | effects) = -p/2 ln(1 + g) - n/2 ln(1 - g/(1 + g) R^2)."""

import numpy as np

from selection import Fits


def log_evidence(fits, effects):
    result = 0.0
    for part in fits.problem.parts:
        squares, count = fits.part(part, effects)
        total, g = fits.part(part, ())[0], float(part.rows)
        share = (g * squares / total + 1.0) / (1.0 + g)
        result -= 0.5 * count * np.log1p(g) + 0.5 * part.rows * np.log(share)
    return result


def inclusion(problem, sweeps=60, burn=20, prior=0.5, seed=1):
    """Probability and mean conditional log odds of each effect, averaged over two chains: one
    begins with no effect, one with all. The log odds still differ where the probability is 1."""
    fits, effects = Fits(problem), problem.effects()
    random = np.random.default_rng(seed)
    probability, odds = np.zeros(len(effects)), np.zeros(len(effects))
    evidence = {}

    def value(state):
        key = tuple(state)
        if key not in evidence:
            evidence[key] = log_evidence(fits, [e for e, on in zip(effects, state) if on])
        return evidence[key]

    for start in (False, True):
        state = np.full(len(effects), start)
        for sweep in range(sweeps):
            for n in random.permutation(len(effects)):
                with_it, without = state.copy(), state.copy()
                with_it[n], without[n] = True, False
                log_odds = (value(with_it) - value(without)
                            + np.log(prior) - np.log1p(-prior))
                chance = 1.0 / (1.0 + np.exp(-np.clip(log_odds, -700.0, 700.0)))
                state[n] = random.random() < chance
                if sweep >= burn:
                    probability[n] += chance
                    odds[n] += log_odds
    count = 2 * (sweeps - burn)
    return (dict(zip(effects, probability / count)), dict(zip(effects, odds / count)))
