#include "kernels/solver/rigid_coarse_space.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/numbers/decompositions.hpp"
#include "core/base/process/ranks.hpp"
#include "kernels/mesh/node_sums.hpp"

namespace cgcontact {
namespace {

/// Fraction of E times the body's size: motions that supports resist by less are free. What holds a body has kappa E A
/// / h.
constexpr double hardly_held = 1e-3;
/// Rounding, relative to the largest product of a row with a motion.
constexpr double no_product = 1e-12;

using Motion = Eigen::Matrix<double, 6, 1>;

/// Adds the product of a row's entry with the motions of its body: translation, rotation about the centre times `size`.
void add_entry(const BodyMesh& mesh, const Vec3& centre, double size, int dof, double value, Motion& row) {
  const Vec3 arm = (mesh.node_position(node_of_dof(dof) - mesh.first_node) - centre) / size;
  const Vec3 v = value * Vec3::Unit(component_of_dof(dof));
  row.head<3>() += v;
  row.tail<3>() += arm.cross(v);
}

}  // namespace

RigidCoarseSpace::RigidCoarseSpace(const ExecSpace& exec, const ElasticSystem& system) : exec_(exec), system_(system) {
  for (int m = 0; m < static_cast<int>(system.meshes.size()); ++m) {
    Body body = free_motions(m);
    body_of_mesh_.push_back(body.motions.cols() == 0 ? -1 : static_cast<int>(bodies_.size()));
    if (body.motions.cols() == 0) continue;
    body.first = num_motions_;
    num_motions_ += static_cast<int>(body.motions.cols());
    bodies_.push_back(std::move(body));
  }
  if (empty()) return;
  const std::vector<const BodyMesh*> levels = system.level_meshes();
  for (std::size_t p = 0; p < levels.size(); ++p)
    for (const SupportTerm& term : system.supports[p]) {
      std::vector<std::pair<int, double>> entries;
      displacement_row(levels[p]->cell_nodes[term.cell], term.xi, term.direction,
                       [&](int dof, double value) { entries.emplace_back(dof, value); });
      Row row = make_row(std::move(entries), term.stiffness);
      if (!row.on_motions.empty()) supports_.push_back(std::move(row));
    }
  for (const GroupRow& row : system.group_rows) groups_.push_back(make_row(row.entries, 0));
}

RigidCoarseSpace::Body RigidCoarseSpace::free_motions(int m) const {
  const BodyMesh& mesh = system_.meshes[m];
  Body body;
  body.mesh = m;
  body.centre = centre_of_nodes(mesh);
  double spread = 0;
  for (int n = 0; n < mesh.num_nodes; ++n) spread += (mesh.node_position(n) - body.centre).squaredNorm();
  body.size = std::sqrt(spread / mesh.num_nodes);
  Eigen::Matrix<double, 6, 6> held = Eigen::Matrix<double, 6, 6>::Zero();
  const std::vector<const BodyMesh*> levels = system_.level_meshes();
  for (std::size_t p = 0; p < levels.size(); ++p) {
    if (levels[p]->first_node < mesh.first_node || levels[p]->first_node >= mesh.first_node + mesh.num_nodes) continue;
    for (const SupportTerm& term : system_.supports[p]) {
      Motion row = Motion::Zero();
      displacement_row(levels[p]->cell_nodes[term.cell], term.xi, term.direction,
                       [&](int dof, double value) { add_entry(mesh, body.centre, body.size, dof, value, row); });
      held += term.stiffness * row * row.transpose();
    }
  }
  const double size = body.size * mesh.cut_cells->grid.cell_size / mesh.length;
  std::vector<int> kept;
  for (int k = 0; k < 6; ++k)
    if (mesh.moves(k)) kept.push_back(k);
  const auto count = static_cast<Eigen::Index>(kept.size());
  Eigen::MatrixXd resistance(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j < count; ++j) resistance(i, j) = held(kept[i], kept[j]);
  const SymmetricEigen<Eigen::Dynamic> solver(resistance);
  Eigen::Index free = 0;
  while (free < count && (mesh.rigid || solver.eigenvalues()[free] < hardly_held * mesh.modulus * size)) ++free;
  body.motions.setZero(6, free);
  for (Eigen::Index i = 0; i < count; ++i) body.motions.row(kept[i]) = solver.eigenvectors().row(i).head(free);
  return body;
}

RigidCoarseSpace::Row RigidCoarseSpace::make_row(std::vector<std::pair<int, double>> entries, double stiffness) const {
  Row row;
  row.stiffness = stiffness;
  std::vector<Motion> of_body(bodies_.size(), Motion::Zero());
  double largest = 0;
  std::size_t m = 0;
  for (const auto& [dof, value] : entries) {
    const int node = node_of_dof(dof);
    while (m > 0 && node < system_.meshes[m].first_node) --m;
    while (node >= system_.meshes[m].first_node + system_.meshes[m].num_nodes) ++m;
    largest = std::max(largest, std::abs(value));
    if (body_of_mesh_[m] < 0) continue;
    const Body& body = bodies_[body_of_mesh_[m]];
    add_entry(system_.meshes[m], body.centre, body.size, dof, value, of_body[body_of_mesh_[m]]);
  }
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    for (Eigen::Index k = 0; k < bodies_[b].motions.cols(); ++k) {
      const double product = bodies_[b].motions.col(k).dot(of_body[b]);
      if (std::abs(product) > no_product * largest) row.on_motions.emplace_back(bodies_[b].first + k, product);
    }
  row.entries = std::move(entries);
  return row;
}

void RigidCoarseSpace::set_share(const RankShare& share) {
  share_ = &share;
  for (auto* rows : {&supports_, &groups_})
    for (Row& row : *rows) keep_own_entries(row);
}

void RigidCoarseSpace::keep_own_entries(Row& row) const {
  if (!share_) return;
  std::vector<std::pair<int, double>> own;
  for (const auto& [dof, value] : row.entries)
    if (share_->owns(node_of_dof(dof)))
      own.emplace_back(dof_of(share_->local(node_of_dof(dof)), component_of_dof(dof)), value);
  row.entries = std::move(own);
}

void RigidCoarseSpace::update() {
  const std::vector<double> stiffness = group_stiffness(system_);
  for (std::size_t g = 0; g < system_.changed_rows.size(); ++g)
    if (system_.changed_rows[g]) {
      groups_[g] = make_row(system_.group_rows[g].entries, 0);
      keep_own_entries(groups_[g]);
    }
  for (std::size_t g = 0; g < groups_.size(); ++g) groups_[g].stiffness = stiffness[g];
  Eigen::MatrixXd energy = Eigen::MatrixXd::Zero(num_motions_, num_motions_);
  for (const auto* rows : {&supports_, &groups_})
    for (const Row& row : *rows) {
      if (row.stiffness == 0) continue;
      for (const auto& [i, a] : row.on_motions)
        for (const auto& [j, b] : row.on_motions) energy(i, j) += row.stiffness * a * b;
    }
  energy_.compute(energy);
}

Eigen::VectorXd RigidCoarseSpace::sums(const Forces& r) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(num_motions_);
  for (const Body& body : bodies_) {
    const NodeSums found = sums_of_nodes(exec_, mesh_of(body), body.centre, r);
    Motion all;
    all << found.sum, found.moment / body.size;
    result.segment(body.first, body.motions.cols()) = body.motions.transpose() * all;
  }
  return result;
}

void RigidCoarseSpace::add(const Eigen::VectorXd& amounts, const RealView& x) const {
  for (const Body& body : bodies_) {
    const Motion motion = body.motions * amounts.segment(body.first, body.motions.cols());
    add_rigid_motion(exec_, mesh_of(body), body.centre, motion.head<3>(), motion.tail<3>() / body.size, x);
  }
}

void RigidCoarseSpace::correct(const Forces& r, const RealView& z) const {
  Eigen::VectorXd left = sums(r);
  for (const auto* rows : {&supports_, &groups_})
    for (const Row& row : *rows) {
      if (row.stiffness == 0 || row.on_motions.empty()) continue;
      double sum = 0;
      for (const auto& [dof, value] : row.entries) sum += value * z(dof);
      for (const auto& [i, a] : row.on_motions) left[i] -= row.stiffness * a * sum;
    }
  if (share_) sum_over_ranks(left.data(), static_cast<std::size_t>(left.size()));
  add(energy_.solve(left), z);
}

}  // namespace cgcontact
