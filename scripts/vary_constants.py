#!/usr/bin/env python3
"""Varies constants (scripts/constants.py), one after the other, and prints what each changes in the results of scenes: those that change nothing may
be dead.

  scripts/vary_constants.py --build DIR [--vary FACTOR] [--kind KIND]... [--only PATTERN] [--count N] SCENE...

For each constant the changed value is written into a copy of this source tree, DIR/source, the program is built in DIR and runs the scenes; then the
file is as it was. FACTOR (default 1.2) multiplies the value; integers change by one at least; of a number within a tenth of 1, or below 1 that would
not stay below, such as a cosine, the distance from 1 is multiplied. A line for each constant has the largest relative changes of the figures below,
"nothing", or why there are none: it does not build, a scene fails or takes more than ten times as long (and a minute). Settings (--kind setting) are
in headers that nearly all files include: each takes a whole build.

  force, pressure (largest), outer, linear (iterations), estimates (all estimated errors), verdict, warnings, exit (code), residuals (of the outer
  iteration), other (anything else, with its place)

What is done stands in DIR/results.jsonl, a line for each constant: started again, the script takes it over and goes on, unless sources, scenes,
factor or --command have changed. --again takes nothing over; --summary only prints what stands there. Ctrl-C and SIGTERM leave the copy as it was; after
a crash the next start restores it.

  scripts/vary_constants.py --build /tmp/vary --only contact/groups/indentation scenes/two_solids.toml tests/scenes/pin.toml
"""
import argparse
import hashlib
import json
import math
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

import constants

ROOT = pathlib.Path(__file__).resolve().parent.parent
CONFIGURE = "cmake --preset serial -S {source} -B {build} --log-level=WARNING"
BUILD = "ninja -C {build} cgcontact"
PROGRAM = "{build}/cgcontact"
QUIET = ["--quiet", *(word for key in ("vtk", "csv", "plots", "report") for word in ("--set", f"output.{key}=false"))]
# Entries that tell of a run, not of its results.
NOT_COMPARED = re.compile(r"^(command|files|times_s|peak_memory_bytes|threads|backend|ranks|rank_figures|version|scene)\b|\bseconds$")
FIGURES = {"force": re.compile(r"^contact\[\d+\]\.(normal_force|force\b)"), "pressure": re.compile(r"^contact\[\d+\]\.max_pressure$"),
           "outer": re.compile(r"^outer_iterations$"), "linear": re.compile(r"^linear_iterations$"), "residuals": re.compile(r"residual"),
           "estimates": re.compile(r"error"), "verdict": re.compile(r"^(verdict\.|converged$|diagnosis$|accuracy\.(reached|text)$)"),
           "warnings": re.compile(r"^warnings$"), "exit": re.compile(r"^exit$")}
MARK = "made_by_vary_constants"  # file in DIR, where the script may write and delete
PATIENCE, MOMENT = 10, 60  # limit of a run: so many times that of the unchanged program, and s


class Failed(Exception):
    """Why there are no results."""


def varied(expression, factor, integer):
    """The number, or each of a table's, changed; as C++."""
    if expression.startswith("{"):
        return re.sub(rf"-?(?:{constants.NUMBER})", lambda number: varied(number[0], factor, integer), expression)
    value = constants.value_of(expression)
    if value is None:
        raise Failed(f"its value is more than numbers: {expression}")
    if value == 0:
        raise Failed("0 stays 0, whatever the factor")
    if integer:
        changed = round(value * factor)
        return str(changed if changed != value else value + (1 if factor > 1 else -1))
    near_one = abs(value - 1) < 0.1 and value != 1 or 0 < value < 1 <= value * factor
    return f"{1 + (value - 1) * factor if near_one else value * factor:.12g}"


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def figures(value, name=""):
    """Every number, vector of numbers and text in a report, by its place; warnings as one list."""
    if isinstance(value, dict):
        return {key: x for part in value for key, x in figures(value[part], f"{name}.{part}" if name else part).items()}
    if isinstance(value, list) and name != "warnings" and not all(map(is_number, value)):
        return {key: x for i, part in enumerate(value) for key, x in figures(part, f"{name}[{i}]").items()}
    return {name: value}


def change_of(name, a, b):
    """The relative change of a number or a vector; a text where there is no such."""
    if name == "warnings":
        return f"{len(a)} -> {len(b)}" if len(a) != len(b) else "other words"
    if name == "linear":
        return f"{sum(a)} -> {sum(b)}"
    if name in ("outer", "exit"):
        return f"{a} -> {b}"
    first, second = ([x] if is_number(x) else x for x in (a, b))
    if not all(isinstance(x, list) for x in (first, second)) or len(first) != len(second) or not math.hypot(*first):
        return f"{a} -> {b}"
    return math.dist(first, second) / math.hypot(*first)


