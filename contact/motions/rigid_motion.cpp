#include "contact/motions/rigid_motion.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <map>
#include <numeric>

#include "core/base/numbers/decompositions.hpp"
#include "core/cells/cells_around.hpp"

namespace cgcontact {
namespace {

using Block = Eigen::Matrix<double, 6, 6>;

/// Resistance of supports and closed contact by pairs of connected components (lower triangle: first >= second).
using ComponentResistance = std::map<std::pair<int, int>, Block>;

ComponentResistance resistance_of(const RigidComponents& components, const std::vector<BodyModel>& bodies,
                                  const std::vector<SupportPoint>& supports, const std::vector<ContactPair>& pairs) {
  ComponentResistance sum;
  const auto add = [&](int i, int j, const Block& block) {
    sum.try_emplace({i, j}, Block::Zero()).first->second += block;
  };
  for (const SupportPoint& p : supports) {
    if (p.follows) continue;
    const int k = components.at(p.body, p.cell);
    const RigidComponent& component = components.list[k];
    const RigidMotion q = component.row(global_position(bodies[p.body].cut_cells, p.cell, p.xi), p.direction);
    add(k, k, p.weight / (component.size() * component.size()) * q * q.transpose());
  }
  for (const ContactPair& pair : pairs)
    for (std::size_t q = 0; q < pair.points.size(); ++q) {
      const ContactPoint point = pair.points[q];
      if (!point.active) continue;
      const int k[2] = {components.at(pair.primary, point.primary_cell),
                        components.at(pair.secondary, point.secondary_cell)};
      const double size = components.list[k[0]].size();
      pair.each_direction(q, [&](const Vec3& direction) {
        const RigidMotion row[2] = {components.list[k[0]].row(point.x, -direction),
                                    components.list[k[1]].row(point.x, direction)};
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j)
            if (k[i] >= k[j]) add(k[i], k[j], point.weight / (size * size) * row[i] * row[j].transpose());
      });
    }
  return sum;
}

/// Groups connected components by assembly: those that contact joins.
std::vector<std::vector<int>> find_assemblies(const ComponentResistance& resistance, int num_components) {
  std::vector<int> first(num_components);
  std::iota(first.begin(), first.end(), 0);
  const auto root = [&](int k) {
    while (first[k] != k) k = first[k] = first[first[k]];
    return k;
  };
  for (const auto& [components, block] : resistance) first[root(components.first)] = root(components.second);
  std::map<int, std::vector<int>> assemblies;
  for (int k = 0; k < num_components; ++k) assemblies[root(k)].push_back(k);
  std::vector<std::vector<int>> list;
  for (auto& [any, members] : assemblies) list.push_back(std::move(members));
  return list;
}

/// Columns with rows for the members alone.
Eigen::MatrixXd free_motions_of(const std::vector<int>& members, const ComponentResistance& resistance,
                                double no_stiffness) {
  const auto n = static_cast<Eigen::Index>(6 * members.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);  // lower triangle
  for (std::size_t i = 0; i < members.size(); ++i)
    for (auto entry = resistance.lower_bound({members[i], 0});
         entry != resistance.end() && entry->first.first == members[i]; ++entry) {
      const auto j = std::lower_bound(members.begin(), members.end(), entry->first.second) - members.begin();
      A.block<6, 6>(static_cast<Eigen::Index>(6 * i), 6 * j) = entry->second;
    }
  const double trace = A.trace();  // at least the largest eigenvalue, at most n times
  if (trace > 0) {
    const Eigen::LLT<Eigen::MatrixXd> all_held(A - no_stiffness * trace * Eigen::MatrixXd::Identity(n, n));
    if (all_held.info() == Eigen::Success) return Eigen::MatrixXd(n, 0);
  }
  const SymmetricEigen<Eigen::Dynamic> eigen(A);
  Eigen::Index count = 0;
  while (count < n && eigen.eigenvalues()[count] <= no_stiffness * eigen.eigenvalues()[n - 1]) ++count;
  return eigen.eigenvectors().leftCols(count);
}

/// Adds the `count` connected components of a body, given by their numbers in it.
void add_components(const std::vector<BodyModel>& bodies, int body, std::vector<int> component_of_cell, int count,
                    RigidComponents& components) {
  const CutCells& cells = bodies[body].cut_cells;
  const int first = static_cast<int>(components.list.size());
  components.list.resize(first + count);
  for (std::size_t e = 0; e < cells.cells.size(); ++e) {
    component_of_cell[e] += first;
    RigidComponent& component = components.list[component_of_cell[e]];
    component.body = body;
    extend_box(cells, static_cast<int>(e), component.low, component.high);
  }
  components.of_cell.push_back(std::move(component_of_cell));
}

}  // namespace

std::vector<int> bonded_assemblies(std::size_t num_bodies, const std::vector<ContactPair>& pairs) {
  std::vector<int> assembly(num_bodies);
  std::iota(assembly.begin(), assembly.end(), 0);
  for (const ContactPair& pair : pairs) {
    if (!pair.bonded()) continue;
    const auto [least, other] = std::minmax(assembly[pair.primary], assembly[pair.secondary]);
    const int kept = least, joined = other;
    std::replace(assembly.begin(), assembly.end(), joined, kept);
  }
  return assembly;
}

RigidComponents whole_bodies(const std::vector<BodyModel>& bodies) {
  RigidComponents components;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    components.list.push_back({static_cast<int>(b), bodies[b].low, bodies[b].high});
  return components;
}

RigidComponents components_of(const std::vector<BodyModel>& bodies) {
  RigidComponents components;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    int count = 0;
    std::vector<int> component_of_cell = find_connected_components(bodies[b].cut_cells, count);
    add_components(bodies, static_cast<int>(b), std::move(component_of_cell), count, components);
  }
  return components;
}

Eigen::MatrixXd free_rigid_motions(const RigidComponents& components, const std::vector<BodyModel>& bodies,
                                   const std::vector<SupportPoint>& supports, const std::vector<ContactPair>& pairs,
                                   double no_stiffness) {
  const ComponentResistance resistance = resistance_of(components, bodies, supports, pairs);
  const int num_components = static_cast<int>(components.list.size());
  std::vector<std::pair<std::vector<int>, Eigen::MatrixXd>> found;
  Eigen::Index columns = 0;
  for (std::vector<int>& members : find_assemblies(resistance, num_components)) {
    Eigen::MatrixXd modes = free_motions_of(members, resistance, no_stiffness);
    columns += modes.cols();
    if (modes.cols() > 0) found.emplace_back(std::move(members), std::move(modes));
  }
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(6 * num_components, columns);
  Eigen::Index column = 0;
  for (const auto& [members, modes] : found) {
    for (std::size_t i = 0; i < members.size(); ++i)
      all.block(6 * members[i], column, 6, modes.cols()) = modes.middleRows<6>(static_cast<Eigen::Index>(6 * i));
    column += modes.cols();
  }
  return all;
}

}  // namespace cgcontact
