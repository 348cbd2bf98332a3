#!/usr/bin/env python3
"""Writes teeth.csv, the reference of teeth.toml, from a fine run of that scene: mean SPR-C pressure of both flanks over strips
of constant z (m, Pa), where it is not zero.

    cgcontact run scenes/teeth.toml --set h=6.25e-5 --set "steps.factors=[1]" --out out/teeth-fine
    scenes/data/make_teeth.py out/teeth-fine > scenes/data/teeth.csv
"""
import csv
import sys

STRIP = 6.25e-5  # m


def main():
    sums = {}
    with open(f"{sys.argv[1]}/contact.csv", newline="") as file:
        for row in csv.DictReader(file):
            weight, z, p = float(row["weight"]), float(row["z"]), float(row["pressure_sprc"])
            area = sums.setdefault(int(z // STRIP), [0.0, 0.0, 0.0])
            for k, value in enumerate((1, z, p)):
                area[k] += weight * value
    print("# contact pressure of teeth.toml, made by make_teeth.py: z (m), pressure (Pa)")
    pressed = [k for k, (area, _, p) in sums.items() if p > 1 * area]
    for k in range(min(pressed) - 1, max(pressed) + 2):
        area, z, p = sums[k]
        print(f"{z / area:.9g},{max(p / area, 0):.9g}")


if __name__ == "__main__":
    main()
