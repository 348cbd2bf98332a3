#!/usr/bin/env python3
"""Writes rail.stl (mm): a simplified rail, extruded along x. The profile is symmetric in y; its right half goes up from the
foot to the crown without level steps, so that the ends can be divided into strips.

    scenes/data/make_rail.py > scenes/data/rail.stl
"""
import math

import ascii_stl

LENGTH = 48.0


def arc(centre, radius, first, last, steps):
    """Points on an arc, angles in degrees, without its first point."""
    for i in range(1, steps + 1):
        angle = math.radians(first + (last - first) * i / steps)
        yield centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle)


def right_half():
    crown, top = 300.0, 48.0  # mm: radius and height of the crown
    points = [(24.0, 0.0), (24.0, 5.0), (9.0, 9.0)]
    points += arc((11.0, 13.5), 5.0, 255.0, 180.0, 5)  # foot to web
    points += arc((9.0, 29.5), 3.0, 180.0, 105.0, 5)   # web to head
    points += [(15.0, 35.0)]
    points += arc((13.0, 43.0), 2.6, 0.0, 75.0, 5)     # corner of the head
    edge = math.degrees(math.acos(11.0 / crown))
    points += arc((0.0, top - crown), crown, edge, 90.0, 8)
    return points


def quad(a, b, c, d):
    """Two triangles; those whose corners coincide are left out."""
    yield from (t for t in ((a, b, c), (a, c, d)) if len(set(t)) == 3)


def triangles(half):
    (y, z), length = half[0], LENGTH
    yield from quad((0, -y, z), (0, y, z), (length, y, z), (length, -y, z))  # underside
    for (y0, z0), (y1, z1) in zip(half, half[1:]):
        assert z1 > z0, (z0, z1)
        yield from quad((0, y0, z0), (0, y1, z1), (length, y1, z1), (length, y0, z0))  # right flank
        yield from quad((length, -y0, z0), (length, -y1, z1), (0, -y1, z1), (0, -y0, z0))
        yield from quad((length, -y0, z0), (length, y0, z0), (length, y1, z1), (length, -y1, z1))  # strip of the end
        yield from quad((0, -y1, z1), (0, y1, z1), (0, y0, z0), (0, -y0, z0))


def main():
    half = [(y if y > 1e-9 else 0.0, z) for y, z in right_half()]
    ascii_stl.write("rail", triangles(half), 6)


if __name__ == "__main__":
    main()
