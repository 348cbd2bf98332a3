#!/usr/bin/env python3
"""A button for docs/tutorial.md: a foot of 20 mm diameter and 8 mm height under a spherical cap of 40 mm radius. Binary STL in
millimetres.

    make_button.py button.stl
"""
import math
import struct
import sys

FOOT_RADIUS, HEIGHT, CAP_RADIUS = 10.0, 8.0, 40.0
RINGS, SEGMENTS = 120, 96


def profile():
    """(r, z) from the axis at the bottom to the axis at the top."""
    cap = [(FOOT_RADIUS * k / RINGS) for k in range(RINGS, -1, -1)]
    top = [(r, HEIGHT + math.sqrt(CAP_RADIUS**2 - r**2) - math.sqrt(CAP_RADIUS**2 - FOOT_RADIUS**2)) for r in cap]
    return [(0.0, 0.0), (FOOT_RADIUS, 0.0), *top]


def triangles():
    points = profile()

    def point(i, k):
        angle = 2 * math.pi * (k % SEGMENTS) / SEGMENTS
        return points[i][0] * math.cos(angle), points[i][0] * math.sin(angle), points[i][1]

    for i in range(len(points) - 1):
        for k in range(SEGMENTS):
            if points[i][0] > 0:
                yield point(i, k), point(i, k + 1), point(i + 1, k)
            if points[i + 1][0] > 0:
                yield point(i, k + 1), point(i + 1, k + 1), point(i + 1, k)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    facets = list(triangles())
    with open(sys.argv[1], "wb") as file:
        file.write(b"button".ljust(80) + struct.pack("<I", len(facets)))
        for facet in facets:
            file.write(struct.pack("<12fH", 0, 0, 0, *(x for corner in facet for x in corner), 0))


main()
