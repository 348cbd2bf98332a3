#!/usr/bin/python3
# threads
"""cgcontact study: its table agrees with the runs, failures are rows of it, and stopping it loses nothing."""
import csv
import json
import math
import os
import pathlib
import signal
import subprocess
import time
import unittest
import xml.etree.ElementTree

import harness
from harness import cgcontact, report, scene, settings

SVG = "{http://www.w3.org/2000/svg}"
PLOTS = ["error_time.svg", "error_unknowns.svg", "figures.svg"]
KINDS = ("raw", "spr", "sprc")


def study(name, directory, *options, **values):
    file = name if pathlib.Path(name).suffix else scene(name)
    values = {"solver__preconditioner": "muelu", **values}  # the name of the variant
    return cgcontact("study", file, "--out", directory, *options, *settings(**values))


def table(directory):
    with open(pathlib.Path(directory) / "study.csv", newline="") as file:
        return list(csv.DictReader(file))


def table_json(directory):
    return json.loads((pathlib.Path(directory) / "study.json").read_text())


def texts(picture):
    root = xml.etree.ElementTree.parse(picture).getroot()
    return ["".join(element.itertext()).strip() for element in root.iter(SVG + "text")]


def backend(name, *lines):
    """A program that answers like a build of ours, then does something else for some runs."""
    script = ["#!/bin/sh", "if [ \"$1\" = --version ]; then echo 'cgcontact 0.0.0'; exit 0; fi", *lines,
              f"exec '{harness.PROGRAM}' \"$@\""]
    pathlib.Path(name).write_text("\n".join(script) + "\n")
    pathlib.Path(name).chmod(0o755)
    return f"{name}={name}"


def take_interrupts():
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # a job in the background of a shell may ignore them


