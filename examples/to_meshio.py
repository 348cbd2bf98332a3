"""Hands the surface of a body, with its displacements and von Mises stress, to meshio, which writes what other programs read.

    python3 examples/to_meshio.py [FILE.vtu]
"""
import pathlib
import sys

import meshio
import numpy as np

import cgcontact

SCENE = pathlib.Path(__file__).parents[1] / "scenes" / "two_solids_3d.toml"
FILE = sys.argv[1] if len(sys.argv) > 1 else "upper.vtu"

surface = cgcontact.read(SCENE, n=8).solve().surface("upper")
xx, yy, zz, xy, yz, zx = surface["stress"].T
von_mises = np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * (xy**2 + yz**2 + zx**2))
meshio.write(FILE, meshio.Mesh(surface["points"], {"triangle": surface["triangles"]},
                               point_data={"displacement": surface["displacement"], "von_mises": von_mises}))
print(f"{FILE}: {len(surface['points'])} points, {len(surface['triangles'])} triangles, "
      f"von Mises up to {von_mises.max() / 1e6:.2f} MPa")
