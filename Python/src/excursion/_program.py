# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the ``excursion`` program is, and how it is run and stopped."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Callable

from ._errors import Error

#: Called with the share of the work that is done, 0 to 1, and a short phrase such as "fitting stiffness".
Progress = Callable[[float, str], None]

_NAME = "excursion.exe" if os.name == "nt" else "excursion"
_PATIENCE = 10.0  # seconds that a stopped program has to leave


def _checkouts() -> Iterator[Path]:
    """Folders that hold the sources and may have been built: around this file, and around where we are."""
    for start in (Path(__file__).resolve().parent, Path.cwd()):
        for folder in (start, *start.parents):
            if (folder / "Source" / "Cli" / "main.cpp").is_file():
                yield folder


def program() -> str:
    """The path of the ``excursion`` program.

    The environment variable ``EXCURSION`` names it; else it is the one on the PATH; else that in the ``build`` folder
    of the checkout around this package or around the current folder.
    """
    named = os.environ.get("EXCURSION")
    if named:
        found = shutil.which(named)
        if found is None:
            raise Error(
                f"The environment variable EXCURSION names '{named}', which is no program; set it to the path "
                "of excursion.",
                "program",
            )
        return os.path.abspath(found)
    found = shutil.which("excursion")
    if found:
        return os.path.abspath(found)
    for folder in _checkouts():
        built = folder / "build" / _NAME
        if os.access(built, os.X_OK):
            return str(built)
    raise Error(
        "The program excursion was not found; build it, and put it on the PATH or set the environment variable "
        "EXCURSION to its path.",
        "program",
    )


def version() -> str:
    """The version of the program, such as "0.1.0"."""
    path = program()
    try:
        said = subprocess.run(
            [path, "--version"], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=True
        ).stdout
    except (OSError, subprocess.CalledProcessError) as trouble:
        raise Error(f"'{path}' does not tell its version; is it excursion?", "program") from trouble
    return said.strip()


def run(arguments: Sequence[str], folder: str, progress: Progress | None = None) -> tuple[int, str]:
    """Runs the program in ``folder``: its exit code, and what it complained of.

    Whatever ends the wait, KeyboardInterrupt or an exception of ``progress``, ends the program first.
    """
    words = [program(), "--quiet", *(["--progress"] if progress else []), *arguments]
    try:
        # In a session of its own a Ctrl-C of the terminal reaches us alone: we pass it on, once.
        process = subprocess.Popen(
            words,
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            encoding="utf-8",
            errors="replace",
            start_new_session=True,
        )
    except OSError as trouble:
        raise Error(f"'{words[0]}' cannot be run ({trouble.strerror}).", "program") from trouble
    assert process.stderr is not None
    said = []
    try:
        for line in process.stderr:
            told = line.split(maxsplit=2) if progress and line.startswith("progress ") else []
            if progress and len(told) >= 2:
                progress(float(told[1]), told[2].strip() if len(told) > 2 else "")
            else:
                said.append(line)
        code = process.wait()
    except BaseException:
        _stop(process)
        raise
    finally:
        process.stderr.close()
    return code, "".join(said).strip()


def _stop(process: subprocess.Popen[str]) -> None:
    """Asks the program to stop, as Ctrl-C does, and waits; ends it where it does not listen."""
    try:
        if os.name == "posix":
            process.send_signal(signal.SIGINT)
        else:
            process.terminate()
        process.communicate(timeout=_PATIENCE)
    except (subprocess.TimeoutExpired, KeyboardInterrupt):
        process.kill()
        process.wait()
