"""Which interference gives a shrink fit a pressure of 10 MPa? A secant search by scipy, each step one solve of scenes/rings.toml.

    python3 examples/clearance.py
"""
import pathlib

import scipy.optimize

import cgcontact

SCENE = pathlib.Path(__file__).parents[1] / "scenes" / "rings.toml"
WANTED = 10e6  # Pa


def mean_pressure(interference):
    result = cgcontact.read(SCENE, n=8, delta=interference).solve()
    contact = result.contact
    inner = contact["body"] == 0
    pressure = (contact["weight"] * contact["pressure_sprc"])[inner].sum() / contact["weight"][inner].sum()
    print(f"interference {1e6 * interference:8.4f} um: mean pressure {pressure / 1e6:.4f} MPa")
    return pressure


found = scipy.optimize.root_scalar(lambda d: mean_pressure(d) - WANTED, x0=1e-5, x1=4e-5, xtol=1e-12, rtol=1e-6)
print(f"{WANTED / 1e6:g} MPa at {1e6 * found.root:.4f} um, after {found.function_calls} solves")
