# SPDX-License-Identifier: GPL-3.0-or-later
"""Sparse regression with the optimizers of PySINDy, on precomputed columns.

Each group's columns are orthonormal, so a coefficient is what its column contributes; it is
measured in the rms of the equation's noise and floor. An effect is named where one of its columns
survives in any equation."""

import warnings

import numpy as np

try:
    import pysindy
    from pysindy.optimizers import SR3, STLSQ
except ImportError:
    pysindy = None


def available():
    return pysindy is not None


def version():
    return pysindy.__version__ if pysindy else None


def stlsq(threshold):
    return STLSQ(threshold=threshold, alpha=1e-4, max_iter=50, unbias=False)


def sr3(threshold):
    # the L0 penalty cuts at sqrt(2 lambda nu)
    return SR3(reg_weight_lam=0.5 * threshold ** 2, regularizer="L0", relax_coeff_nu=1.0,
               max_iter=2000, tol=1e-8, unbias=False)


def survivors(problem, make, threshold):
    """Effects with a column above the threshold."""
    named = set()
    for part in problem.parts:
        owners = [e for e, columns in part.groups.items() for _ in range(columns.shape[1])]
        matrix = np.hstack(list(part.groups.values()))
        target = part.target[:, None] / np.sqrt(part.rows)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            optimizer = make(threshold)
            optimizer.fit(matrix, target)
        kept = np.abs(np.ravel(optimizer.coef_)) >= threshold
        named |= {owner for owner, on in zip(owners, kept) if on}
    return named
