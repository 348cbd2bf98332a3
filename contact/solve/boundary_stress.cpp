#include "contact/solve/boundary_stress.hpp"

#include <algorithm>

#include "core/base/process/ranks.hpp"

namespace cgcontact {
namespace {

Subset nodes_of_cells(const BodyMesh& mesh, const std::vector<int>& cells) {
  std::vector<char> marked(mesh.num_nodes, 0);
  for (int c : cells) mark_nodes(mesh, c, marked);
  return Subset(marked);
}

}  // namespace

std::vector<std::vector<int>> stabilised_cells(const std::vector<SupportPoint>& supports,
                                               const std::vector<ContactPair>& pairs, std::size_t num_bodies) {
  std::vector<std::vector<int>> cells(num_bodies);
  const auto each_own = [](const auto& points, const auto& use) {
    const auto [begin, end] = share_out(points.size());
    for (std::size_t i = begin; i < end; ++i) use(points[i]);
  };
  each_own(supports, [&](const SupportPoint& p) {
    if (!p.implied) cells[p.body].push_back(p.cell);
  });
  for (const ContactPair& pair : pairs)
    each_own(pair.points, [&](const ContactPoint& q) {
      cells[pair.primary].push_back(q.primary_cell);
      cells[pair.secondary].push_back(q.secondary_cell);
    });
  for (std::vector<int>& list : cells) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return cells;
}

BoundaryStress::BoundaryStress(const BodyMesh& mesh, double min_volume, const std::vector<int>& cells)
    : mesh_(mesh),
      field_{nodes_of_cells(mesh, cells), {}},
      patches_(make_patches(mesh, min_volume, field_.nodes)),
      patch_cells_(cells_of_patches(mesh, patches_, field_.nodes)) {
  stress_ = CellStressView("cgcontact::boundary_stress::stress", patch_cells_.size());
  field_.values = CoefficientView("cgcontact::boundary_stress::coefficients", field_.nodes.size());
}

void BoundaryStress::update(const RealView& u) {
  integrate_cell_stress(mesh_, patches_, patch_cells_, u, stress_);
  fit_patches(mesh_, patches_, stress_, patch_cells_, field_);
}

double BoundaryStress::traction(int cell, const Vec3& xi, const Vec3& n, const Vec3& e) const {
  Sym3 s;
  evaluate_recovered(mesh_, field_, cell, xi.data(), s.data());
  const Mat3& R = mesh_.cut_cells->grid.rotation;
  return (R.transpose() * e).dot(tensor(s) * (R.transpose() * n));
}

}  // namespace cgcontact
