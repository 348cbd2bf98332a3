#!/usr/bin/python3
"""perf/run_all: a program that fails is named, and the results of the others are kept. Argument: bench_machine."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

RUN_ALL = pathlib.Path(__file__).with_name("run_all")


def run_all(build, *options):
    command = [sys.executable, RUN_ALL, "--toy", "--build", build, "--out", build / "out", *options]
    return subprocess.run(command, capture_output=True, text=True)


with tempfile.TemporaryDirectory() as folder:
    build = pathlib.Path(folder)
    (build / "perf").mkdir()
    os.symlink(os.path.abspath(sys.argv[1]), build / "perf" / "bench_machine")
    broken = build / "perf" / "bench_broken"
    broken.write_text("#!/bin/sh\necho 'what is wrong'\nexit 3\n")
    broken.chmod(0o755)
    (build / "perf" / "benchmarks.txt").write_text("bench_broken\nbench_machine\n")

    both = run_all(build)
    assert both.returncode == 1 and "what is wrong" in both.stderr, both.stderr
    assert both.stderr.endswith("run_all: without results: bench_broken\n"), both.stderr
    rows = json.loads((build / "out" / "perf.json").read_text())["rows"]
    assert {row["program"] for row in rows} == {"bench_machine"}, rows

    none = run_all(build, "--programs", "broken")
    assert none.returncode == 1 and none.stderr.endswith("run_all: no results\n"), none.stderr
