#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the headers of Source/Engine declare is used by Source or by an example, not by tests alone.

    python3 Reached.py FOLDER_OF_THE_PROJECT

Functions go by their names, so one overload speaks for all. A line at the margin declares or defines the first name
that an opening parenthesis follows; a member is declared by such a line of a header, four blanks in. All else uses it.
"""
import re
import sys
from pathlib import Path

NO_CODE = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|^[ \t]*#[^\n]*', re.DOTALL | re.MULTILINE)
NO_DECLARATION = r"(?!(?:using|namespace|struct|class|enum|friend|return|else|if|for|while|throw|case|alignas)\b)"
TYPE_AND_NAME = r"[\w:][\w:<>,&*\s\[\]]*[\s&*>]([A-Za-z_]\w*)\("
FUNCTION = re.compile(NO_DECLARATION + TYPE_AND_NAME)
MEMBER = re.compile("    " + NO_DECLARATION + TYPE_AND_NAME)
AT_MARGIN = re.compile(r"(?=\S).*?\b([A-Za-z_]\w*)\(")


def code(path):
    return NO_CODE.sub("", path.read_text(encoding="utf-8")).split("\n")


def main(root):
    declared, used = {}, set()
    for folder in ("Source", "examples"):
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in (".h", ".cpp"):
                continue
            header = path.suffix == ".h"
            for line in code(path):
                names = re.findall(r"[A-Za-z_]\w*", line)
                found = AT_MARGIN.match(line) or header and MEMBER.match(line)
                if found:
                    names.remove(found[1])
                if header and "Engine" in path.parts and (FUNCTION.match(line) or MEMBER.match(line)):
                    declared.setdefault(found[1], path.relative_to(root))
                used.update(names)
    if len(declared) < 800:
        sys.exit(f"Only {len(declared)} functions were found.")
    unreached = sorted(f"{path}: {name}" for name, path in declared.items() if name not in used)
    if unreached:
        sys.exit("Used by nothing in Source and examples, by tests at most:\n" + "\n".join(unreached))
    print(f"{len(declared)} functions")


main(Path(sys.argv[1]))
