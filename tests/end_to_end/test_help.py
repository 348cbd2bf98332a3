#!/usr/bin/python3
"""Help, manual page, completion and environment agree with each other and with the program."""
import os
import pathlib
import re
import shutil
import subprocess
import unittest

import harness
from harness import cgcontact, report, scene, settings

COMMANDS = ["init", "check", "run", "study", "compare", "plot"]
VARIABLES = ["CGCONTACT_OUT", "CGCONTACT_THREADS", "CGCONTACT_SET"]


def options(*command):
    """The options that a help lists, long and short."""
    text = cgcontact(*command, "--help").out
    return [name for line in re.findall(r"^  ((?:-\w,)?--[\w-]+)(?: |$)", text, re.M) for name in line.split(",")]


class Help(unittest.TestCase):
    def test_help_of_every_command(self):
        """Every command has a usage, a description of every option, examples of its own and exit codes, in 120 columns."""
        for command in ([], *([name] for name in COMMANDS)):
            text = cgcontact(*command, "--help").out
            for part in ("Usage: cgcontact", "Options:", "Examples:\n  cgcontact", "Exit codes: 0"):
                self.assertIn(part, text, command)
            self.assertLessEqual(max(map(len, text.splitlines())), 120, command)
            for line in re.findall(r"^  (?:-\w,)?--.*$", text, re.M):
                self.assertRegex(line, r"--[\w-]+( \S+)*(   *\w|$| Excludes)", line)
            if command:
                examples = re.findall(r"^  (?:\S+='\S+' )?cgcontact (\w+)", text, re.M)
                self.assertEqual(set(examples), set(command), "examples of this command")

    def test_every_example(self):
        """The scenes that the examples name are there, and the program takes their options (init: in an empty folder)."""
        pathlib.Path("empty").mkdir()
        for command in ([], *([name] for name in COMMANDS)):
            for line in re.findall(r"^  ((?:\S+='\S+' )?cgcontact .*?)(?:    .*)?$", cgcontact(*command, "--help").out, re.M):
                words = line.replace("'", "").split()
                variables = dict([words.pop(0).split("=", 1)]) if "=" in words[0] else {}
                for word in words:
                    if word.startswith("scenes/"):
                        self.assertTrue((harness.SOURCE / word).is_file(), line)
                words = [word for word in words[1:] if not word.startswith(("out/", "--out"))]
                if words[0] in ("study", "compare", "plot") or "part." in line or "scene.toml" in line:
                    continue  # run by test_study.py, test_compare.py, test_plot.py, test_init.py, test_documents.py
                if words[0] != "init":
                    words = ["check", *words[1:]]
                outcome = cgcontact(*[harness.SOURCE / word if word.startswith("scenes/") else word for word in words],
                                    cwd="empty", environment=variables)
                self.assertIn(outcome.code, (0,) if words[0] != "init" else (0, 1), outcome.err)

    def test_help_as_a_command(self):
        """"help COMMAND" is "COMMAND --help"."""
        for command in COMMANDS:
            self.assertEqual(cgcontact("help", command).out, cgcontact(command, "--help").out)
        outcome = cgcontact("help")
        self.assertEqual((outcome.code, outcome.out, outcome.err), (0, cgcontact("--help").out, ""))
        self.assertIn("unknown command", cgcontact("help", "nothing").err)

    def test_manual_page(self):
        """It renders without warnings, and has every command, option, exit code and variable."""
        page = harness.SOURCE / "docs" / "man" / "cgcontact.1"
        self.assertTrue(shutil.which("groff"), "the Debian package groff-base is needed")
        done = subprocess.run(["groff", "-man", "-ww", "-Tutf8", "-P-cbou", str(page)], capture_output=True, text=True, check=True)
        self.assertEqual(done.stderr, "")
        text = done.stdout.replace("\u2010", "-").replace("\u2212", "-")
        for command in COMMANDS:
            self.assertRegex(text, rf"(?m)^ +{command}\b")
            for option in options(command):
                self.assertRegex(text, rf"(?m)^ +.*{re.escape(option)}\b", f"{command} {option}")
        for word in [*options(), *VARIABLES, *re.findall(r"\w+\.vtkhdf|\w+\.csv|report.json", text)]:
            self.assertIn(word, text)
        version = cgcontact("--version").out.strip()
        self.assertIn(version, text, "the version of the page")

    def test_manual_page_has_no_option_too_many(self):
        """Options that the page explains exist."""
        page = (harness.SOURCE / "docs" / "man" / "cgcontact.1").read_text().replace("\\-", "-")
        known = set(options()) | {name for command in COMMANDS for name in options(command)}
        explained = re.findall(r"^\.B[IR]? .*?(--[a-z-]+)", page, re.M)
        self.assertGreater(len(explained), 10)
        self.assertEqual(set(explained) - known, set())


