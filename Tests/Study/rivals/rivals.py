# SPDX-License-Identifier: GPL-3.0-or-later
"""Other ways to name the effects in a loudspeaker, on takes that the study has kept.

    excursion_study --keep DIR --json STUDY ...
    python3 rivals.py DIR --study STUDY --json OUT

DIR has NAME/take and NAME/truth.json, where NAME is the seed. All rivals see the same columns, computed from the measured
signals; their thresholds are tuned to the truth, on all takes and, for an honest figure, on half
of them. PySINDy takes part if it is installed."""

import argparse
import json
import os
import statistics
import sys
import time
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np  # noqa: E402

import contest  # noqa: E402
import scores  # noqa: E402
import sparse  # noqa: E402
from problem import FLOOR_DB, make_problem  # noqa: E402
from takes import read_study, read_take  # noqa: E402


def listed(effects):
    return " ".join(sorted(effects)) or "-"


def ask_all(folder, floor_db, report):
    """Truth, answers and seconds for the columns, by name of the take."""
    result = {}
    for name, take, truth in read_study(folder):
        begin = time.perf_counter()
        try:
            problem = make_problem(read_take(take), floor_db)
        except (KeyError, ValueError, np.linalg.LinAlgError) as failure:
            report(f"{name}: the columns failed, nothing is named: {failure!r}")
            problem = None
        seconds = time.perf_counter() - begin
        result[name] = truth, contest.answers(problem), seconds
        report(f"{name}: {seconds:.1f} s for the columns")
    return result


def describe(total):
    return {"precision": total.precision(), "recall": total.recall(), "f1": total.f1(),
            "shown": total.shown, "found": total.found, "false": total.false,
            "controls": total.controls, "controlsUntouched": total.untouched,
            "recallOf": {e: [total.found_of[e], n] for e, n in sorted(total.shown_of.items())},
            "falseOf": dict(sorted(total.false_of.items()))}


def judge(results):
    """The summary of every rival, and what it names in each take."""
    truths = [truth for truth, _, _ in results.values()]
    columns = statistics.median(seconds for _, _, seconds in results.values())
    summary, named = {}, {name: {} for name in results}
    for key in contest.present():
        rival, count = contest.RIVALS[key], len(contest.RIVALS[key].grid)
        answers = [a[key] for _, a, _ in results.values()]
        place = scores.best(truths, answers, count)
        honest, places = scores.halves(truths, answers, count)
        entry = {"name": rival.name, "threshold": float(rival.grid[place]), "unit": rival.unit,
                 "told": rival.told,
                 "medianSeconds": columns + statistics.median(a.seconds for a in answers),
                 "best": describe(scores.score(truths, [a.named[place] for a in answers])),
                 "halves": {"thresholds": [float(rival.grid[n]) for n in places],
                            **describe(honest)}}
        if rival.textbook:
            entry["textbook"] = {"rule": rival.textbook, **describe(
                scores.score(truths, [a.textbook for a in answers]))}
        summary[key] = entry
        for name, answer in zip(results, answers):
            named[name][key] = {"best": sorted(answer.named[place])}
            if rival.textbook:
                named[name][key]["textbook"] = sorted(answer.textbook)
            if answer.scores:
                named[name][key]["scores"] = {e: round(float(v), 4)
                                              for e, v in answer.scores.items()}
    return summary, named


def excursion(results, study):
    """The entry of Excursion itself, on the takes that the study has."""
    takes = {str(take["seed"]): take for take in json.loads(Path(study).read_text())["takes"]}
    mine = [(truth, takes[name]) for name, (truth, _, _) in results.items() if name in takes]
    if not mine:
        raise ValueError(f"{study} has none of these takes")
    return {"name": "Excursion", "told": "the voltage and the units of the channels, nothing else",
            "medianSeconds": statistics.median(take["improveSeconds"] for _, take in mine),
            "takes": len(mine),
            "best": describe(scores.score([truth for truth, _ in mine],
                                          [set(take["added"]) for _, take in mine]))}


def row(name, part, rest=""):
    return (f"  {name:38s} {part['precision']:6.3f} {part['recall']:6.3f} {part['f1']:6.3f}"
            f"  {part['found']:4d}/{part['shown']:<4d} {part['false']:4d}"
            f"  {part['controlsUntouched']:3d}/{part['controls']:<3d} {rest}")


def table(summary):
    lines = [f"  {'':38s} precis recall     F1   found      false controls"]
    for entry in summary.values():
        if "threshold" not in entry:
            lines.append(row(entry["name"], entry["best"],
                             f"{entry['takes']} takes; {entry['medianSeconds']:.0f} s a take"))
            continue
        lines.append(row(f"{entry['name']}, threshold best here", entry["best"],
                         f"{entry['threshold']:.3g} {entry['unit']}; "
                         f"{entry['medianSeconds']:.1f} s a take"))
        lines.append(row(f"{entry['name']}, from other half", entry["halves"]))
        if "textbook" in entry:
            lines.append(row(f"{entry['name']}, {entry['textbook']['rule']}", entry["textbook"]))
    lines.append("\n  found of shown (and false), threshold best here")
    lines.append("  " + " " * 20 + "".join(f"{key:>16s}" for key in summary))
    effects = sorted({e for s in summary.values()
                      for e in (*s["best"]["recallOf"], *s["best"]["falseOf"])})
    for effect in effects:
        cells = []
        for entry in summary.values():
            found, shown = entry["best"]["recallOf"].get(effect, (0, 0))
            cells.append(f"{found}/{shown} ({entry['best']['falseOf'].get(effect, 0)})")
        lines.append(f"  {effect:20s}" + "".join(f"{c:>16s}" for c in cells))
    lines.append(f"\n  The rivals are told: {contest.COMMON}. Beside, or Excursion instead:")
    lines += [f"    {entry['name']:20s} {entry['told']}" for entry in summary.values()]
    lines.append(f"  PySINDy {sparse.version()}" if sparse.available()
                 else "  PySINDy was not there; its rivals did not run.")
    return "\n".join(lines)


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", metavar="DIR", help="has NAME/take and NAME/truth.json")
    parser.add_argument("--study", metavar="STUDY", help="results of the study on the same takes")
    parser.add_argument("--json", metavar="OUT", help="file for all results")
    parser.add_argument("--floor", type=float, default=FLOOR_DB, metavar="DB",
                        help="of a level's power, below which no error counts (%(default)s)")
    options = parser.parse_args(arguments)
    results = ask_all(options.folder, options.floor, lambda text: print(text, file=sys.stderr))
    if not results:
        parser.error(f"there is no NAME/truth.json in {options.folder}")
    summary, named = judge(results)
    if options.study:
        summary["excursion"] = excursion(results, options.study)
    for name, (truth, _, _) in results.items():
        print(f"{name}: hidden {listed(truth['hidden'])}")
        for key in contest.present():
            print(f"    {contest.RIVALS[key].name:18s} {listed(named[name][key]['best'])}")
    print(f"\n{len(results)} takes\n" + table(summary))
    if options.json:
        document = {"format": "excursion-rivals", "version": 1, "pysindy": sparse.version(),
                    "told": contest.COMMON,
                    "floorDb": options.floor, "rivals": summary,
                    "takes": [{"name": name, "hidden": truth["hidden"],
                               "showDb": truth["showDb"], "columnsSeconds": seconds,
                               "named": named[name]}
                              for name, (truth, _, seconds) in results.items()]}
        with open(options.json, "w", encoding="utf-8") as file:
            json.dump(document, file, indent=1)
            file.write("\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
