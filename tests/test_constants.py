#!/usr/bin/python3
"""scripts/constants.py tells tuned constants from exact ones; scripts/vary_constants.py varies them, restores the sources and goes on where it stopped.

  tests/test_constants.py SCRIPTS

The program is a script that reads the constants of the copy, and no more than one of them counts.
"""
import json
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

SCRIPTS = pathlib.Path(sys.argv.pop(1))
SOURCE = """namespace cgcontact {
namespace {

/// Least cosine.
constexpr double counts = 0.9;
constexpr int dead = 4, num_corners = 8;  // of a cube
constexpr double scale = 2 * pi;
constexpr double tenth = 1.0 / 10, gauss = 0.5773502691896258;
constexpr double nothing = 1e-12;
constexpr double by_two[] = {0.5, 1.5};
// constexpr double no_constant = 3;

}  // namespace

int f(int dead) { constexpr std::size_t local = std::size_t{1} << 4; return dead; }
}  // namespace cgcontact
"""
PROGRAM = """#!/usr/bin/env python3
import json, pathlib, re, sys, time
source, out = pathlib.Path(SOURCE), pathlib.Path(sys.argv[sys.argv.index("--out") + 1])
value = float(re.search(r"counts = ([^;]*);", (source / "contact" / "a.cpp").read_text())[1])
time.sleep(float(pathlib.Path(sys.argv[2]).read_text()))
out.mkdir()
(out / "report.json").write_text(json.dumps({"warnings": [], "outer_iterations": 5, "linear_iterations": [3, 4], "times_s": {"all": time.time()},
                                             "contact": [{"normal_force": 10 * value, "force": {"a": [0, 0, 1e-20]}}]}))
"""


class Constants(unittest.TestCase):
    def setUp(self):
        self.tree = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.tree)
        for name in ("scripts", "contact", "core/settings"):
            (self.tree / name).mkdir(parents=True)
        for name in ("constants.py", "vary_constants.py"):
            shutil.copy(SCRIPTS / name, self.tree / "scripts")
        (self.tree / "contact" / "a.cpp").write_text(SOURCE)
        (self.tree / "core" / "settings" / "o_options.hpp").write_text("struct O {\n  double aim = 0.5, rate = 1;\n  bool on = true;\n};\n")
        (self.tree / "scene.toml").write_text("0")
        (self.tree / "program").write_text(PROGRAM.replace("SOURCE", repr(str(self.tree / "build" / "source")), 1))
        (self.tree / "program").chmod(0o755)
        for command in (["init", "-q"], ["add", "contact", "core"]):
            subprocess.run(["git", "-C", self.tree, *command], check=True)

    def vary(self, *options):
        return [sys.executable, self.tree / "scripts" / "vary_constants.py", "--build", self.tree / "build", "--command",
                f"cp {self.tree}/program {{build}}/cgcontact", *options, self.tree / "scene.toml"]

    def lines(self, *options, code=0):
        done = subprocess.run(self.vary(*options), capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stdout.splitlines()

    def test_kinds(self):
        kinds = {}
        for kind in ("tuned", "setting", "rounding", "size", "derived", "exact"):
            text = subprocess.run([sys.executable, SCRIPTS / "constants.py", "--kind", kind, self.tree], capture_output=True, text=True, check=True).stdout
            for line in text.splitlines()[:-1]:
                kinds[line.split()[1]] = kind
        self.assertEqual(kinds, {"counts": "tuned", "dead": "tuned", "num_corners": "size", "scale": "derived", "tenth": "tuned", "gauss": "exact",
                                 "nothing": "rounding", "by_two": "tuned", "local": "tuned", "aim": "setting", "rate": "setting"})
        self.assertEqual(text.splitlines()[-1], "5 tuned, 2 setting, 1 rounding, 0 input, 0 drawing, 1 size, 1 derived, 1 exact; 11 in all; "
                                                "3 tuned ones have no comment")

    def test_what_changes(self):
        lines = self.lines()
        self.assertEqual(lines[0], "contact/a.cpp:5: counts = 0.9 -> 0.88: scene: force 2.2 %")
        self.assertEqual(lines[1], "contact/a.cpp:6: dead = 4 -> 5: nothing")
        self.assertIn("by_two = {0.5, 1.5} -> {0.6, 1.8}: nothing", lines[3])
        self.assertEqual(lines[-1], "5 of 5 constants varied: 4 change nothing, 0 could not be varied")
        self.assertEqual((self.tree / "build" / "source" / "contact" / "a.cpp").read_text(), SOURCE)
        self.assertEqual(len((self.tree / "build" / "results.jsonl").read_text().splitlines()), 5)

    def test_goes_on_where_it_stopped(self):
        self.assertEqual(self.lines("--count", "2")[-1], "2 of 5 constants varied: 1 change nothing, 0 could not be varied")
        with open(self.tree / "build" / "results.jsonl", "a", encoding="utf-8") as file:
            file.write('{"key": "half')
        times = [json.loads(line)["key"] for line in (self.tree / "build" / "results.jsonl").read_text().splitlines()[:2]]
        self.assertEqual(times, ["contact/a.cpp:counts", "contact/a.cpp:dead"])
        self.assertEqual(len(self.lines("--summary")), 3)
        self.assertEqual(len(self.lines()), 6)
        self.assertEqual(len((self.tree / "build" / "results.jsonl").read_text().splitlines()), 6)
        (self.tree / "contact" / "a.cpp").write_text(SOURCE.replace("0.9", "0.8"))  # other sources: nothing is taken over
        self.assertEqual(self.lines("--summary")[-1], "0 of 5 constants varied: 0 change nothing, 0 could not be varied")
        self.assertEqual(self.lines("--only", ":counts$")[0], "contact/a.cpp:5: counts = 0.8 -> 0.96: scene: force 20 %")

    def test_interruption_leaves_the_sources_as_they_were(self):
        self.lines("--count", "1")
        text = (self.tree / "build" / "unchanged.json").read_text()
        (self.tree / "program").write_text((self.tree / "program").read_text().replace("out.mkdir()", "time.sleep(30)"))
        with subprocess.Popen(self.vary(), stdout=subprocess.DEVNULL) as running:
            changed, begin = self.tree / "build" / "source" / "contact" / "a.cpp", time.monotonic()
            while changed.read_text() == SOURCE and time.monotonic() < begin + 30:
                time.sleep(0.02)
            self.assertNotEqual(changed.read_text(), SOURCE)
            running.send_signal(signal.SIGTERM)
            self.assertEqual(running.wait(10), 128 + signal.SIGTERM)
        self.assertEqual(changed.read_text(), SOURCE)
        self.assertEqual((self.tree / "build" / "unchanged.json").read_text(), text)

    def test_failures_are_told(self):
        (self.tree / "contact" / "a.cpp").write_text(SOURCE + "// grep\n")
        command = f"grep -q 'dead = 4' {self.tree}/build/source/contact/a.cpp && cp {self.tree}/program {{build}}/cgcontact"
        lines = self.lines("--command", command, "--only", ":dead$")
        self.assertIn("dead = 4: does not build", lines[0])
        self.assertEqual(lines[1], "1 of 1 constants varied: 0 change nothing, 1 could not be varied")
        self.lines("--vary", "1", code=2)
        self.lines("nowhere.toml", code=2)
        self.lines("--build", self.tree, code=2)  # where other files are


if __name__ == "__main__":
    unittest.main()