class Table(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.outcome = study("two_solids", "kept", "--vary", "n=4,8", "--keep", "--repeat", "2")
        cls.rows = table("kept")

    def test_outcome(self):
        """All solved: exit code 0; the tables on standard output, a line per run on standard error."""
        self.assertEqual(self.outcome.code, 0, self.outcome.err)
        self.assertIn("2 of 2 runs solved", self.outcome.out)
        self.assertIn("two_solids_2d.csv", self.outcome.out, "it says what the reference is")
        for zone in ("whole", "interior", "edge", "outside"):
            self.assertIn(f"pressure error, {zone}\n", self.outcome.out)
        self.assertRegex(self.outcome.err, r"(?m)^run 2 of 2: muelu, n = 8: \d+\.\d\d s$")
        self.assertEqual(sorted(os.listdir("kept")), [*PLOTS, "runs", "study.csv", "study.json"])

    def test_figures(self):
        """Every figure of the table is that of the run's own report.json."""
        self.assertEqual([row["size"] for row in self.rows], ["4.0", "8.0"])
        for row, n in zip(self.rows, (4, 8)):
            run = report(f"kept/runs/muelu_n={n}")
            times = run["times_s"]
            force = run["contact"][0]["force"]["lower"]
            expected = {"unknowns": run["unknowns"], "cells": run["cells"]["active"], "threads": run["threads"],
                        "contact_points": run["contact"][0]["points"], "active_points": run["active_points"],
                        "outer_iterations": run["outer_iterations"], "linear_iterations": sum(run["linear_iterations"]),
                        "time_total_s": sum(times.values()), "peak_memory_bytes": run["peak_memory_bytes"],
                        "estimated_error": run["estimated_error"]["absolute"], "cell_size_m": 0.01 / n,
                        "contact_force_N": math.hypot(*force), "max_pressure_Pa": run["contact"][0]["max_pressure"],
                        "contact_area_m2": run["contact"][0]["area"],
                        "pressure_error_estimate": run["contact"][0]["pressure_error_estimate"],
                        "force_error_estimate": run["contact"][0]["force_error_estimate"],
                        "force_error": abs(math.hypot(*force) / (39179.7 / 2 * 0.01 / (1.3 * n)) - 1)}
            for phase, seconds in times.items():
                expected[f"time_{phase.replace(' ', '_')}_s"] = seconds
            for zone in run["pressure_error"]:
                for kind in KINDS:
                    expected[f"error_{zone['zone']}_{kind}"] = zone[kind]
            for column, value in expected.items():
                if value is None:
                    self.assertEqual(row[column], "", column)
                    continue
                self.assertAlmostEqual(float(row[column]), value, delta=1e-9 * abs(value) + 1e-300, msg=column)
            self.assertEqual((row["status"], row["variant"], row["key"], row["preconditioner"], row["backend"]),
                             ("solved", "muelu", "n", "muelu", run["backend"]))
            verdict = run["verdict"]
            self.assertEqual((row["effectivity"], row["message"]), ("", verdict["text"] if verdict["state"] == "not_resolved" else ""))

    def test_derived(self):
        """Rates and ratios follow from the errors; the coarsest size has no rate."""
        coarse, fine = self.rows
        for zone in ("whole", "interior", "edge"):
            self.assertAlmostEqual(float(fine[f"ratio_{zone}"]),
                                   float(fine[f"error_{zone}_spr"]) / float(fine[f"error_{zone}_sprc"]), delta=1e-9)
            for kind in KINDS:
                errors = [float(row[f"error_{zone}_{kind}"]) for row in self.rows]
                self.assertAlmostEqual(float(fine[f"rate_{zone}_{kind}"]), math.log2(errors[0] / errors[1]), delta=1e-9)
                self.assertEqual(coarse[f"rate_{zone}_{kind}"], "")

    def test_json(self):
        """study.json: the same rows, with the whole report of each run."""
        written = table_json("kept")
        self.assertEqual((written["program"], written["complete"], written["repeat"]), ("cgcontact", True, 2))
        self.assertFalse(written["reference_is_own_finest_run"])
        for row, entry, n in zip(self.rows, written["study"], (4, 8)):
            self.assertEqual(list(row), [key for key in entry if key not in ("command", "fingerprint", "report")])
            for column, text in row.items():
                value = entry[column]
                self.assertEqual("" if value is None else value if isinstance(value, str) else float(value),
                                 text if isinstance(value, (str, type(None))) else float(text), column)
            self.assertEqual(entry["report"], report(f"kept/runs/muelu_n={n}"))

    def test_plots(self):
        """Both plots name their curves, zones and axes with units."""
        for plot, axis in zip(PLOTS, ("time of the run [s]", "unknowns [-]")):
            found = texts(f"kept/{plot}")
            for text in (axis, "error of the contact pressure [%]", "raw stress", "SPR", "result", "result, estimated",
                         "interior"):
                self.assertIn(text, found, plot)
            self.assertTrue(any("Two solids, plane strain" in text for text in found))


class Sizes(unittest.TestCase):
    def test_refine(self):
        """--refine divides all cell sizes; by default half as fine and as it is. Without --keep no run stays."""
        outcome = study("rings", "refined", n=6)
        self.assertEqual(outcome.code, 0, outcome.err)
        rows = table("refined")
        self.assertEqual([row["key"] for row in rows], ["refine", "refine"])
        self.assertAlmostEqual(float(rows[0]["cell_size_m"]), 2 / 6)
        self.assertAlmostEqual(float(rows[1]["cell_size_m"]), 1 / 6)
        self.assertGreater(float(rows[1]["effectivity"]), 0.5)
        self.assertEqual(sorted(os.listdir("refined")), [*PLOTS, "study.csv", "study.json"])

    def test_own_reference(self):
        """Without a reference the finest run is it, and says so; uniform pressure is met exactly by the coarser one."""
        text = scene("patch_test").read_text()
        pathlib.Path("own.toml").write_text(text[:text.index("[reference]")] +
                                            "[reference]\nzones = {half = \"x < 0.5\"}\n")
        outcome = study("own.toml", "own", "--vary", "h=0.3,0.2", "--keep")
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertIn("study's own finest run (muelu, h = 0.2,", outcome.out)
        self.assertIn("errors of h = 0.3 may come out too small", outcome.out)
        self.assertTrue(table_json("own")["reference_is_own_finest_run"])
        coarse, fine = table("own")
        for kind in KINDS:
            self.assertLess(float(coarse[f"error_whole_{kind}"]), 1e-7)
            self.assertLess(float(coarse[f"error_half_{kind}"]), 1e-7)
            self.assertEqual(fine[f"error_whole_{kind}"], "")
        self.assertLess(float(coarse["force_error"]), 1e-7)

    def test_own_reference_of_a_varying_pressure(self):
        """The error against the own finest run is close to that against the exact pressure."""
        text = scene("rings").read_text()
        pathlib.Path("bare.toml").write_text(text.replace("pressure = \"p\"\n", ""))
        outcome = study("bare.toml", "bare", "--vary", "n=5,20")
        self.assertEqual(outcome.code, 0)
        self.assertNotIn("may come out too small", outcome.out)
        self.assertEqual(study("rings", "exact", "--vary", "n=5").code, 0)
        for kind in KINDS:
            column = f"error_whole_{kind}"
            self.assertAlmostEqual(float(table("bare")[0][column]), float(table("exact")[0][column]), delta=0.01)
        self.assertTrue(any("own finest run" in text for text in texts("bare/error_time.svg")))

    def test_own_reference_with_friction(self):
        """A contact.csv with friction has more columns; the transmitted force does not depend on the cells."""
        outcome = study("block_on_incline", "slope", "--refine", "0.5,0.7")
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertTrue(table_json("slope")["reference_is_own_finest_run"])
        coarse, fine = table("slope")
        self.assertLess(float(coarse["force_error"]), 1e-6)
        self.assertTrue(0 <= float(coarse["error_whole_sprc"]) < 1)
        self.assertEqual(fine["error_whole_sprc"], "")

    def test_without_contact(self):
        """A scene without contact has a table and no plots."""
        outcome = study(str(harness.SOURCE / "tests" / "scenes" / "hanging_bar.toml"), "bar")
        self.assertEqual(outcome.code, 0, outcome.err)
        self.assertEqual(sorted(os.listdir("bar")), ["study.csv", "study.json"])


class Failures(unittest.TestCase):
    def test_failed_runs_are_rows(self):
        """A run that crashes or ends with an error is a marked row with its message; the others are there. Exit 2."""
        crash = backend("crash", "case \"$*\" in *n=8*) kill -SEGV $$;; esac")
        words = "echo 'cgcontact: out of \"paper\", really' >&2"
        broken = backend("broken", f"case \"$*\" in *n=4*) {words}; exit 1;; esac")
        outcome = study("two_solids", "failed", "--vary", "n=4,8", "--backend", f"{crash},{broken}")
        self.assertEqual(outcome.code, 2, outcome.err)
        self.assertIn("2 of 4 runs solved, 2 failed", outcome.out)
        rows = {(row["variant"], row["size"]): row for row in table("failed")}
        self.assertEqual([row["status"] for row in rows.values()], ["solved", "failed", "failed", "solved"])
        self.assertIn("signal 11", rows["crash", "8.0"]["message"])
        self.assertEqual(rows["broken", "4.0"]["message"], "out of \"paper\", really")
        self.assertEqual(rows["broken", "4.0"]["unknowns"], "")
        for message in ("signal 11", "out of \"paper\""):
            self.assertIn(message, outcome.out)
            self.assertIn(message, outcome.err)

    def test_results_that_are_none(self):
        """A program that ends well and leaves no report is a failed row, too."""
        outcome = study("two_solids", "empty", "--vary", "n=4", "--backend", backend("idle", "exit 0"))
        self.assertEqual(outcome.code, 2, outcome.err)
        self.assertIn("report.json", table("empty")[0]["message"])

    def test_not_converged(self):
        """A run that does not converge is a marked row with its figures; it has no rate."""
        outcome = study("two_solids", "limited", "--vary", "solver.max_outer_iterations=1,30", n=4)
        self.assertEqual(outcome.code, 2, outcome.err)
        limited, solved = table("limited")
        self.assertEqual((limited["status"], solved["status"]), ("not converged", "solved"))
        self.assertIn("max_outer_iterations = 1", limited["message"])
        self.assertEqual((limited["outer_iterations"], limited["rate_whole_raw"]), ("1", ""))

    def test_threads(self):
        """Variants of threads; more than the program runs on is said in the table."""
        self.assertEqual(study("two_solids", "threads", "--vary", "n=4", "--threads", "1,2").code, 0)
        one, two = table("threads")
        self.assertEqual((one["variant"], two["variant"], one["threads"]), ("1 thread", "2 threads", "1"))
        if two["backend"] == "Serial":
            self.assertIn("runs on 1 thread", two["message"])


class Stopping(unittest.TestCase):
    def test_interrupt_and_resume(self):
        """Ctrl-C: the child ends, finished rows are written, nothing half-written; --resume runs only the rest."""
        slow = backend("slow", "case \"$*\" in *n=8*) [ -e go ] || { echo $$ >started; exec sleep 100; };; esac")
        options = ["--vary", "n=4,8", "--backend", slow]
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(signal=number):
                directory = f"stopped{int(number)}"
                pathlib.Path("started").unlink(missing_ok=True)
                command = [harness.PROGRAM, "study", scene("two_solids"), "--out", directory, *options,
                           *settings(solver__preconditioner="muelu")]
                with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                      start_new_session=True, preexec_fn=take_interrupts) as process:
                    child = self.wait_for_number("started")
                    if number == signal.SIGINT:
                        os.killpg(process.pid, number)  # as a terminal does
                    else:
                        process.send_signal(number)
                    out, err = process.communicate(timeout=20 * harness.PATIENCE)
                self.assertEqual(process.returncode, 128 + number, err)
                self.assertFalse(os.path.exists(f"/proc/{child}"), "the child has ended")
                self.assertIn("1 of 2 runs solved, 1 not run", out)
                self.assertIn("--resume goes on", err)
                rows = table(directory)
                self.assertEqual([(row["size"], row["status"]) for row in rows], [("4.0", "solved")])
                self.assertEqual((table_json(directory)["complete"], table_json(directory)["planned_runs"]), (False, 2))
                self.assertEqual(sorted(os.listdir(directory)), [*PLOTS, "runs", "study.csv", "study.json"])
                self.assertFalse([name for name in os.listdir(f"{directory}/runs") if name.startswith(".")])

                pathlib.Path("go").touch()
                outcome = study("two_solids", directory, *options, "--resume")
                pathlib.Path("go").unlink()
                self.assertEqual(outcome.code, 0, outcome.err)
                self.assertEqual(len(table(directory)), 2)
                self.assertEqual(table(directory)[0]["time_total_s"], rows[0]["time_total_s"], "taken over")
                self.assertNotIn("run 1 of 2", outcome.err)
                self.assertIn("run 2 of 2", outcome.err)

    def test_resume_runs_what_has_changed(self):
        """Another scene, option or program is another run; a kept result that is gone is made again."""
        options = ["--vary", "n=4", "--keep", "--resume"]
        self.assertIn("run 1 of 1", study("two_solids", "again", *options).err)
        self.assertNotIn("run 1", study("two_solids", "again", *options).err)
        self.assertIn("run 1 of 1", study("two_solids", "again", *options, solver__kappa=11).err)
        os.unlink("again/runs/muelu_n=4/report.json")
        self.assertIn("run 1 of 1", study("two_solids", "again", *options, solver__kappa=11).err)
        self.assertIn("run 2 of 2", study("two_solids", "again", "--vary", "n=4,5", *options[2:], solver__kappa=11).err)

    def wait_for_number(self, file):
        for _ in range(600):
            if os.path.exists(file) and pathlib.Path(file).read_text().endswith("\n"):
                return int(pathlib.Path(file).read_text())
            time.sleep(0.1)
        self.fail("waited for a minute")


