# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear models as matrices."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._document import VERSION, read_json, require_format, write_json
from ._errors import Error
from ._take import Samples

FORMAT = "excursion-state-space"
FRACTIONAL = "excursion-fractional-state-space"


class StateSpace:
    """Matrices A, B, C, D of a linear model, with one row of C and D an output and one column of B and D an input.

    :param rate: Hz: x(t+1) = A x + B u, y = C x + D u; 0: continuous time, dx/dt = A x + B u
    :param alpha: order of differentiation, 1 but for models of fractional order, D^alpha x = A x + B u
    :param delay: s by which the model answers later than its matrices say
    """

    def __init__(
        self,
        A: ArrayLike,
        B: ArrayLike,
        C: ArrayLike,
        D: ArrayLike,
        *,
        rate: float = 0.0,
        alpha: float = 1.0,
        inputs: Sequence[str] = ("voltage",),
        outputs: Sequence[str] = ("current",),
        delay: float = 0.0,
        name: str = "",
    ) -> None:
        m, p = len(inputs), len(outputs)
        n = np.asarray(A, dtype=float).size
        n = round(n**0.5)
        try:
            self.A: Samples = np.array(A, dtype=float).reshape(n, n)
            self.B: Samples = np.array(B, dtype=float).reshape(n, m)
            self.C: Samples = np.array(C, dtype=float).reshape(p, n)
            self.D: Samples = np.array(D, dtype=float).reshape(p, m)
        except ValueError as trouble:
            raise Error(f"A, B, C and D do not fit {m} inputs and {p} outputs: {trouble}.", "usage") from trouble
        self.rate, self.alpha, self.delay, self.name = float(rate), float(alpha), float(delay), name
        self.inputs, self.outputs = list(inputs), list(outputs)

    @staticmethod
    def from_document(document: dict[str, Any]) -> StateSpace:
        require_format(document, (FORMAT, FRACTIONAL), "The model")
        form = document["form"] if document["format"] == FRACTIONAL else document
        return StateSpace(
            form["A"],
            form["B"],
            form["C"],
            form["D"],
            rate=form["sampleRate"],
            alpha=document.get("alpha", 1.0),
            inputs=form["inputs"],
            outputs=form["outputs"],
            delay=form.get("delay") or 0.0,
            name=document.get("name", ""),
        )

    @property
    def document(self) -> dict[str, Any]:
        """As Docs/Formats.md describes it."""
        form: dict[str, Any] = {
            "format": FORMAT,
            "version": VERSION,
            "name": self.name,
            "sampleRate": self.rate,
            "inputs": self.inputs,
            "outputs": self.outputs,
            "order": self.order,
            "A": self.A.tolist(),
            "B": self.B.tolist(),
            "C": self.C.tolist(),
            "D": self.D.tolist(),
        }
        if self.delay:
            form["delay"] = self.delay
        if self.alpha == 1.0:
            return form
        return {"format": FRACTIONAL, "version": VERSION, "name": self.name, "alpha": self.alpha, "form": form}

    @staticmethod
    def read(path: str | os.PathLike[str]) -> StateSpace:
        return StateSpace.from_document(read_json(os.fspath(path)))

    def write(self, path: str | os.PathLike[str]) -> None:
        write_json(self.document, os.fspath(path))

    @property
    def order(self) -> int:
        return len(self.A)

    @property
    def poles(self) -> NDArray[np.complex128]:
        """Eigenvalues of A: in rad/s, in z, or in s^alpha."""
        return np.linalg.eigvals(self.A).astype(complex)

    def response(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        """Output over input at frequencies in Hz: an array of frequencies by outputs by inputs, of one of each by
        frequencies alone."""
        f = np.asarray(frequency, dtype=float)
        s = 2j * np.pi * f
        at = np.asarray(np.exp(s / self.rate) if self.rate > 0 else s**self.alpha)
        resolvent = at[..., None, None] * np.eye(self.order) - self.A
        driven = np.broadcast_to(self.B.astype(complex), (*f.shape, *self.B.shape))  # else NumPy 1 takes B for a stack
        inner = np.linalg.solve(resolvent, driven)
        found = (self.C @ inner + self.D) * np.exp(-s * self.delay)[..., None, None]
        return np.asarray(found[..., 0, 0] if self.D.size == 1 else found, dtype=complex)

    def __repr__(self) -> str:
        kind = (
            f"at {self.rate:.8g} Hz" if self.rate else "continuous" if self.alpha == 1.0 else f"alpha {self.alpha:.4g}"
        )
        return (
            f"<excursion.StateSpace: order {self.order}, {kind}, {', '.join(self.outputs)} / {', '.join(self.inputs)}>"
        )
