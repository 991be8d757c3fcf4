# SPDX-License-Identifier: GPL-3.0-or-later
"""The one exception that the package throws on purpose."""

from __future__ import annotations

from typing import Any

#: What the program's exit codes stand for.
KINDS = {
    1: "refused",
    2: "usage",
    3: "input",
    4: "data",
    5: "numerical",
    6: "cancelled",
}


class Error(Exception):
    """One sentence for a person, and the kind of trouble.

    ``kind`` is one of

    - ``"refused"``: the take is not fit for use, so nothing was fitted; ``document`` tells its problems;
    - ``"usage"``: an argument makes no sense;
    - ``"input"``: a file or an array is missing, unreadable, truncated, not finite, or of an unknown version;
    - ``"data"``: the data is well formed but cannot answer the question;
    - ``"numerical"``: a computation did not converge or left the finite numbers;
    - ``"cancelled"``: the program was asked to stop from outside;
    - ``"program"``: there is no ``excursion`` program, or it fell over.
    """

    def __init__(self, sentence: str, kind: str, document: dict[str, Any] | None = None) -> None:
        super().__init__(sentence)
        self.kind = kind
        self.document = document


class ExcursionWarning(UserWarning):
    """A result is there, but is to be used with care."""
