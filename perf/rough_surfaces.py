#!/usr/bin/env python3
"""Surfaces with many small triangles or patches in a cell, as binary STL files in the present folder (docs/decisions.md, "Triangle
surfaces"): a bolt with a thread, a fine ball, a gear, a knurled shaft, two noisy scans. Then, for each of them:

    cgcontact init bolt.toml --stl bolt.stl --unit mm && /usr/bin/time -v cgcontact run bolt.toml
"""

import math
import random
import struct

TURN = 2 * math.pi


def write(name, triangles):
    facets = b"".join(struct.pack("<12fH", 0, 0, 0, *a, *b, *c, 0) for a, b, c in triangles)
    with open(name, "wb") as file:
        file.write(bytes(80) + struct.pack("<I", len(triangles)) + facets)
    print(name, len(triangles), "triangles")


def quads(rows):
    """Between rows of points that are closed in themselves."""
    result = []
    for low, high in zip(rows, rows[1:]):
        for i in range(len(low)):
            j = (i + 1) % len(low)
            result += [(low[i], low[j], high[j]), (low[i], high[j], high[i])]
    return result


def fan(point, row, up):
    return [(point, row[i], row[(i + 1) % len(row)]) if up else (point, row[(i + 1) % len(row)], row[i]) for i in range(len(row))]


def shaft(around, along, length, radius, noise=0):
    chance = random.Random(1)
    rows = []
    for k in range(along + 1):
        z, row = length * k / along, []
        for i in range(around):
            angle = TURN * i / around
            r = radius(angle / TURN, z) + (noise * chance.uniform(-1, 1) if 0 < k < along else 0)
            row.append((r * math.cos(angle), r * math.sin(angle), z))
        rows.append(row)
    return quads(rows) + fan((0, 0, 0), rows[0], False) + fan((0, 0, length), rows[-1], True)


def ball(around, along, radius, noise=0):
    chance = random.Random(1)
    rows = []
    for k in range(1, along):
        polar, row = math.pi * (along - k) / along, []
        for i in range(around):
            angle, r = TURN * i / around, radius + noise * chance.uniform(-1, 1)
            row.append((r * math.sin(polar) * math.cos(angle), r * math.sin(polar) * math.sin(angle), r * math.cos(polar)))
        rows.append(row)
    return quads(rows) + fan((0, 0, -radius), rows[0], False) + fan((0, 0, radius), rows[-1], True)


def thread(turn, z):
    return 1.5 - 0.4 * abs(2 * ((2 * z - turn) % 1) - 1) * max(0, min(1, 2 * z, 20 - 2 * z))


def tooth(turn, z):
    s = 24 * turn % 1
    return 4.2 + 0.8 * (0 if s < 0.25 else 4 * s - 1 if s < 0.5 else 1 if s < 0.75 else 4 - 4 * s)


def knurl(turn, z):
    s, t = (30 * turn + 1.2 * z) % 1, (30 * turn - 1.2 * z) % 1
    return 4 - 0.3 * max(abs(2 * s - 1), abs(2 * t - 1)) * min(1, z, 8 - z)


if __name__ == "__main__":
    write("bolt.stl", shaft(120, 800, 10, thread))
    write("ball.stl", ball(500, 250, 5))
    write("gear.stl", shaft(1200, 60, 4, tooth))
    write("knurl.stl", shaft(600, 200, 8, knurl))
    write("scan.stl", ball(110, 70, 5, 0.15))
    write("rough_shaft.stl", shaft(150, 60, 8, lambda turn, z: 4, 0.12))
