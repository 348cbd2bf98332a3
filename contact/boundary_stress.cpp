#include "contact/boundary_stress.hpp"

#include <algorithm>
#include <set>

namespace cgcontact {
namespace {

IntView to_view(const std::set<int>& values) {
  IntView view("cgcontact::boundary_stress::list", values.size());
  auto host = Kokkos::create_mirror_view(view);
  int i = 0;
  for (int v : values) host(i++) = v;
  Kokkos::deep_copy(view, host);
  return view;
}

}  // namespace

std::vector<std::vector<int>> stabilised_cells(const std::vector<SupportPoint>& supports,
                                               const std::vector<ContactPair>& pairs, std::size_t num_bodies) {
  std::vector<std::vector<int>> cells(num_bodies);
  for (const SupportPoint& p : supports) cells[p.body].push_back(p.cell);
  for (const ContactPair& pair : pairs)
    for (const ContactPoint& q : pair.points) {
      cells[pair.primary].push_back(q.primary_cell);
      cells[pair.secondary].push_back(q.secondary_cell);
    }
  for (std::vector<int>& list : cells) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return cells;
}

BoundaryStress::BoundaryStress(const BodyMesh& mesh, const PatchSet& patches, const std::vector<int>& cells)
    : mesh_(mesh),
      patches_(patches),
      stress_("cgcontact::boundary_stress::stress", cells.empty() ? 0 : mesh.cell_nodes.size()),
      coefficients_("cgcontact::boundary_stress::coefficients", cells.empty() ? 0 : mesh.num_nodes) {
  std::set<int> nodes, patch_cells;
  for (int c : cells)
    for (int node : mesh.cell_nodes[c]) nodes.insert(node - mesh.first_node);
  for (int n : nodes)
    patch_cells.insert(patches.cells.begin() + patches.begin[n], patches.cells.begin() + patches.begin[n + 1]);
  nodes_ = to_view(nodes);
  patch_cells_ = to_view(patch_cells);
}

void BoundaryStress::update(const RealView& u) {
  if (nodes_.extent(0) == 0) return;
  integrate_cell_stress(ExecSpace(), mesh_, patches_, patch_cells_, u, stress_);
  fit_patches(mesh_, patches_, nodes_, stress_, coefficients_);
}

double BoundaryStress::traction(int cell, const Vec3& xi, const Vec3& n, const Vec3& e) const {
  Sym3 s;
  evaluate_recovered(mesh_, coefficients_, cell, xi.data(), s.data());
  const Mat3& R = mesh_.cut_cells->grid.rotation;
  return (R.transpose() * e).dot(tensor(s) * (R.transpose() * n));
}

}  // namespace cgcontact
