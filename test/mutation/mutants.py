"""Mutants: copies of a source in which one place is wrong, as a slip of the hand makes it.

sign          a + b        becomes  a - b, or the other way round; -a becomes a
bound         a < b        becomes  a <= b, and so on
off by one    a + 1        becomes  a, or a + 2; the same of a - 1
dropped term  a + b * c    becomes  a; a sum or a product loses a term, a statement `a += b;` goes

They are made of the text as clang-format leaves it. Comments, strings and preprocessor lines stay.
"""

import random
import re
from dataclasses import dataclass
from pathlib import Path

KINDS = ("sign", "bound", "off by one", "dropped term")
BOUNDS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">"}

OPERAND = r"[\w.:\[\]()>*-]*?[\w\])]"
NOT_CODE = re.compile(r'//.*|"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])\'')


@dataclass(frozen=True)
class Mutant:
    """One line of a source, as it is and as it would be."""

    kind: str
    file: str
    line: int  # from 1
    before: str
    after: str

    def apply(self, root):
        path = Path(root) / self.file
        lines = path.read_text().splitlines(keepends=True)
        assert lines[self.line - 1].rstrip("\n") == self.before, f"{path}:{self.line} has changed"
        lines[self.line - 1] = self.after + "\n"
        path.write_text("".join(lines))


def masked(line):
    """The line with blanks in place of comments and literals, so that columns stay."""
    return NOT_CODE.sub(lambda found: " " * len(found.group()), line)


def is_code(line):
    text = line.strip()
    return bool(text) and not text.startswith(("#", "template", "using ", "static_assert", "assert("))


def changes_of(line):
    """Yields (kind, line after) of all slips of a line."""
    code = masked(line)

    def changed(begin, end, text):
        return (line[:begin] + text + line[end:]).rstrip()

    for found in re.finditer(r"(?<=[\w)\]]) ([+-])(=?) (?=[\w(-])", code):
        other = "-" if found.group(1) == "+" else "+"
        yield "sign", changed(found.start(), found.end(), f" {other}{found.group(2)} ")
    for found in re.finditer(r"(?<=[(,=] )-(?=[\w(])|(?<=\()-(?=[\w(])|(?<=return )-(?=[\w(])", code):
        yield "sign", changed(found.start(), found.end(), "")
    for found in re.finditer(r"(?<=[\w)\]]) (<=|>=|<|>) (?=[\w(-])", code):
        yield "bound", changed(found.start(), found.end(), f" {BOUNDS[found.group(1)]} ")
    for found in re.finditer(r" ([+-]) 1(?=[;,)\]\s])", code):
        yield "off by one", changed(found.start(), found.end(), "")
        yield "off by one", changed(found.start(), found.end(), f" {found.group(1)} 2")
    for found in re.finditer(rf"(?<=[\w)\]]) [+*-] ({OPERAND})(?=[;,]| [+-]|\)+[;,])", code):
        if balanced(found.group(1)):
            yield "dropped term", changed(found.start(), found.end(), "")
    if re.fullmatch(r"\s+[\w.:\[\]()>-]+ [+*-]= .*;\s*", code) and balanced(code):
        yield "dropped term", ""


def balanced(text):
    return text.count("(") == text.count(")") and text.count("[") == text.count("]")


def mutants_of(root, file):
    """All mutants of a source."""
    result = []
    for number, line in enumerate((Path(root) / file).read_text().splitlines(), start=1):
        if not is_code(line):
            continue
        for kind, after in changes_of(line):
            result.append(Mutant(kind, file, number, line, after))
    return result


def draw(root, folders, seed):
    """Endless: each time a kind, of which each mutant of the folders' sources is as likely."""
    files = sorted(
        str(path.relative_to(root))
        for folder in folders
        for path in (Path(root) / folder).rglob("*.cpp")
        if "config" not in path.name
    )
    by_kind = {kind: [] for kind in KINDS}
    for file in files:
        for mutant in mutants_of(root, file):
            by_kind[mutant.kind].append(mutant)
    dice = random.Random(seed)
    drawn = set()
    while any(set(mutants) - drawn for mutants in by_kind.values()):
        kind = dice.choice(KINDS)
        left = [mutant for mutant in by_kind[kind] if mutant not in drawn]
        if left:
            mutant = dice.choice(left)
            drawn.add(mutant)
            yield mutant
