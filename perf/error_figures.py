#!/usr/bin/env python3
"""Estimated against true error of the contact pressure, over sizes and random offsets of the grids.

  perf/error_figures.py [--program build/serial/cgcontact] [--seed 11] [--offsets 4] [--sizes 8,16] [--finest N] [SCENE ...]

Default scenes: all with a reference but Hertz, whose sizes are others: scenes/hertz.toml --sizes 8,16,25 --set L=0.5. The first
offset is the scene's own. --finest 64 adds the error that `cgcontact study` finds without a reference, against its own run of that size.
"""
import argparse
import json
import math
import pathlib
import random
import re
import subprocess
import tempfile
import tomllib

SCENES = ("rings", "sphere_in_shell", "two_solids", "two_solids_3d")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", default=[f"scenes/{name}.toml" for name in SCENES])
    parser.add_argument("--program", default="build/serial/cgcontact")
    parser.add_argument("--seed", type=int, default=11)
    parser.add_argument("--offsets", type=int, default=4)
    parser.add_argument("--sizes", default="8,16")
    parser.add_argument("--finest")
    parser.add_argument("--set", action="append", default=[])
    return parser.parse_args()


def offsets(scene, generator):
    """New offsets in all directions but those across bodies one cell thick (plane strain), where they have no effect."""
    bodies = tomllib.loads(pathlib.Path(scene).read_text())["body"]
    flat = {"two_solids": 0, "rings": 2}.get(pathlib.Path(scene).stem)
    settings = []
    for number, body in enumerate(bodies):
        offset = [round(generator.random(), 3) for _ in range(3)]
        if flat is not None:
            offset[flat] = body["grid"]["offset"][flat]
        settings.append(f"body.{number}.grid.offset={offset}")
    return settings


def run(program, scene, settings):
    with tempfile.TemporaryDirectory() as directory:
        options = [word for setting in (*settings, "output.vtk=false", "output.plots=false", "output.csv=false")
                   for word in ("--set", setting)]
        subprocess.run([program, "run", scene, "--out", f"{directory}/out", *options], check=True, capture_output=True)
        return json.loads(pathlib.Path(f"{directory}/out/report.json").read_text())


def study(program, scene, sizes, settings):
    """Relative errors of the sizes against the last one's pressure, without the scene's reference."""
    with tempfile.TemporaryDirectory() as directory:
        copy = pathlib.Path(directory) / "scene.toml"
        tables = re.split(r"(?m)^(?=\[)", pathlib.Path(scene).read_text())
        copy.write_text("".join(table for table in tables if not table.startswith("[reference]")))
        options = [word for setting in settings for word in ("--set", setting)]
        subprocess.run([program, "study", copy, "--vary", f"n={','.join(sizes)}", "--out", f"{directory}/out", *options],
                       check=True, capture_output=True)
        rows = json.loads(pathlib.Path(f"{directory}/out/study.json").read_text())["study"]
        return [row["error_whole_sprc"] for row in rows[:-1]]


def span(ratios):
    mean = math.exp(sum(map(math.log, ratios)) / len(ratios))
    return f"{min(ratios):.2f} to {max(ratios):.2f}, geometric mean {mean:.2f}"


def main():
    options = arguments()
    sizes = options.sizes.split(",")
    for scene in options.scenes:
        generator, ratios, study_ratios = random.Random(options.seed), [], []
        print(f"{scene}\n{'n':>5} {'offset':>6} {'SPR %':>8} {'true %':>8} {'estimate %':>10} {'ratio':>6} {'effectivity':>11}"
              + (f" {'study %':>8} {'ratio':>6}" if options.finest else ""))
        chosen = [[], *(offsets(scene, generator) for _ in range(options.offsets))]
        finest = [study(options.program, scene, [*sizes, options.finest], [*options.set, *offset])
                  if options.finest else [] for offset in chosen]
        for index, n in enumerate(sizes):
            errors = []
            for number, offset in enumerate(chosen):
                report = run(options.program, scene, [f"n={n}", *options.set, *offset])
                spr, true = (report["pressure_error"][0][key] for key in ("spr", "sprc"))
                errors.append(true)
                estimate = report["contact"][0]["pressure_error_estimate"]
                ratios.append(estimate / true)
                effectivity = report.get("effectivity")
                line = (f"{n:>5} {number:>6} {100 * spr:8.3f} {100 * true:8.3f} {100 * estimate:10.3f} {ratios[-1]:6.2f}"
                        f" {effectivity or math.nan:11.3f}")
                if options.finest:
                    study_ratios.append(finest[number][index] / true)
                    line += f" {100 * finest[number][index]:8.3f} {study_ratios[-1]:6.2f}"
                print(line, flush=True)
            print(f"{n:>5}   mean {100 * sum(errors) / len(errors):17.3f}, worst {100 * max(errors):.3f}, "
                  f"ratios: {span(ratios[-len(errors):])}", flush=True)
        print(f"ratio: {span(ratios)}" + (f"; of the study: {span(study_ratios)}" if options.finest else "") + "\n")


if __name__ == "__main__":
    main()