def changes(before, after):
    """Figure -> largest relative change, or what became of a text, and its place; no figure that is the same."""
    found = {}
    for place in {**before, **after}:
        a, b = before.get(place), after.get(place)
        if NOT_COMPARED.search(place) or a == b:
            continue
        name = next((name for name, pattern in FIGURES.items() if pattern.search(place)), "other")
        change = change_of(name, a, b)
        old = found.get(name, [0])[0]
        if name not in found or not isinstance(old, str) and (isinstance(change, str) or change > old):
            found[name] = [change, place]
    return found


def told(found):
    """Changes in words."""
    def words(name, change, place):
        size = change if isinstance(change, str) else f"{100 * change:.2g} %"
        return f"{name} {size}"[:120] + (f" ({place})" if name == "other" else "")
    return ", ".join(words(name, *found[name]) for name in [*FIGURES, "other", "fails"] if name in found)


def call(command, log, timeout=None):
    """Runs a command to its end; its group dies with us. Returns the exit code."""
    with open(log, "w", encoding="utf-8") as file, subprocess.Popen(command, shell=isinstance(command, str), stdin=subprocess.DEVNULL, stdout=file,
                                                                   stderr=subprocess.STDOUT, start_new_session=True) as child:
        try:
            return child.wait(timeout)
        except BaseException as error:
            os.killpg(child.pid, signal.SIGKILL)
            child.wait()
            if isinstance(error, subprocess.TimeoutExpired):
                raise Failed(f"takes more than {timeout:.0f} s") from None
            raise


class Variation:
    """The copy of the sources, its builds and its runs."""

    def __init__(self, options):
        self.build = options.build.resolve()
        self.source = self.build / "source"
        self.command = options.command
        self.scenes = [scene.resolve() for scene in options.scenes]
        self.results = self.build / "results.jsonl"
        self.copy_sources()
        # A scene is known by its file and what lies beside it is taken to be as it was.
        libraries = tuple(f"{library}/" for library in constants.LIBRARIES)
        of_sources = b"".join((ROOT / file).read_bytes() for file in self.files if file.startswith(libraries))
        of_scenes = b"".join(str(scene).encode() + scene.read_bytes() for scene in self.scenes)
        self.version = hashlib.sha256(of_sources + of_scenes + f"{options.vary} {self.command}".encode()).hexdigest()[:16]

    def copy_sources(self):
        """Makes the copy like the tree; files that are the same keep their time, so that little is built again."""
        tracked = subprocess.run(["git", "-C", ROOT, "ls-files", "-z"], capture_output=True, text=True, check=True).stdout
        self.files = [file for file in tracked.split("\0") if file and (ROOT / file).is_file()]
        for file in self.files:
            there = self.source / file
            if not there.is_file() or there.read_bytes() != (ROOT / file).read_bytes():
                there.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(ROOT / file, there)
        known = {self.source / file for file in self.files}
        for there in self.source.rglob("*"):
            if not there.is_dir() and there not in known:
                there.unlink()

    def make(self):
        """Builds the program from the copy."""
        log, places = self.build / "build.log", {"source": self.source, "build": self.build}
        commands = [self.command] if self.command else [BUILD] if (self.build / "build.ninja").is_file() else [CONFIGURE, BUILD]
        for command in commands:
            if call(command.format(**places), log) != 0:
                raise Failed(f"does not build: {' '.join(log.read_text(errors='replace').split())[-300:]}")

    def keep(self, record):
        with open(self.results, "a+", encoding="utf-8") as file:
            file.seek(max(file.tell() - 1, 0))
            half = file.read(1) not in ("", "\n")  # a line that was being written when the machine stopped
            file.write("\n" * half + json.dumps(record) + "\n")

    def run(self, scene, limit):
        """The figures of a scene, and the seconds it took."""
        out, log, begin = self.build / "out", self.build / "run.log", time.monotonic()
        shutil.rmtree(out, ignore_errors=True)
        code = call([PROGRAM.format(build=self.build), "run", str(scene), "--out", str(out), *QUIET], log, limit)
        seconds = time.monotonic() - begin
        if code not in (0, 2) or not (out / "report.json").is_file():
            raise Failed(f"exit code {code}: {log.read_text(errors='replace').strip()[-300:]}")
        return {**figures(json.loads((out / "report.json").read_text(encoding="utf-8"))), "exit": code}, seconds

    def unchanged(self):
        """Scene -> figures and seconds of the unchanged program."""
        file = self.build / "unchanged.json"
        if file.is_file():
            known = json.loads(file.read_text(encoding="utf-8"))
            if known["version"] == self.version:
                return known["runs"]
        self.make()
        runs = {str(scene): self.run(scene, None) for scene in self.scenes}
        file.write_text(json.dumps({"version": self.version, "runs": runs}), encoding="utf-8")
        return runs

    def vary(self, constant, factor, unchanged):
        """What the constant changes: scene -> changes, or the reason why there is nothing to compare."""
        there = self.source / constant.file
        text = there.read_text(encoding="utf-8")
        end = constant.start + len(constant.value)
        changed = varied(constant.value, factor, bool(constants.INTEGER_TYPES.search(constant.type)))
        try:
            there.write_text(text[:constant.start] + changed + text[end:], encoding="utf-8")
            self.make()
            found = {}
            for scene, (figures_before, seconds) in unchanged.items():
                try:
                    found[scene] = changes(figures_before, self.run(scene, PATIENCE * seconds + MOMENT)[0])
                except Failed as error:
                    found[scene] = {"fails": [str(error), ""]}
            return {"value": changed, "scenes": found}
        finally:
            there.write_text(text, encoding="utf-8")


