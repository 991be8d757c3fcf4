# SPDX-License-Identifier: GPL-3.0-or-later
"""One call of the program, in a temporary folder of its own."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Union

import numpy as np

from ._document import read_json, require_format, write_json
from ._errors import KINDS, Error
from ._program import Progress, run
from ._take import Take
from ._takefile import write_take

PathLike = Union[str, "os.PathLike[str]"]

_ANSWER = "answer.json"


def _text(value: Any) -> str:
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    if isinstance(value, Mapping):
        return ",".join(f"{key}:{_text(item)}" if item is not None else str(key) for key, item in value.items())
    return ",".join(_text(item) for item in value)


def _options(options: Mapping[str, Any]) -> list[str]:
    """Words of the command line: None is left out, a truth is a flag, a sequence is joined by commas."""
    words = []
    for name, value in options.items():
        if isinstance(value, (bool, np.bool_)):
            words += [name] if value else []
        elif value is not None:
            words.append(f"{name}={_text(value)}")
    return words


class Call:
    """A temporary folder, what is put there for the program to read, and what the program leaves there.

    The program is run in this folder, so its documents and its sentences name no temporary path.
    """

    def __init__(self, progress: Progress | None = None) -> None:
        self._progress = progress
        self._temporary: tempfile.TemporaryDirectory[str] | None = None
        self.code = 0

    def __enter__(self) -> Call:
        self._temporary = tempfile.TemporaryDirectory(prefix="excursion-")
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        assert self._temporary is not None
        self._temporary.cleanup()

    @property
    def folder(self) -> Path:
        assert self._temporary is not None
        return Path(self._temporary.name)

    def take(self, take: Take | PathLike, name: str = "take") -> str:
        """What the program is to call a take: the folder that it is written to, or the path that was given."""
        if isinstance(take, Take):
            write_take(take, self.folder / name)
            return name
        return self.path(take)

    def keep(self, document: dict[str, Any], name: str) -> str:
        write_json(document, self.folder / name)
        return name

    def path(self, path: PathLike) -> str:
        try:
            return os.path.abspath(os.fspath(path))
        except TypeError:
            raise Error(
                f"A {type(path).__name__} was given where a take, a model or the path of one is expected.", "usage"
            ) from None

    def run(
        self, verb: str, arguments: Sequence[str], options: Mapping[str, Any], answer: str, *, negative: bool = True
    ) -> dict[str, Any]:
        """The document of a verb.

        :param answer: its format
        :param negative: an exit code 1, "done, and the answer is no", is an answer too
        """
        words = [verb, *arguments, *_options(options), f"--json={_ANSWER}"]
        self.code, said = run(words, str(self.folder), self._progress)
        if self.code == 0 or (self.code == 1 and (self.folder / _ANSWER).is_file()):
            document = read_json(self.folder / _ANSWER)
            require_format(document, answer, f"The answer of excursion {verb}")
            if self.code == 1 and not negative:
                raise Error(str(document.get("sentence", said)), "refused", document)
            return document
        sentence = said[len("excursion: ") :] if said.startswith("excursion: ") else said
        if self.code not in KINDS or self.code == 1:
            reason = f"was ended by signal {-self.code}" if self.code < 0 else f"ended with the code {self.code}"
            raise Error(f"The program {reason}. {sentence}".strip(), "program")
        raise Error(sentence, KINDS[self.code])

    def read(self, name: str, answer: str | Sequence[str]) -> dict[str, Any]:
        """A document that the program wrote beside its answer."""
        document = read_json(self.folder / name)
        require_format(document, answer, f"'{name}'")
        return document
