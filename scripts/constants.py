#!/usr/bin/env python3
"""Lists the constants of core, kernels, recovery and contact: place, name, value and the comment beside it, by kind; in the end the number of each
kind. The aim: at most 150 tuned ones, each with its reason; the others are derived, or settings with their source. What varying them changes:
scripts/vary_constants.py.

  scripts/constants.py [--kind KIND]... [--only PATTERN] [ROOT]

Read are definitions with `constexpr` of any scope and the members with a default of the structs of options in core/settings. The kind is
the first that holds:

  setting   member of a struct in core/settings (`cgcontact check SCENE --settings` prints them all)
  exact     no number: text, bool, a table of whole numbers or of rows, a struct without decimal numbers; a number, or a table of some, of seven
            digits or more: pi, Gauss points, units; an integer that is 0 or negative: a mark; or the comment says "by definition" or "exact:"
  derived   the value has a name in it: made of other constants
  size      an integer that counts what there is or how work is divided, which no result depends on: a word of its name is among WORDS_OF_SIZES
  rounding  at most 1e-6, or 1 but for that: what is less is rounding, in double precision or in the single precision of files
  drawing   in core/drawing or core/output: what pictures and pages look like
  input     in a room or file that reads, warns or writes scenes (INPUT): limits and tolerances of what is read
  tuned     all others: thresholds, factors, numbers of steps
"""
import argparse
import collections
import dataclasses
import pathlib
import re
import sys

LIBRARIES = ("core", "kernels", "recovery", "contact")
KINDS = ("tuned", "setting", "rounding", "input", "drawing", "size", "derived", "exact")
INPUT = ("core/base/", "core/expressions/", "core/scene/", "core/scene_file/", "core/decks/", "core/program/", "core/results/",
         "contact/plausibility", "contact/results/reference/reference")
OPTIONS = re.compile(r"core/settings/\w+_options\.hpp")
WORDS_OF_SIZES = {"num", "count", "size", "bit", "bits", "bytes", "lanes", "block", "chunk", "group", "thread", "leaf", "dofs", "nodes", "corners",
                  "columns", "rows", "row", "runs", "run", "slabs", "n", "degree", "index", "grain", "alignment", "cache", "header", "once"}
SINGLE_PRECISION = 1e-6
NUMBER = r"\d(?:[\w.]|'\w|(?<=[eE])[+-])*|\.\d[\w]*"
# What is no code: blanked out, so that places stay the same. Numbers first: they may hold apostrophes.
NO_CODE = re.compile(rf"""(?P<number>(?<![\w.])(?:{NUMBER})) | //[^\n]* | /\*.*?\*/ | R"(?P<mark>[^(\s]*)\(.*?\)(?P=mark)" | "(?:[^"\\\n]|\\.)*"
                      | '(?:[^'\\\n]|\\.)*' """, re.VERBOSE | re.DOTALL)
DEFINITION = re.compile(r"\bconstexpr\s+(?P<type>(?:(?:unsigned|long|const)\s+)*[\w:]+(?:<[^;={]*>)?)(?:::)?[\s*&]+(?P<names>\w)")
MEMBER = re.compile(r"^  (?P<type>double|int) (?P<names>\w)", re.MULTILINE)
INTEGER_TYPES = re.compile(r"int\b|size_t|int(\d+|max)_t|char|long|short|unsigned")
OF_TYPE = re.compile(r"\b(?:std::)?(?:size_t|u?int\w*_t)\{(\d+)\}")  # std::size_t{1}


@dataclasses.dataclass
class Constant:
    file: str
    line: int
    name: str
    type: str
    value: str
    start: int  # of the value in the file, in characters
    comment: str
    kind: str = ""

    def place(self):
        return f"{self.file}:{self.line}"


def without_comments(text):
    """The text with comments, strings and characters blanked out."""
    def blank(match):
        if match["number"]:
            return match[0]
        inside = re.sub(r"[^\n]", " ", match[0])
        return inside if match[0][0] == "/" else '"' + inside[1:-1] + '"'
    return NO_CODE.sub(blank, text)


def declarators(code, start):
    """Yields (begin, end) of each `name = value` of the definition whose names begin at `start`."""
    depth, begin = 0, start
    for i in range(start, len(code)):
        depth += (code[i] in "([{") - (code[i] in ")]}")
        if depth < 0:
            return
        if depth == 0 and code[i] in ",;":
            yield begin, i
            begin = i + 1
            if code[i] == ";":
                return


