#!/usr/bin/python3
"""Predicts the time of a linear iteration on many ranks from counts and times measured on few.

    perf/rank_runs scenes/two_solids_3d.toml --program build/serial/cgcontact --set n=40 --ranks 1,2,4,8,16 --json runs.json
    perf/scaling_model.py runs.json                 # beside the measurement; strong and weak scaling to 4,096 ranks

An iteration of CG (with a multigrid cycle) on P ranks and N unknowns takes
    compute    (1 - WHOLE) x N / P x load / rate
    whole      WHOLE x N / rate: what every rank does itself between linear solves and in their set-up
    bandwidth  bytes that a rank sends / bandwidth of its link
    latency    messages x latency
    sums       reductions x 2 latency log2 P: of some scalar products each
rate: of one rank, measured; load: of the rank with most cells to compute (a cut one counts CUT_CELL), those at borders that two
ranks compute included, over 1/P of one rank's; WHOLE: from profiles; messages, bytes and reductions: counted on 2 to 16 ranks, extended by N and P:
bytes per rank ~ (N / P)^(2/3). The network is one of a cluster of 2024: InfiniBand NDR 200, 24 GB/s per
node and 64 ranks per node share it; 1.3 us from rank to rank.

Efficiency is told twice: of what is divided, and of all. What every rank has whole (docs/parallel.md) limits a run to the memory of one
rank long before: the last column tells how much that would be.
"""
import argparse
import json
import math
import pathlib

LATENCY = 1.3e-6  # s
LINK = 24e9  # bytes/s of a node
RANKS_PER_NODE = 64
REPLICATED_PER_UNKNOWN = 100  # bytes, docs/parallel.md
WHOLE = 0.15  # of the solve phase on one rank: `perf record` of two_solids_3d, n = 56
CUT_CELL = 10  # interior cells, kernels/ranks/partition.cpp


def work(unknowns, cut_cells):
    return unknowns / 3 + (CUT_CELL - 1) * cut_cells


class Model:
    """From runs on one rank and on several."""

    def __init__(self, runs):
        alone = next(run for run in runs if run["ranks"] == 1)
        self.iterations = sum(alone["linear_iterations"])
        self.unknowns = alone["unknowns"]
        self.rate = self.unknowns * self.iterations / alone["times_s"]["solve"]
        several = [run for run in runs if run["ranks"] > 1]
        self.measured = {run["ranks"]: run["times_s"]["solve"] / self.iterations for run in runs}
        self.messages, self.surface, self.load = {}, [], {}
        for run in several:
            ranks, cycles = run["rank_figures"], sum(run["linear_iterations"])
            self.messages[run["ranks"]] = max(rank["messages"] for rank in ranks) / cycles
            sent = max(rank["sent_bytes"] for rank in ranks) / cycles
            self.surface.append(sent / (self.unknowns / run["ranks"]) ** (2 / 3))
            self.load[run["ranks"]] = max(work(rank["unknowns"], rank["cut_cells"]) for rank in ranks) / (
                work(alone["unknowns"], alone["cells"]["cut"]) / run["ranks"])
        last = several[-1]
        self.reductions = last["rank_figures"][0]["reductions"] / sum(last["linear_iterations"])

    def terms(self, unknowns, ranks):
        """Seconds of an iteration: compute, whole, bandwidth, latency, sums."""
        load = 1 if ranks == 1 else self.load.get(ranks, max(self.load.values()))
        compute, whole = (1 - WHOLE) * unknowns / ranks * load / self.rate, WHOLE * unknowns / self.rate
        if ranks == 1:
            return compute, whole, 0, 0, 0
        per_rank = LINK / min(ranks, RANKS_PER_NODE)
        sent = max(self.surface) * (unknowns / ranks) ** (2 / 3)
        messages = self.messages.get(ranks, max(self.messages.values()))
        sums = self.reductions * 2 * LATENCY * math.log2(ranks)
        return compute, whole, sent / per_rank, messages * LATENCY, sums


def table(title, rows):
    print(title)
    print(f"{'ranks':>8} {'unknowns':>14} {'s/iteration':>12} {'compute':>8} {'whole':>7} {'bandw.':>7} {'latency':>8} {'sums':>7} "
          f"{'efficiency':>11} {'divided':>8} {'GB/rank, whole':>15}")
    for ranks, unknowns, terms, of_all, of_divided in rows:
        total = sum(terms)
        shares = " ".join(f"{term / total:7.1%}" for term in terms)
        print(f"{ranks:8d} {unknowns:14.3g} {total:12.3g} {shares} {of_all:11.2f} {of_divided:8.2f} "
              f"{unknowns * REPLICATED_PER_UNKNOWN / 1e9:15.3g}")
    print()


def efficiencies(one, terms, share):
    """Of all, and of what is divided."""
    return share * sum(one) / sum(terms), share * one[0] / (sum(terms) - terms[1])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", help="of perf/rank_runs --json")
    options = parser.parse_args()
    runs = list(json.loads(pathlib.Path(options.runs).read_text()).values())
    model = Model(runs)
    print(f"{model.unknowns} unknowns, {model.rate / 1e6:.2f} million unknowns per second and iteration on one rank, "
          f"{model.reductions:.0f} reductions per iteration\n")
    print("beside the measurement (one machine: its network is its memory, and ranks beyond its cores wait)")
    for ranks, seconds in sorted(model.measured.items()):
        print(f"{ranks:8d} ranks: model {sum(model.terms(model.unknowns, ranks)) * 1e3:7.1f} ms, measured {seconds * 1e3:7.1f} ms")
    print()
    counts = [1, 2, 4, 16, 64, 256, 1024, 4096]
    for unknowns in (1e9, 1e10, 1e11):
        one = model.terms(unknowns, 1)
        table(f"strong scaling, {unknowns:.0e} unknowns",
              [(p, unknowns, model.terms(unknowns, p), *efficiencies(one, model.terms(unknowns, p), 1 / p)) for p in counts[3:]])
    per_rank = 1e6
    one = model.terms(per_rank, 1)
    table(f"weak scaling, {per_rank:.0e} unknowns per rank",
          [(p, per_rank * p, model.terms(per_rank * p, p), *efficiencies(one, model.terms(per_rank * p, p), 1)) for p in counts])


if __name__ == "__main__":
    main()
