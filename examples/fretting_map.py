"""A fretting map: a steel pad with a round end is pressed on a plate in plane strain and moved to and fro.

    python3 examples/fretting_map.py [PICTURE.svg]

Says for several forces and displacements whether the contact sticks, slips at its edges or slides all over, what the
cycle from +u over -u back to +u dissipates, and the largest wear, pressure times slip, from the first push on: times
Archard's coefficient over the hardness it is the depth worn off.
"""
import math
import sys

import cgcontact

R = 50e-3  # m, radius of the end of the pad
b, H = 6e-3, 8e-3  # m, half of its width, its height
t = 10e-3  # m, thickness of both bodies
MU = 0.5
LINE_FORCES = (1e5, 2e5, 4e5)  # N/m
STROKES = (0.25e-6, 1e-6, 2e-6, 4e-6, 8e-6)  # m
MARKS = {"sticks": "o", "partial slip": "^", "gross slip": "x"}
CELLS = 6  # over half the width of the contact
HARDLY = 0.05  # slipping part of the area below which the contact is said to stick: its edge always slips


def scene(line_force, stroke):
    """Makes the scene: pressed in the first step, moved in three more."""
    modulus = 210e9 / (2 * (1 - 0.3**2))
    half_width = (4 * line_force * R / (math.pi * modulus)) ** 0.5  # Hertz
    size = half_width / CELLS
    grid = {"material": "steel", "cell_size": 32 * size,
            "refine": [{"box": {"min": [0, -1.2 * half_width, 0], "max": [t, 1.2 * half_width, 0]},
                        "size": size, "grading": 0.25}]}
    pad = {"name": "pad", "grid": {"offset": [0, 0.37, 0.29]}, **grid, "shape": {"intersection": [
        {"name": "end", "cylinder": {"base": [0, 0, R], "top": [t, 0, R], "radius": R}},
        {"name": "block", "box": {"min": [0, -b, -b], "max": [t, b, H]}}]}}
    plate = {"name": "plate", "grid": {"offset": [0, 0.61, 0.53]}, **grid,
             "shape": {"box": {"min": [0, -2 * b, -2 * b], "max": [t, 2 * b, 0]}}}
    # The pad moves in a guide: its sides are pushed, and free to move up and down.
    guides = [{"face": f"pad.block.{side}", "displacement": {"y": stroke}, "steps": [0, 1, -1, 1]}
              for side in ("y-", "y+")]
    return cgcontact.scene({
        "plane_strain": "x",
        "body": [pad, plate],
        "support": [{"face": "plate.z-", "displacement": {"y": 0, "z": 0}}, *guides],
        "load": [{"face": "pad.block.z+", "pressure": line_force / (2 * b)}],
        "contact": [{"faces": ["pad.end.side", "plate.z+"], "friction": MU}],
        "output": {"plots": False, "vtk": False}})


def regime(slipping):
    """Names what a slipping part of the area means."""
    return "sticks" if slipping < HARDLY else "partial slip" if slipping < 1 else "gross slip"


def draw(found, picture):
    """Draws the map, if matplotlib is there."""
    try:
        from matplotlib import pyplot
    except ImportError:
        print("no picture: matplotlib is missing")
        return
    axes = pyplot.figure().gca()
    for name, mark in MARKS.items():
        points = [(1e6 * stroke, force / 1e3) for force, stroke, state in found if state == name]
        axes.plot(*zip(*points) if points else ([], []), mark, label=name)
    axes.set_xscale("log")
    axes.set_xticks([1e6 * stroke for stroke in STROKES], [f"{1e6 * stroke:g}" for stroke in STROKES])
    axes.minorticks_off()
    axes.set_xlabel("displacement amplitude [um]")
    axes.set_ylabel("normal force [N/mm]")
    axes.legend()
    axes.figure.savefig(picture)


found = []
print("P [N/mm]  u [um]  Q/(mu P)  slipping  regime        work [mJ/m]  wear [Pa m]")
for force in LINE_FORCES:
    for stroke in STROKES:
        result = scene(force, stroke).solve()
        steps = [step["contact"][0]["friction"] for step in result.report["steps"]]
        last, work = steps[-1], steps[-1]["work"] - steps[1]["work"]
        slipping = last["slip_area"] / (last["slip_area"] + last["stick_area"])
        found.append((force, stroke, regime(slipping)))
        print(f"{force / 1e3:8g} {1e6 * stroke:7g} {last['use']:9.3f} {100 * slipping:7.1f} %  {found[-1][2]:12} "
              f"{1e3 * work / t:12.2f} {result.contact['wear'].max():12.1f}")
if len(sys.argv) > 1:
    draw(found, sys.argv[1])
