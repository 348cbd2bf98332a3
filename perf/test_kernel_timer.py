#!/usr/bin/env python3
"""The kernel timer sees the steps of a run as regions and its loops as labelled kernels; nothing that a kernel does is
without a label of ours or a library's name.

Usage: test_kernel_timer.py libkernel_timer.so cgcontact SCENE
"""
import os
import re
import subprocess
import sys
import tempfile

library, program, scene = sys.argv[1:4]
with tempfile.TemporaryDirectory() as out:
    run = subprocess.run([program, "run", scene, "--set", "n=8", "--out", out + "/result"], capture_output=True, text=True,
                         env=dict(os.environ, KOKKOS_PROFILE_LIBRARY=library, KOKKOS_TOOLS_LIBS=library))
assert run.returncode == 0, run.stderr
kernels, regions = run.stderr.split("\nregion ", 1)
row = re.compile(r"^(\S.*?) +(\d+) +(\d+\.\d+) +(\d+\.\d)%", re.M)
kernels = {name: (int(calls), float(seconds)) for name, calls, seconds, _ in row.findall(kernels)}
regions = {name: (int(calls), float(seconds)) for name, calls, seconds, _ in row.findall(regions)}

steps = ["scene", "cut cells", "operator", "solve", "recovery", "error estimate", "output"]
assert set(regions) == set(steps), regions
for label in ("cgcontact::cut_cells::integrate", "cgcontact::contact_pairs::closest_distance",
              "cgcontact::patch_lists::list", "cgcontact::fit_kernels::sums", "cgcontact::constrained_fits::rows", "cgcontact::batched_fit::fit",
              "cgcontact::error_estimate::cells", "cgcontact::output::files"):
    assert kernels.get(label, (0, 0))[0] > 0, (label, sorted(kernels))
# Kernels without a label have the name of their C++ type.
ours = [name for name in kernels if "cgcontact" in name]
unlabelled = [name for name in ours if not re.fullmatch(r"cgcontact::[\w:]+", name)]
assert not unlabelled, unlabelled
whole = float(re.search(r"from start to end ([\d.]+) s", run.stderr).group(1))
assert sum(seconds for _, seconds in regions.values()) <= whole
assert sum(seconds for _, seconds in kernels.values()) <= whole
print(f"{len(kernels)} kernels, {len(regions)} regions")