class Mistakes(unittest.TestCase):
    def refused(self, *arguments, expected, name="two_solids"):
        outcome = study(name, "refused", *arguments)
        self.assertEqual(outcome.code, 1, outcome.err)
        self.assertEqual(len(outcome.err.splitlines()), 1, outcome.err)
        for text in expected:
            self.assertIn(text, outcome.err)
        self.assertFalse(os.path.exists("refused"))

    def test_options(self):
        """Nonsense: one line with option, value and what is allowed; nothing is run or written."""
        pathlib.Path("other").write_text("#!/bin/sh\necho other 1.0\n")
        pathlib.Path("other").chmod(0o755)
        for arguments, expected in (
                (["--vary", "n="], ["--vary: \"\" is an empty list", "n=8,16,32"]),
                (["--vary", "n=8,abc"], ["--vary: \"abc\" is not a number"]),
                (["--vary", "n=8,8.0"], ["--vary: \"8.0\" is there twice"]),
                (["--vary", "m=8"], ["--vary m=8: ", "no such parameter", "n, t"]),
                (["--vary", "n=0"], ["--vary n=0: ", "not finite"]),
                (["--vary", "body.lowr.cell_size=1"], ["--vary body.lowr", "did you mean \"lower\"?"]),
                (["--vary", "n=8", "--refine", "1"], ["--refine excludes --vary"]),
                (["--refine", ""], ["--refine: \"\" is an empty list"]),
                (["--refine", "1,0"], ["--refine: \"0\" is out of range", "> 0"]),
                (["--preconditioner", ""], ["--preconditioner: \"\" is an empty list"]),
                (["--preconditioner", "muelu,muelo"], ["--preconditioner muelo: ", "did you mean \"muelu\"?"]),
                (["--threads", "1,0"], ["--threads: \"0\"", "an integer from 1 to 4096"]),
                (["--repeat", "-1"], ["--repeat: \"-1\"", "an integer from 1 to 1000"]),
                (["--repeat", "x"], ["--repeat: \"x\"", "an integer from 1 to 1000"]),
                (["--backend", "a"], ["--backend: \"a\" has no \"=\"", "NAME=PROGRAM"]),
                (["--backend", "a=nowhere"], ["--backend: \"nowhere\" is not a program that can be run"]),
                (["--backend", "a=other"], ["--backend: ", "other\" is not a program", "a build of cgcontact"]),
                (["--set", "n=abc"], ["--set n=abc", "unknown name \"abc\""])):
            with self.subTest(arguments=arguments):
                self.refused(*arguments, expected=expected)
        self.refused(expected=["there is no such scene file"], name="missing.toml")

    def test_directories(self):
        """A directory of somebody else is not touched; that of an earlier run neither."""
        pathlib.Path("photos").mkdir()
        pathlib.Path("photos", "holiday.jpg").write_text("mine")
        outcome = study("two_solids", "photos", "--vary", "n=4")
        self.assertEqual((outcome.code, len(outcome.err.splitlines())), (1, 1), outcome.err)
        self.assertIn("holds no study.json of an earlier study", outcome.err)
        self.assertEqual(os.listdir("photos"), ["holiday.jpg"])
        self.assertIn("cannot write the study to /proc/x", study("two_solids", "/proc/x", "--vary", "n=4").err)


if __name__ == "__main__":
    harness.main()
