#!/usr/bin/env python3
"""check_sources.py names|clock ROOT: what no compiler checks, over the sources of ROOT.

names: in unnamed namespaces, names differ within each list of sources of a CMakeLists.txt, because
       any of them may be compiled as one. Overloads count: that they compile is luck.
clock: only nodes and what drives the network ask for the time or own threads.

Reads what clang-format writes: a definition in a namespace begins in the first column.
"""

import re
import sys
from collections import defaultdict
from pathlib import Path

ROOMS = ["shared", "robot", "cloud", "deploy", "test"]
NO_DEFINITION = re.compile(
    r"[A-Z][A-Z_0-9]+\(|(?:template|static_assert|using namespace|using enum|using [\w:]+;|"
    r"namespace|friend|extern|requires)\b|.*\boperator\b"
)
TYPE = re.compile(r"(?:struct|class|union|enum class|enum|concept)\s+(?:alignas\(\w+\)\s*)?(\w+)")
ALIAS = re.compile(r"using\s+(\w+)\s*=")
OTHER = re.compile(r"([\w:]+)(?:\[[^\]]*\])*\s*(?:\(|\{|=|;|$)")


def defined_name(line):
    """The name that a line defines, or None. That of a member, as A::b, is its class's."""
    if NO_DEFINITION.match(line):
        return None
    match = TYPE.match(line) or ALIAS.match(line)
    if not match:
        while (without := re.sub(r"<[^<>]*>", "", line)) != line:
            line = without
        match = OTHER.search(line)
    return match[1] if match and "::" not in match[1] else None


def unnamed_definitions(text):
    """Names that unnamed namespaces of a source define, each with its first line."""
    namespaces = []
    for line in text.splitlines():
        if match := re.match(r"(?:inline )?namespace\s*([\w:]*)\s*\{", line):
            namespaces.append(match[1])
        elif line.startswith("}  // namespace"):
            namespaces.pop()
        elif "" in namespaces and re.match(r"[A-Za-z_]", line):
            if name := defined_name(line):
                yield name, line


def lists_of_sources(root):
    """Each command of each CMakeLists.txt that names sources, with those sources."""
    for room in ROOMS:
        for file in sorted((root / room).rglob("CMakeLists.txt")):
            for arguments in re.findall(r"\(([^()]*)\)", file.read_text()):
                words = [word for word in arguments.split() if word.endswith(".cpp")]
                # A library may name another folder: fleetloc_test(NAME test/unit SOURCES ...).
                folders = [file.parent] + [root / word for word in arguments.split() if "/" in word]
                sources = {f.resolve(): f for w in words for d in folders if (f := d / w).is_file()}
                if sources:
                    yield file, sources


def check_names(root):
    checked = set()
    for cmake, sources in lists_of_sources(root):
        places = defaultdict(dict)
        for source in sources:
            checked.add(source)
            for name, line in unnamed_definitions(source.read_text()):
                places[name].setdefault(source, line)
        for name, lines in sorted(places.items()):
            # The same alias twice is no error, and means the same.
            is_alias = len(set(lines.values())) == 1 and ALIAS.match(next(iter(lines.values())))
            if len(lines) > 1 and not is_alias:
                files = ", ".join(str(f.relative_to(root)) for f in sorted(lines))
                yield f"{cmake.parent.relative_to(root)}: '{name}' in unnamed namespaces of {files}"
    print(f"checked {len(checked)} sources")
    if not checked:
        yield "no sources"


CLOCK_OR_THREAD = re.compile(
    r"(?:system|steady|high_resolution)_clock::now|\bboot_time\(|std::(?:jthread|thread|mutex)\b"
)
# Nodes, the network, and what they are made of.
OWNERS = re.compile(
    r"(?:shared/(?:concurrency|service|transport|core/boot_time)|"
    r"robot/(?:node|runtime)|cloud/node)\b"
)


def check_clock(root):
    count = 0
    for room in ["shared", "robot", "cloud"]:
        for file in sorted((root / room).rglob("*.[ch]pp")):
            path = file.relative_to(root)
            count += 1
            if OWNERS.match(str(path)):
                continue
            for number, line in enumerate(file.read_text().splitlines(), 1):
                if CLOCK_OR_THREAD.search(line.split("//")[0]):
                    yield f"{path}:{number}: time and threads are for nodes: {line.strip()}"
    print(f"checked {count} files")
    if count == 0:
        yield "no sources"


def main():
    checks = {"names": check_names, "clock": check_clock}
    check, root = sys.argv[1:]
    errors = list(checks[check](Path(root).resolve()))
    for error in errors:
        print(error, file=sys.stderr)
    sys.exit(1 if errors else 0)


main()
