#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""score.py TRUTH LADDER: what a ladder (ladder.json, a diagnosis, a folder of `improve`, or the text that it printed)
made of a take. An effect that changes the measured channels by less than 6 dB over the noise need not be found."""
import json
import os
import re
import sys

LEAST = 6.0


def found(path):
    """verdict, effects in the model, effects that were withdrawn."""
    if os.path.isdir(path):
        path = os.path.join(path, "ladder.json")
    text = open(path).read()
    try:
        doc = json.loads(text)
    except ValueError:
        doc = None
    if doc is None:
        added = re.findall(r"^\s*\d+\s+\+ ([a-z-]+)", text, re.M)
        gone = re.findall(r"^\s*\d+\s+- ([a-z-]+)", text, re.M) + re.findall(r"without ([a-z-]+)", text)
        verdict = re.search(r"^verdict\s+(\S+?):", text, re.M)
        return verdict.group(1) if verdict else "none", [e for e in dict.fromkeys(added) if e not in gone], gone, None
    if doc.get("format") == "excursion-ladder":
        last = doc["rungs"][-1]
        ids = [e["effect"] for e in doc.get("known") or []]
        ids = ids or [e["id"] for e in last["model"]["effects"]]
        return doc["verdict"], ids, doc.get("withdrawn", []), last["fit"].get("chiSquaredPerValue")
    if doc.get("format") == "excursion-diagnosis":
        return doc["verdict"], [r["effect"] for r in doc["ranking"][:1] if r["significant"]], [], None
    raise SystemExit(f"{path} is neither a ladder nor a diagnosis")


def score(truth_path, ladder_path):
    truth = json.load(open(truth_path))
    verdict, ids, gone, chi = found(ladder_path)
    inside = {e["id"]: max(e["overNoiseDb"].values()) for e in truth["effects"]}
    allowed = set(inside)
    if truth["box"] == "closed":
        allowed.add("stiffness")                 # adiabatic air
        if max((truth.get("airOverNoiseDb") or {"": -99}).values()) > LEAST:
            inside.setdefault("stiffness", max(truth["airOverNoiseDb"].values()))
    must = [e for e, strength in inside.items() if strength >= LEAST]
    result = {
        "take": os.path.basename(truth_path).split(".")[0], "verdict": verdict, "chi": chi,
        "found": [e for e in must if e in ids], "missed": [e for e in must if e not in ids],
        "weak": [e for e in inside if e not in must], "false": [e for e in ids if e not in allowed],
        "withdrawn": gone, "unknown": [e["id"] for e in truth["unknown"]],
    }
    loud = [e for e in truth["unknown"] if max(e["overNoiseDb"].values()) >= LEAST]
    wanted = "unknown-effect" if loud else "complete"
    result["wanted"] = wanted
    result["right"] = verdict == wanted and not result["missed"] and not result["false"]
    return result


def main():
    if len(sys.argv) != 3:
        raise SystemExit("score.py TRUTH.json LADDER(.json, folder or text)")
    r = score(sys.argv[1], sys.argv[2])
    n = len(r["found"]) + len(r["missed"])
    print(f"{r['take']}: {'RIGHT' if r['right'] else 'wrong'}; verdict {r['verdict']} (wanted {r['wanted']}); "
          f"found {len(r['found'])}/{n}: {', '.join(r['found']) or '-'}; missed: {', '.join(r['missed']) or '-'}; "
          f"false: {', '.join(r['false']) or '-'}; chi2/value: {r['chi'] if r['chi'] is None else round(r['chi'], 2)}"
          + (f"; unknown: {', '.join(r['unknown'])}" if r["unknown"] else ""))
    return 0 if r["right"] else 1


if __name__ == "__main__":
    sys.exit(main())
