"""How much accuracy costs: a roller in plane strain to 10, 5, 2 and 1 %, against Hertz.

    python3 examples/hertz_error.py [PICTURE.svg]
"""
import pathlib
import sys

import cgcontact

SCENE = pathlib.Path(__file__).parents[1] / "scenes" / "roller.toml"

print("target  unknowns   seconds  estimate  true error")
for target in ("10 %", "5 %", "2 %", "1 %"):
    result = cgcontact.read(SCENE, {"accuracy.pressure": target}).solve()
    report = result.report
    seconds = sum(solve["seconds"] for solve in report["accuracy"]["solves"])
    print(f"{target:>6} {result.unknowns:9,} {seconds:9.2f} {100 * report['contact'][0]['pressure_error_estimate']:7.2f} % "
          f"{100 * report['pressure_error'][0]['sprc']:9.2f} %")
if len(sys.argv) > 1:
    result.plot_pressure().figure.savefig(sys.argv[1])