def comment_at(lines, k):
    """The comment behind line k (from 0), else the one above it and above the definitions without one directly before it."""
    behind = re.search(r"//+<?\s*(.*)$", lines[k])
    if behind:
        return behind[1]
    k -= 1
    while k >= 0 and re.match(r"\s*(static |inline )*(constexpr|double|int)\b[^/]*;$", lines[k]):
        k -= 1
    above = []
    while k >= 0 and re.match(r"\s*//", lines[k]):
        above.insert(0, re.sub(r"^\s*//+\s*", "", lines[k]))
        k -= 1
    return " ".join(above)


def value_of(expression):
    """The value of an expression of numbers; None: it has more than numbers."""
    plain = OF_TYPE.sub(r"\1", expression).replace("'", "")
    return eval(plain) if re.fullmatch(r"(?:[\d.\s()*/+<-]|(?<=[\d.])e[+-]?\d)+", plain, re.IGNORECASE) else None  # pylint: disable=eval-used


def digits_of(number):
    """Its significant digits."""
    return len(re.sub(r"[eE].*|\D", "", number).strip("0"))


def is_exact(constant, integer):
    value, numbers = OF_TYPE.sub(r"\1", constant.value), re.findall(NUMBER, constant.value)
    table, decimal = "{" in value, any(re.search(r"[.eE]", number) for number in numbers)
    if re.search(r"by definition|\bexact:", constant.comment, re.IGNORECASE) or '"' in value or not numbers and not re.search(r"[a-z]", value):
        return True
    if not integer and not re.search(r"double|float", constant.type) and not decimal:  # a struct, or bool
        return True
    if integer and re.fullmatch(r"0|-\d+", value):
        return True
    return table and (not decimal or re.search(r"\{\s*\{", value) or max(map(digits_of, numbers)) >= 7) or \
        not table and len(numbers) == 1 and digits_of(numbers[0]) >= 7


def kind_of(constant):
    integer = bool(INTEGER_TYPES.search(constant.type))
    if OPTIONS.fullmatch(constant.file):
        return "setting"
    if is_exact(constant, integer):
        return "exact"
    if re.search(r"[A-Za-z_]", re.sub(NUMBER, "", OF_TYPE.sub(r"\1", constant.value))):
        return "derived"
    if integer and {constant.name, *constant.name.split("_")} & WORDS_OF_SIZES:
        return "size"
    value = value_of(constant.value)
    if value is not None and not integer and min(abs(value), abs(value - 1) or 1) <= SINGLE_PRECISION:
        return "rounding"
    if constant.file.startswith(("core/drawing/", "core/output/")):
        return "drawing"
    return "input" if constant.file.startswith(INPUT) else "tuned"


def constants_of(file, text):
    code, lines, found = without_comments(text), text.split("\n"), []
    pattern = MEMBER if OPTIONS.fullmatch(file) else DEFINITION
    for match in pattern.finditer(code):
        for begin, end in declarators(code, match.start("names")):
            one = re.match(r"\s*(?:[\w:]+::\*)?[*&]*(?P<name>\w+)\s*(?:\[[^\]]*\]\s*)*(?:=\s*|(?=\{))(?P<value>.*)$", code[begin:end], re.DOTALL)
            if not one:
                continue
            start = begin + one.start("value")
            line = code.count("\n", 0, begin + one.start("name"))
            found.append(Constant(file, line + 1, one["name"], match["type"], text[start:end].rstrip(), start, comment_at(lines, line)))
    for constant in found:
        constant.kind = kind_of(constant)
    return found


def constants_in(root):
    """All constants below the root, in the order of files and lines."""
    return [constant for library in LIBRARIES for path in sorted((root / library).rglob("*.[ch]pp"))
            for constant in constants_of(path.relative_to(root).as_posix(), path.read_text(encoding="utf-8"))]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("root", nargs="?", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent.parent)
    parser.add_argument("--kind", action="append", choices=KINDS, help="list these only; may be repeated [default: tuned]")
    parser.add_argument("--only", default="", help="list those whose file:name matches this regular expression")
    options = parser.parse_args()
    found = constants_in(options.root)
    if not found:
        parser.error(f"{options.root}: has no constants in {', '.join(LIBRARIES)}")
    for constant in found:
        if constant.kind in (options.kind or ["tuned"]) and re.search(options.only, f"{constant.file}:{constant.name}"):
            value = " ".join(constant.value.split())
            print(f"{constant.place()}: {constant.name} = {value}" + (f"  // {constant.comment}" if constant.comment else ""))
    counts = collections.Counter(constant.kind for constant in found)
    silent = sum(constant.kind == "tuned" and not constant.comment for constant in found)
    print(", ".join(f"{counts[kind]} {kind}" for kind in KINDS) + f"; {len(found)} in all; {silent} tuned ones have no comment")
    return 0


if __name__ == "__main__":
    sys.exit(main())
