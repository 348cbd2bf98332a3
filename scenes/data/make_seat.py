#!/usr/bin/env python3
"""Writes seat.stl (mm): half of a block with a cylindrical groove along y, as a part from a CAD system might come: straight
facets in the groove, finer than the cells. x = 0 is the plane of symmetry, the groove is deepest there, at z = 0.

    scenes/data/make_seat.py > scenes/data/seat.stl
"""
import math

import ascii_stl

RADIUS = 40.0               # of the groove
WIDTH, DEPTH = 14.0, 14.0   # of the half, x and z below the groove
THICKNESS = 0.5             # along y
FACETS = 140


def quad(a, b, c, d):
    yield (a, b, c)
    yield (a, c, d)


def triangles():
    xs = [WIDTH * i / FACETS for i in range(FACETS + 1)]
    top = [(x, RADIUS - math.sqrt(RADIUS**2 - x * x)) for x in xs]
    t, bottom = THICKNESS, -DEPTH
    for (x0, z0), (x1, z1) in zip(top, top[1:]):
        yield from quad((x0, 0, z0), (x1, 0, z1), (x1, t, z1), (x0, t, z0))                          # groove
        yield from quad((x0, 0, bottom), (x0, t, bottom), (x1, t, bottom), (x1, 0, bottom))          # underside
        yield from quad((x0, 0, bottom), (x1, 0, bottom), (x1, 0, z1), (x0, 0, z0))                  # y-
        yield from quad((x0, t, bottom), (x0, t, z0), (x1, t, z1), (x1, t, bottom))                  # y+
    (x0, z0), (x1, z1) = top[0], top[-1]
    yield from quad((x0, 0, bottom), (x0, 0, z0), (x0, t, z0), (x0, t, bottom))                      # x-
    yield from quad((x1, 0, bottom), (x1, t, bottom), (x1, t, z1), (x1, 0, z1))                      # x+


def main():
    ascii_stl.write("seat", triangles(), 9)


if __name__ == "__main__":
    main()
