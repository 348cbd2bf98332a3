/// The parts of the matrix-free operator, one by one: interior cells, cut cells, ghost faces, contact groups.
/// Each is compared with the product of the same part summed entry by entry. The whole operator, and the fast one
/// against it, are in bench_operator.cpp. Sizes are cells along the block's edge; n of the scene for contact.
///
/// Bytes: every vector entry once (x read, y read and written: 24 per DoF), node numbers and matrices once; the eight
/// colours sweep over the vectors up to eight times when these do not fit into the cache, which the share of the triad
/// then shows.
#include <cmath>
#include <memory>
#include <set>

#include "perf/harness.hpp"
#include "perf/problems.hpp"

namespace {

using namespace cgcontact;
using namespace cgcontact::perf;

constexpr double vector_bytes = 24;

/// A part of the operator on its own: y += part x.
struct Part {
  std::function<void(const RealView&x, const RealView&y)> apply, plain;
};

Kernel part_kernel(int num_dofs, const Part& part, double tolerance) {
  const RealView x = random_vector(num_dofs, 1), y("cgcontact::perf::y", num_dofs), z("cgcontact::perf::z", num_dofs);
  part.apply(x, y);
  Kokkos::fence();
  part.plain(x, z);
  Kernel k;
  k.error = relative_difference(y, z), k.tolerance = tolerance, k.against = "the sum entry by entry";
  k.run = [part, x, y] { part.apply(x, y); };
  return k;
}

/// Cost per cell: 24 x 24 multiply-adds; node numbers (32) and matrix number (4), cut cells their matrix (4608).
Kernel cells(int size, bool interior) {
  auto p = std::make_shared<BlockProblem>(size);
  auto mesh = std::make_shared<BodyMesh>(only_cells(p->system.meshes[0], interior));
  const auto matrices = p->system.matrices[0];
  Part part;
  part.apply = [p, mesh, matrices](const RealView& x, const RealView& y) {
    apply_cells(ExecSpace(), *mesh, matrices, x, y);
  };
  part.plain = [mesh, matrices](const RealView& x, const RealView& y) {
    for (std::size_t e = 0; e < mesh->nodes_of_cell.extent(0); ++e)
      for (int r = 0; r < 24; ++r)
        for (int c = 0; c < 24; ++c)
          y(3 * mesh->nodes_of_cell(e, r / 3) + r % 3) +=
              matrices(mesh->matrix_of_cell(e), r, c) * x(3 * mesh->nodes_of_cell(e, c / 3) + c % 3);
  };
  Kernel k = part_kernel(p->system.num_dofs(), part, 1e-12);
  const double num_cells = static_cast<double>(mesh->nodes_of_cell.extent(0));
  const int nodes = count_nodes(*mesh);
  k.items = 3.0 * nodes;
  k.cost = {1152 * num_cells, 3 * vector_bytes * nodes + num_cells * (36 + (interior ? 0 : 4608))};
  k.figures = {{"cells", num_cells}};
  return k;
}

/// Cost per face: 12 x 12 multiply-adds for three components; 12 node numbers.
Kernel ghost(int size) {
  auto p = std::make_shared<BlockProblem>(size);
  Part part;
  part.apply = [p](const RealView& x, const RealView& y) {
    apply_ghost_faces(ExecSpace(), p->system.meshes[0], p->system.ghosts[0], x, y);
  };
  part.plain = [p](const RealView& x, const RealView& y) {
    const auto nodes = p->system.meshes[0].nodes_of_face;
    for (std::size_t f = 0; f < nodes.extent(0); ++f)
      for (int a = 0; a < 12; ++a)
        for (int b = 0; b < 12; ++b)
          for (int i = 0; i < 3; ++i) y(3 * nodes(f, a) + i) += p->system.ghosts[0][a][b] * x(3 * nodes(f, b) + i);
  };
  Kernel k = part_kernel(p->system.num_dofs(), part, 1e-12);
  const auto nodes = p->system.meshes[0].nodes_of_face;
  std::set<int> touched;
  for (std::size_t f = 0; f < nodes.extent(0); ++f)
    for (int a = 0; a < 12; ++a) touched.insert(nodes(f, a));
  const double faces = static_cast<double>(nodes.extent(0));
  k.items = 3.0 * static_cast<double>(touched.size());
  k.cost = {864 * faces, vector_bytes * k.items + 48 * faces};
  k.figures = {{"faces", faces}};
  return k;
}

/// Cost per entry of the rows: two multiply-adds (gap and force); number and value (12) in both directions.
Kernel groups(int n) {
  auto p =
      std::make_shared<SceneProblem>("scenes/two_solids_3d.toml", std::vector<std::string>{"n=" + std::to_string(n)});
  set_group_stiffness(p->system, std::vector<double>(p->system.group_rows.size(), 10.0));
  Part part;
  part.apply = [p](const RealView& x, const RealView& y) { apply_groups(ExecSpace(), p->system.groups, x, y); };
  part.plain = [p](const RealView& x, const RealView& y) {
    for (const GroupRow& row : p->system.group_rows) {
      double gap = 0;
      for (const auto& [dof, value] : row.entries) gap += value * x(dof);
      for (const auto& [dof, value] : row.entries) y(dof) += 10 * gap * value;
    }
  };
  Kernel k = part_kernel(p->system.num_dofs(), part, 1e-12);
  double entries = 0;
  for (const GroupRow& row : p->system.group_rows) entries += static_cast<double>(row.entries.size());
  k.items = static_cast<double>(p->system.groups.dof_list.extent(0));
  k.cost = {4 * entries, 24 * entries + vector_bytes * k.items};
  k.figures = {{"groups", static_cast<double>(p->system.group_rows.size())}};
  return k;
}

}  // namespace

int main(int argc, char** argv) {
  return run_benchmarks(argc, argv, [] {
    add("operator/interior", [](int size) { return cells(size, true); }, {{6}, {50}});
    add("operator/cut", [](int size) { return cells(size, false); }, {{6}, {50}});
    add("operator/ghost", ghost, {{6}, {50}});
    add("operator/contact", groups, {{8}, {32}});
  });
}
