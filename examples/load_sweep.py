"""A ball on a plate under rising forces: largest pressure and contact area, and Hertz's beside them.

    python3 examples/load_sweep.py [SCENE]
"""
import math
import pathlib
import sys

import cgcontact

SCENE = sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[1] / "scenes" / "ball_on_plate.toml"

print("   F [N]  p_max [MPa]   Hertz  error est.   area [mm2]   Hertz")
for force in (5, 50, 500):
    scene = cgcontact.read(SCENE, {"accuracy.pressure": "5 %"}, F=force)
    pair = scene.solve().report["contact"][0]
    radius, modulus = scene.parameters["R"], scene.parameters["E"] / (2 * (1 - scene.parameters["nu"] ** 2))
    a = (0.75 * force * radius / modulus) ** (1 / 3)
    p0 = 1.5 * force / (math.pi * a**2)
    # The scene is a quarter of the ball.
    print(f"{force:8g} {pair['max_pressure'] / 1e6:12.1f} {p0 / 1e6:7.1f} {100 * pair['max_pressure_error_estimate']:9.1f} % "
          f"{4e6 * pair['area']:12.5f} {1e6 * math.pi * a**2:7.5f}")
