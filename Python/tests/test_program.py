# SPDX-License-Identifier: GPL-3.0-or-later
"""The program is found, its refusals are exceptions, and it ends when it is told to."""

from __future__ import annotations

import os
import signal
import subprocess
import threading
import time

import numpy as np
import pytest

import excursion
from excursion import _program


@pytest.fixture
def away(tmp_path, monkeypatch):
    """Nowhere near a checkout, with no program on the PATH."""
    monkeypatch.delenv("EXCURSION", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    monkeypatch.setattr(_program, "__file__", str(tmp_path / "site-packages" / "excursion" / "_program.py"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def script(path, body: str) -> str:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\n{body}\n")
    path.chmod(0o755)
    return str(path)


def test_a_missing_program_is_told(away):
    with pytest.raises(excursion.Error, match=r"was not found.*EXCURSION") as told:
        excursion.check(excursion.Take(8000, voltage=[1.0]))
    assert told.value.kind == "program"


def test_a_wrong_variable_is_told(away, monkeypatch):
    monkeypatch.setenv("EXCURSION", str(away / "gone"))
    with pytest.raises(excursion.Error, match=r"EXCURSION names '.*gone', which is no program") as told:
        excursion.program()
    assert told.value.kind == "program"


def test_the_variable_comes_before_the_path_before_the_checkout(away, monkeypatch):
    sources = away / "checkout"
    (sources / "Source" / "Cli").mkdir(parents=True)
    (sources / "Source" / "Cli" / "main.cpp").touch()
    (sources / "deep" / "down").mkdir(parents=True)
    monkeypatch.chdir(sources / "deep" / "down")
    with pytest.raises(excursion.Error, match="was not found"):  # it is not built
        excursion.program()
    built = script(sources / "build" / "excursion", "")
    assert excursion.program() == built
    monkeypatch.chdir(away)
    monkeypatch.setattr(_program, "__file__", str(sources / "Python" / "src" / "excursion" / "_program.py"))
    assert excursion.program() == built
    on_path = script(away / "bin" / "excursion", "")
    assert excursion.program() == on_path
    named = script(away / "named", "")
    monkeypatch.setenv("EXCURSION", named)
    assert excursion.program() == named


def test_program_and_package_are_of_one_version():
    assert excursion.version() == excursion.__version__


def answering(text: str, code: int = 0) -> str:
    """The body of a program that writes this where --json=FILE says."""
    return f"""for word in "$@"; do case $word in --json=*) cat > "${{word#--json=}}" <<'END'
{text}
END
;; esac; done
exit {code}"""


@pytest.mark.parametrize(
    ("body", "kind", "says"),
    [
        (
            answering('{"format": "excursion-check", "version": 2}'),
            "input",
            "check is of version 2.*expected 1.*same age",
        ),
        (
            answering('{"format": "excursion-bla", "version": 1}'),
            "input",
            "format 'excursion-bla', expected excursion-check",
        ),
        (answering('{"format": '), "input", "not a JSON document"),
        (answering("[1]"), "input", "not an object"),
        ("exit 0", "input", "cannot be read"),
        ("exit 1", "program", "ended with the code 1"),
        ("echo 'excursion: Internal error, please report it: x' >&2; exit 70", "program", "code 70. Internal error"),
        ("kill -11 $$", "program", "ended by signal 11"),
        ("echo 'excursion: The take is too short.' >&2; exit 4", "data", "^The take is too short.$"),
        ("echo 'excursion: The work was cancelled.' >&2; exit 6", "cancelled", "cancelled"),
    ],
)
def test_programs_that_answer_nonsense(tmp_path, monkeypatch, scratch, body, kind, says):
    monkeypatch.setenv("EXCURSION", script(tmp_path / "fake", body))
    with pytest.raises(excursion.Error, match=says) as told:
        excursion.check(excursion.Take(8000, voltage=[1.0]))
    assert told.value.kind == kind


def test_a_program_that_cannot_be_run(tmp_path, monkeypatch, scratch):
    broken = tmp_path / "broken"
    broken.write_text("#!/nowhere/sh\n")
    broken.chmod(0o755)
    monkeypatch.setenv("EXCURSION", str(broken))
    with pytest.raises(excursion.Error, match="cannot be run") as told:
        excursion.check(excursion.Take(8000, voltage=[1.0]))
    assert told.value.kind == "program"
    with pytest.raises(excursion.Error, match="does not tell its version"):
        excursion.version()


SHORT = excursion.Take(48000, voltage=np.sin(np.arange(4800) / 9), current=np.cos(np.arange(4800) / 9))


@pytest.mark.parametrize(
    ("call", "kind", "says"),
    [
        (lambda: excursion.fit(SHORT, ["stifness"]), "usage", "stifness"),
        (lambda: excursion.fit("/nowhere/take"), "input", "/nowhere/take"),
        (lambda: excursion.fit(np.zeros(3)), "usage", "ndarray was given where a take"),
        (lambda: excursion.compare(SHORT, 7), "usage", "int was given"),
        (lambda: excursion.compare(SHORT, "/nowhere/model.json"), "input", "model.json"),
        (lambda: excursion.bla(SHORT, "pressure"), "usage", 'no channel "pressure"'),
        (lambda: excursion.excite([1.0, 0.5]), "usage", "level"),
        (lambda: excursion.virtual(1, hidden={"stiffness": 7.0}), "usage", "between 0.01 and 0.8"),
        (lambda: excursion.virtual(1, driver="tweeter"), "usage", "tweeter"),
        (lambda: excursion.simulate(excursion.Model.linear(m=0.01, Rms=1.0, K=1e3), [1.0]), "usage", "rate="),
        (
            lambda: excursion.simulate(excursion.Model.linear(m=0.01, Rms=1.0, K=1e3), SHORT),
            "data",
            "driven by a force",
        ),
        (
            lambda: excursion.simulate(excursion.Model.linear(m=0.01, Rms=1.0, K=1e3), SHORT, 48000),
            "usage",
            "of its own",
        ),
        (lambda: excursion.Model.linear(m=0.01, Rms=1.0, K=1e3, Re=4.0), "usage", "all of Re, Le and Bl"),
        (lambda: excursion.Model({"format": "excursion-model", "version": 3}), "input", "version 3"),
        (lambda: excursion.Response([1.0, 2.0], [1.0]), "usage", "as many"),
        (lambda: excursion.Response([2.0, 1.0], [1.0, 1.0]), "input", "ascend"),
        (lambda: excursion.Response([1.0, 2.0], [1.0, np.nan]), "input", "finite"),
        (lambda: excursion.Response([1.0], [1.0], output="speed"), "usage", "no quantity 'speed'"),
        (lambda: excursion.Response([1.0], [1.0], noise_variance=[-1.0]), "usage", "noiseVariance"),
        (lambda: excursion.pnlss(SHORT, model={"format": "x"}), "input", "format 'x'"),
        (lambda: excursion.StateSpace([[1.0]], [1.0, 2.0], [1.0], [0.0]), "usage", "do not fit 1 inputs"),
        (lambda: excursion.import_take("/nowhere.csv"), "input", "nowhere.csv"),
    ],
)
def test_refusals_are_exceptions(scratch, call, kind, says):
    with pytest.raises(excursion.Error, match=says) as told:
        call()
    assert told.value.kind == kind


@pytest.mark.parametrize(
    ("voltage", "rate", "kind", "says"),
    [
        ([1.0, np.nan], 48000, "input", "not a finite number"),
        ([], 48000, "usage", r"shape \(0,\)"),
        (np.ones((2, 2, 2)), 48000, "usage", "samples by channels"),
        ([1j], 48000, "usage", "real samples"),
        ([1.0], 44100.5, "usage", "whole number"),
    ],
)
def test_signals_that_cannot_be_predistorted(scratch, voltage, rate, kind, says):
    model = excursion.Model.linear(Re=4.0, Le=1e-4, Bl=5.0, m=0.01, Rms=1.0, K=1e3)
    with pytest.raises(excursion.Error, match=says) as told:
        excursion.predistort(model, voltage, rate)
    assert told.value.kind == kind


def test_a_take_at_fault_is_refused_with_its_problems(stiff, scratch):
    samples = dict(stiff.take.samples)
    limit = 0.5 * np.max(np.abs(samples["current"]))
    samples["current"] = np.clip(samples["current"], -limit, limit)
    clipped = excursion.Take(stiff.take.rate, excitation=stiff.take.excitation, **samples)
    check = excursion.check(clipped)
    assert not check.fit_for_use
    assert "clipping" in set(check.problems["kind"])
    with pytest.raises(excursion.Error) as refused:
        excursion.fit(clipped)
    assert refused.value.kind == "refused"
    assert "clipping" in {problem["kind"] for problem in refused.value.document["problems"]}
    ladder = excursion.improve(clipped)
    assert (ladder.verdict, ladder.rungs, ladder.model) == ("bad-measurement", [], None)
    assert ladder.table().empty and len(ladder.problems) > 0


def test_progress_is_told_in_order(linear, told):
    shares = [share for share, _ in told]
    assert len(told) > 10 and shares == sorted(shares) and shares[0] < 0.1 and shares[-1] > 0.9
    assert all(0 <= share <= 1 and what for share, what in told)


@pytest.fixture
def processes(monkeypatch):
    """The processes that were started."""
    started = []
    real = subprocess.Popen

    def watched(*arguments, **options):
        started.append(real(*arguments, **options))
        return started[-1]

    monkeypatch.setattr(subprocess, "Popen", watched)
    return started


def test_ctrl_c_ends_the_program(stiff, processes, scratch, tmp_path):
    begun = threading.Event()

    def interrupt() -> None:
        begun.wait(10)
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=interrupt, daemon=True).start()
    started = time.monotonic()
    with pytest.raises(KeyboardInterrupt):  # between two lines of progress: nobody knows how long a ladder takes
        excursion.improve(stiff.take, out=tmp_path / "ladder", progress=lambda share, what: begun.set())
    assert time.monotonic() - started < 8
    assert [process.returncode for process in processes] == [6]  # it heard the Ctrl-C and said so
    assert not list((tmp_path / "ladder").glob("*")) if (tmp_path / "ladder").exists() else True


def test_an_exception_of_the_callback_ends_the_program(stiff, processes, scratch):
    def enough(share: float, what: str) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        excursion.improve(stiff.take, progress=enough)
    assert [process.returncode for process in processes] == [6]


def test_a_program_that_does_not_listen_is_ended(tmp_path, monkeypatch, processes, scratch):
    monkeypatch.setattr(_program, "_PATIENCE", 0.2)
    monkeypatch.setenv(
        "EXCURSION", script(tmp_path / "deaf", "trap '' INT; echo progress 0.5 x >&2; while :; do sleep 0.1; done")
    )

    def enough(share: float, what: str) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        excursion.improve(SHORT, progress=enough)
    assert [process.returncode for process in processes] == [-signal.SIGKILL]