def line_of(record):
    """One line for a constant: what it changes in each scene."""
    head = f"{record['place']}: {record['name']} = {' '.join(record['before'].split())}"
    if "failed" in record:
        return f"{head}: {record['failed']}"
    head += f" -> {record['value']}: "
    if not any(record["scenes"].values()):
        return head + "nothing"
    return head + "; ".join(f"{pathlib.Path(scene).stem}: {told(found) or 'nothing'}" for scene, found in record["scenes"].items())


def records_of(variation):
    """Finished constants by their key, of the present sources, scenes and factor."""
    if not variation.results.is_file():
        return {}
    known = {}
    for line in variation.results.read_text(encoding="utf-8").splitlines():
        try:
            record = json.loads(line)
        except ValueError:  # written half, when it was stopped
            continue
        if record["version"] == variation.version:
            known[record["key"]] = record
    return known


def keyed(found):
    """Yields key and constant: file, name and, of several of one name there, the number."""
    seen = {}
    for constant in found:
        place = f"{constant.file}:{constant.name}"
        seen[place] = seen.get(place, 0) + 1
        yield place if seen[place] == 1 else f"{place}#{seen[place]}", constant


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", metavar="SCENE", nargs="+", type=pathlib.Path)
    parser.add_argument("--build", required=True, type=pathlib.Path, metavar="DIR", help="build directory of its own, made if need be")
    parser.add_argument("--vary", type=float, default=1.2, metavar="FACTOR", help="[default: 1.2]")
    parser.add_argument("--kind", action="append", choices=constants.KINDS, help="vary these; may be repeated [default: tuned]")
    parser.add_argument("--only", default="", metavar="PATTERN", help="vary those whose file:name matches this regular expression")
    parser.add_argument("--count", type=int, metavar="N", help="at most so many, of those not done yet")
    parser.add_argument("--command", metavar="TEXT", help=f"builds {{build}}/cgcontact from {{source}} [default: {CONFIGURE}; {BUILD}]")
    parser.add_argument("--again", action="store_true", help="take over nothing of an earlier run")
    parser.add_argument("--summary", action="store_true", help="print what is known, run nothing")
    options = parser.parse_args()
    if not options.vary > 0 or options.vary == 1:
        parser.error(f"--vary {options.vary}: out of range (allowed: > 0, not 1)")
    if options.count is not None and options.count < 1:
        parser.error(f"--count {options.count}: out of range (allowed: >= 1)")
    for scene in options.scenes:
        if not scene.is_file():
            parser.error(f"{scene}: no such file (allowed: scenes)")
    if options.build.exists() and not (options.build / MARK).is_file() and (not options.build.is_dir() or any(options.build.iterdir())):
        parser.error(f"--build {options.build}: holds something else (allowed: a new or empty directory, or one that this script has made)")
    return options


def work(options, variation):
    """Varies what is not done yet; prints a line for each, in the end how many changed nothing."""
    if options.again:
        variation.results.unlink(missing_ok=True)
    known, kinds = records_of(variation), options.kind or ["tuned"]
    chosen = [(key, constant) for key, constant in keyed(constants.constants_in(ROOT))
              if constant.kind in kinds and re.search(options.only, f"{constant.file}:{constant.name}")]
    left = [(key, constant) for key, constant in chosen if key not in known]
    for key, _ in chosen:
        if key in known:
            print(line_of(known[key]), flush=True)
    if left and not options.summary:
        unchanged = variation.unchanged()
        for key, constant in left[:options.count]:
            record = {"key": key, "version": variation.version, "place": constant.place(), "name": constant.name, "before": constant.value}
            try:
                record.update(variation.vary(constant, options.vary, unchanged))
            except Failed as error:
                record["failed"] = str(error)
            variation.keep(record)
            known[key] = record
            print(line_of(record), flush=True)
    done = [known[key] for key, _ in chosen if key in known]
    nothing = sum("scenes" in record and not any(record["scenes"].values()) for record in done)
    failed = sum("failed" in record for record in done)
    print(f"{len(done)} of {len(chosen)} constants varied: {nothing} change nothing, {failed} could not be varied")


def main():
    options = parse()

    def stop(number, _):
        sys.exit(128 + number)
    signal.signal(signal.SIGTERM, stop)
    options.build.mkdir(parents=True, exist_ok=True)
    (options.build / MARK).touch()
    try:
        work(options, Variation(options))
    except Failed as error:
        sys.exit(f"the unchanged program: {error}")
    except KeyboardInterrupt:
        sys.exit(130)


if __name__ == "__main__":
    main()