class Environment(unittest.TestCase):
    SMALL = "n=4;output.vtk=false;output.plots=false"

    def test_variables_reach_the_run(self):
        """CGCONTACT_OUT and CGCONTACT_SET as if they were options; options come first; help names them."""
        outcome = cgcontact("run", scene("two_solids"), environment={"CGCONTACT_OUT": "env", "CGCONTACT_SET": self.SMALL})
        self.assertEqual(outcome.code, 0, outcome.err)
        coarse = report("env")["unknowns"]
        outcome = cgcontact("run", scene("two_solids"), "--out", "option", *settings(n=8),
                            environment={"CGCONTACT_OUT": "env2", "CGCONTACT_SET": self.SMALL, "CGCONTACT_THREADS": "1"})
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertGreater(report("option")["unknowns"], coarse)
        self.assertEqual(report("option")["threads"], 1)
        self.assertFalse(os.path.exists("env2"))
        for variable in VARIABLES:
            self.assertIn(variable, cgcontact("run", "--help").out)
            self.assertIn(variable, cgcontact("--help").out)

    def test_study_under_the_variables(self):
        """A study's runs go to its own folders and take the sizes of the study."""
        pathlib.Path("fresh").mkdir()
        outcome = cgcontact("study", scene("two_solids"), "--vary", "n=4,6", cwd="fresh",
                            environment={"CGCONTACT_OUT": "study", "CGCONTACT_SET": self.SMALL})
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertEqual(os.listdir("fresh"), ["study"])
        self.assertIn("study.json", os.listdir("fresh/study"))

    def test_bad_values_name_the_variable(self):
        """Whatever finds the mistake: options, scene, output."""
        for variable, value in (("CGCONTACT_THREADS", "two"), ("CGCONTACT_SET", "n"), ("CGCONTACT_SET", "nn=8"),
                                ("CGCONTACT_SET", "n=4;body.lower.material.nu=0.5"), ("CGCONTACT_OUT", "/proc/x")):
            with self.subTest(variable=variable, value=value):
                outcome = cgcontact("run", scene("two_solids"), environment={variable: value})
                self.assertEqual((outcome.code, len(outcome.err.splitlines())), (1, 1), outcome.err)
                self.assertIn(variable, outcome.err)
                self.assertIn(value.split(";")[-1], outcome.err)


