#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Breaks the arithmetic of the engine in one place at a time, and counts how often its tests notice.

A place is a sign, an operator, an index or a bound in a .cpp of Source/Engine, drawn with a seed. The file is changed
in memory only: it is compiled with the options of the build, linked ahead of the library, and the test of its library
runs, for ten times as long as without a change at most. The build must be one without unity files:

    cmake --preset release -B build-mutation -DEXCURSION_UNITY=OFF -DEXCURSION_PROGRAM=OFF \
        "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG"
    cmake --build build-mutation --target tests_signal tests_linear ...
    Tests/Mutation/mutate.py --build build-mutation --places 60 --seed 1 Signal Linear

A change that no test notices is printed with its line: either it changes nothing that counts (tell by hand), or a test
is missing.
"""
import argparse
import json
import os
import random
import re
import shlex
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ENGINE = ROOT / "Source" / "Engine"

# What is looked for, and what stands there instead. Spaces as clang-format puts them tell a binary operator.
KINDS = [
    ("sign", re.compile(r" \+ "), " - "),
    ("sign", re.compile(r" - "), " + "),
    ("sign", re.compile(r" \+= "), " -= "),
    ("sign", re.compile(r" -= "), " += "),
    ("sign", re.compile(r"(?<=[(,=] )-(?=[A-Za-z(])|(?<=\()-(?=[A-Za-z(])|(?<=return )-(?=[A-Za-z(])"), ""),
    ("operator", re.compile(r" \* "), " / "),
    ("operator", re.compile(r" / "), " * "),
    ("operator", re.compile(r" && "), " || "),
    ("operator", re.compile(r" \|\| "), " && "),
    ("operator", re.compile(r"std::max(?=\()"), "std::min"),
    ("operator", re.compile(r"std::min(?=\()"), "std::max"),
    ("bound", re.compile(r" < "), " <= "),
    ("bound", re.compile(r" <= "), " < "),
    ("bound", re.compile(r" > "), " >= "),
    ("bound", re.compile(r" >= "), " > "),
    ("index", re.compile(r"(?<=[\[(])([A-Za-z_]\w*)(?=\])"), r"\1 + 1"),
    ("index", re.compile(r"(?<=[ (\[,-])1(?=[\])])"), "2"),
    ("number", re.compile(r"(?<![\w.])2\.0(?!\w)"), "3.0"),
    ("number", re.compile(r"(?<![\w.])0\.5(?!\w)"), "0.6"),
    ("number", re.compile(r"(?<![\w.])1\.0(?!\w)"), "1.1"),
]


def code_spans(text):
    """The text without comments, strings and preprocessor lines, of the same length."""
    blank = lambda match: re.sub(r"[^\n]", " ", match.group())
    text = re.sub(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', blank, text, flags=re.S)
    text = re.sub(r"^[ \t]*(#|template|using|namespace|static_assert)[^\n]*", blank, text, flags=re.M)
    return re.sub(r"<[A-Za-z_][\w:<>, *&]*>", blank, text)  # arguments of templates


def places(file):
    text = file.read_text()
    code = code_spans(text)
    found = []
    for kind, pattern, instead in KINDS:
        for match in pattern.finditer(code):
            new = match.expand(instead) if "\\" in instead else instead
            found.append((file, match.start(), match.end(), new, kind))
    return found


class Build:
    def __init__(self, folder):
        self.folder = folder
        self.times = {}

    def commands(self, target):
        out = subprocess.run(["ninja", "-C", self.folder, "-t", "commands", target], capture_output=True, text=True)
        return out.stdout.splitlines()

    def compile_command(self, library, source):
        archive = f"libexcursion_{library.lower()}.a"
        for line in self.commands(archive):
            if line.rstrip().endswith(str(source)) and " -c " in line:
                words = shlex.split(line)
                while not re.search(r"(c\+\+|g\+\+|clang\+\+)[^/]*$", words[0]):  # the launcher
                    words.pop(0)
                return words
        return None

    def link_command(self, test):
        line = self.commands(f"Tests/{test}")[-1]
        return shlex.split(line[line.index("&& ") + 3 : line.rindex(" &&")])

    def time(self, test, arguments):
        if test not in self.times:
            begin = time.time()
            done = subprocess.run([f"{self.folder}/Tests/{test}", *arguments], cwd=ROOT, capture_output=True)
            if done.returncode:
                sys.exit(f"{test} fails without a change.")
            self.times[test] = time.time() - begin
        return self.times[test]


def try_one(build, library, tests, arguments, place, scratch):
    file, first, last, new, kind = place
    text = file.read_text()
    changed = scratch / file.name
    changed.write_text(text[:first] + new + text[last:])
    words = build.compile_command(library, file)
    if words is None:
        return "not built"
    here = scratch / "changed.o"
    words[words.index("-o") + 1] = str(here)
    words[-1] = str(changed)
    for flag in ("-MF", "-MT"):
        if flag in words:
            words[words.index(flag) + 1] = str(scratch / "changed.d")
    words += [f"-I{file.parent}", "-w"]
    if subprocess.run(words, cwd=build.folder, capture_output=True).returncode:
        return "not compiled"
    for test in tests:
        limit = 10.0 + 10.0 * build.time(test, arguments)
        link = build.link_command(test)
        program = scratch / "changed"
        link[link.index("-o") + 1] = str(program)
        link.insert(link.index("-o"), str(here))
        done = subprocess.run(link, cwd=build.folder, capture_output=True, text=True)
        if done.returncode and test == tests[0]:
            return "not linked"
        if done.returncode:  # a program of layers below, which knows nothing of this one
            continue
        try:
            done = subprocess.run([str(program), *arguments], cwd=ROOT, capture_output=True, timeout=limit)
        except subprocess.TimeoutExpired:
            return "noticed"
        if done.returncode:
            return "noticed"
    return "missed"


def missed_in(log):
    """The places that an earlier run, of which this is the output, has missed."""
    for line in Path(log).read_text().splitlines():
        told = re.match(r"missed\s+(\S+):(\d+): '(.*?)' -> '(.*?)': ", line)
        if not told:
            continue
        file, at, old, new = ROOT / told[1], int(told[2]), told[3], told[4]
        text = file.read_text()
        begin = sum(len(row) + 1 for row in text.split("\n")[: at - 1])
        for place in places(file):
            on_line = begin <= place[1] < begin + len(text.split("\n")[at - 1])
            if on_line and text[place[1] : place[2]] == old and place[3] == new:
                yield place
                break


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("libraries", nargs="*", help="folders of Source/Engine, such as Signal")
    options.add_argument("--build", default="build-mutation")
    options.add_argument("--places", type=int, default=60)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--also", type=lambda names: names.split(","), default=[],
                         help="test programs that are asked as well: tests_properties,tests_linear")
    options.add_argument("--again", help="output of an earlier run: try what it missed once more")
    options.add_argument("--json", help="write what became of each place")
    options.add_argument("--filter", default="~[.]~[slow]", help="of the tests, Catch's")
    options = options.parse_args()
    build = Build(str((ROOT / options.build).resolve()))
    rng = random.Random(options.seed)
    if options.again:
        chosen = list(missed_in(options.again))
    else:
        drawn = [[p for file in sorted((ENGINE / name).rglob("*.cpp")) for p in places(file)]
                 for name in options.libraries]
        for pool in drawn:
            rng.shuffle(pool)
        chosen = [pool[k] for k in range(options.places) for pool in drawn if k < len(pool)][: options.places]
    count, results = {}, []
    with tempfile.TemporaryDirectory() as folder:
        for place in chosen:
            name = place[0].relative_to(ENGINE).parts[0]
            own = f"tests_{name.lower()}"
            tests = [own, *(test for test in options.also if test != own)]
            told = try_one(build, name, tests, [options.filter], place, Path(folder))
            file, first, last, new, kind = place
            text = file.read_text()
            line = text.count("\n", 0, first) + 1
            count[told] = count.get(told, 0) + 1
            results.append({"file": str(file.relative_to(ROOT)), "line": line, "kind": kind, "told": told,
                            "from": text[first:last], "to": new, "text": text.splitlines()[line - 1].strip()})
            one = results[-1]
            print(f"{told:12} {one['file']}:{line}: '{one['from']}' -> '{new}': {one['text']}", flush=True)
    tried = count.get("noticed", 0) + count.get("missed", 0)
    print(f"{count.get('noticed', 0)} of {tried} noticed",
          {k: v for k, v in count.items() if k not in ("noticed", "missed")})
    if options.json:
        Path(options.json).write_text(json.dumps(results, indent=1) + "\n")


if __name__ == "__main__":
    main()