class Completion(unittest.TestCase):
    def complete(self, *words):
        """What bash offers for the last word; "=" is a word of its own, as for readline."""
        script = harness.SOURCE / "scripts" / "completion" / "cgcontact.bash"
        code = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _cgcontact; '
                'for word in "${COMPREPLY[@]}"; do printf "%s\\n" "$word"; done')
        done = subprocess.run(["bash", "-c", code, "bash", str(script), harness.PROGRAM, *words], capture_output=True,
                              text=True, check=True)
        self.assertEqual(done.stderr, "")
        return sorted(done.stdout.splitlines())

    def test_commands_and_options(self):
        """All commands; for each all its options and no others."""
        self.assertEqual(self.complete(""), sorted(["--help", "--version", *COMMANDS]))
        self.assertEqual(self.complete("ch"), ["check"])
        for command in COMMANDS:
            expected = sorted(option for option in options(command) if option.startswith("--"))
            self.assertGreater(len(expected), 1)
            self.assertEqual(self.complete(command, "--"), expected)
        self.assertEqual(self.complete("study", "--re"), ["--refine", "--repeat", "--resume"])

    def test_files(self):
        """Scenes and folders for SCENE, surfaces for --stl, folders for --out; names with blanks stay whole."""
        pathlib.Path("files").mkdir()
        os.chdir("files")
        self.addCleanup(os.chdir, "..")
        for name in ("a.toml", "b c.toml", "part.STL", "x.obj", "notes.txt"):
            pathlib.Path(name).touch()
        pathlib.Path("folder").mkdir()
        self.assertEqual(self.complete("run", ""), ["a.toml", "b c.toml", "folder"])
        self.assertEqual(self.complete("run", "b"), ["b c.toml"])
        self.assertEqual(self.complete("init", "--stl", ""), ["folder", "part.STL", "x.obj"])
        self.assertEqual(self.complete("run", "a.toml", "--out", ""), ["folder"])

    def test_values(self):
        """Units and preconditioners are those that the program takes; keys of --set are parameters and bodies of the scene and
        settings, and check accepts every one of them."""
        self.assertEqual(self.complete("init", "--unit", ""), ["cm", "ft", "in", "m", "mm", "um"])
        self.assertEqual(self.complete("study", "--preconditioner", "m"), ["muelu", "multigrid"])
        self.assertIn("2", [*self.complete("run", "--threads", ""), "2"])
        shutil.copy(scene("patch_test"), "patch.toml")
        keys = self.complete("run", "patch.toml", "--set", "")
        for key in ("solver.tolerance=", "recovery.degree=", "body.lower.cell_size=", "body.upper.material.E=", "p=",
                    "load.0.pressure="):
            self.assertIn(key, keys)
        self.assertEqual(self.complete("check", "patch.toml", "--set", "body.lo"),
                         sorted(f"body.lower.{key}=" for key in ("cell_size", "grid.offset", "material.E", "material.nu")))
        self.assertEqual(self.complete("run", "patch.toml", "--set", "p", "=", "1"), [])
        values = {"title=": "x", "solver.preconditioner=": "muelu", "solver.method=": "minres", "output.directory=": "x", "recovery.degree=": "2",
                  "output.path=": "{from = [0, 0, 0], to = [1, 0, 0]}", "solver.tolerance=": "0.5", "solver.linear_tolerance=": "0.5",
                  "recovery.rank_tolerance=": "0.5"}
        for key in keys:
            value = values.get(key, "[0.1, 0.2, 0.3]" if "offset" in key else
                               "true" if key in ("recovery.spr_c=", "recovery.contact_edge=", "recovery.inverse_variance=",
                                                 "output.vtk=", "output.csv=", "output.plots=") else
                               "0.4" if ".nu" in key else None)
            if value is None:
                value = "1"
            outcome = cgcontact("check", "patch.toml", "--set", key + value)
            self.assertNotIn("unknown key", outcome.err, key)
            self.assertNotIn("there is no", outcome.err, key)

    def test_settings_are_those_of_the_documents(self):
        """The keys of [solver], [recovery] and [output] in docs/scene.md, no more and no fewer."""
        text = (harness.SOURCE / "docs" / "scene.md").read_text()
        documented = []
        for section in ("solver", "recovery", "output"):
            part = text[text.index(f"## `[{section}]`"):]
            table = part[:part.index("\n## ")].split("\n\n")[1]
            documented += [f"{section}.{key}=" for key in re.findall(r"^\| `(\w+)` \|", table, re.M)]
        self.assertGreater(len(documented), 15)
        offered = [key for key in self.complete("run", "--set", "") if key != "title="]
        self.assertEqual(offered, sorted(documented))


if __name__ == "__main__":
    harness.main()
