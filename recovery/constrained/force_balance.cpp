#include "recovery/constrained/force_balance.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/numbers/decompositions.hpp"
#include "core/base/process/parallel.hpp"
#include "kernels/mesh/mesh.hpp"
#include "recovery/patch/boundary_data.hpp"

namespace cgcontact {
namespace {

/// A node with less than that of a cell's face has forces that scatter more.
constexpr double half_cell = 0.5;
/// A smoothing pass (below) has this variance, cells squared.
constexpr double pass_variance = 1. / 3;
/// Number of passes (cells of an eighth of the other body's) up to which they are made one by one: their cost grows
/// with the fourth power of that ratio. More are taken together, in steps whose forces are as good as those of a
/// Gaussian.
constexpr double max_passes = 192;
constexpr int implicit_steps = 4;
/// Cells within which forces of patches that carry no pressure go to others.
constexpr int steps_aside = 2;
/// Least sum of a pair's forces relative to their magnitudes for it to have a direction.
constexpr double min_resultant = 0.5;
/// Singular values of the normals around a node up to this times the largest one are dropped.
constexpr double normal_tolerance = 0.1;

using Vec6 = Eigen::Matrix<double, 6, 1>;

/// Weights of xx, yy, zz, xy, yz, zx in n . sigma n.
Vec6 normal_weights(const Vec3& n) {
  Vec6 w;
  for (int i = 0; i < 3; ++i) {
    w[i] = n[i] * n[i];
    w[3 + i] = 2 * n[i] * n[(i + 1) % 3];
  }
  return w;
}

/// From xx, yy, zz, sqrt(2) times xy, yz, zx to the traction on n: in the norm of a stress its shear counts twice.
Eigen::Matrix<double, 3, 6> traction_weights(const Vec3& n) {
  Eigen::Matrix<double, 3, 6> w = Eigen::Matrix<double, 3, 6>::Zero();
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    w(i, i) = n[i];
    w(i, 3 + i) = n[j] / std::sqrt(2.0);
    w(j, 3 + i) = n[i] / std::sqrt(2.0);
  }
  return w;
}

/// Returns whether a support acts on a boundary point along the normal: the pressure there is its reaction as well.
bool is_held(const RecoveryBody& body, std::size_t point) {
  constexpr double across = 1e-3;  // cosine
  const TractionCondition& condition = body.boundary->conditions[body.boundary->condition_of_point[point]];
  const CutCells& cc = *body.mesh->cut_cells;
  return condition.holds_normal(cc.grid.to_global(cc.boundary.position[point]),
                                cc.grid.rotation * cc.boundary.normal[point], across);
}

/// Sum of the forces of a pair on a body, Pa m^2, outwards; grid axes. Zero if they mostly cancel (a pin in a hole).
Vec3 resultant_of_pair(const RecoveryBody& body, int pair) {
  Vec3 sum = Vec3::Zero();
  double magnitudes = 0;
  for (const ContactLink& link : body.boundary->links) {
    if (link.pair != pair || !link.active) continue;
    sum += link.weight * link.pressure * link.normal;
    magnitudes += link.weight * std::abs(link.pressure);
  }
  return sum.norm() > min_resultant * magnitudes ? Vec3(sum.normalized()) : Vec3(Vec3::Zero());
}

/// Returns the fraction of the area of a boundary point that counts. Forces act along the normal of the body with the
/// larger cells; on faces that are inclined to each other (the flank of a wedge) the pressure is to have the same
/// component along `resultant`.
double facing(const RecoveryBody& body, std::size_t point, const Vec3& resultant) {
  const BoundaryPoints& points = body.mesh->cut_cells->boundary;
  const int pair = body.boundary->pair_of_point[point];
  Vec3 direction = Vec3::Zero();
  for (const int l : body.boundary->links_of_cell[points.cell[point]]) {
    const ContactLink& link = body.boundary->links[l];
    if (link.pair == pair && link.normal.dot(points.normal[point]) > same_side) direction += link.weight * link.normal;
  }
  const double along = direction.normalized().dot(resultant), own = points.normal[point].dot(resultant);
  return std::min(along, own) > same_side ? own / along : 1.0;
}

/// Face of one pair by cell: products of the shape functions of the cell's nodes. Those of constrained corners count to
/// their masters.
class PairFace {
 public:
  explicit PairFace(const BodyMesh& mesh) : mesh_(mesh), area_unit_(std::pow(mesh.cut_cells->grid.cell_size, 2)) {}

  /// Numbers of nodes and their shape functions at a point.
  struct Shapes {
    std::vector<int> number;
    std::vector<double> N;
    std::size_t size() const { return number.size(); }
  };

  int add_node(int node) {
    const auto [found, is_new] = number_.try_emplace(node, static_cast<int>(nodes.size()));
    if (is_new) nodes.push_back(node);
    return found->second;
  }

  /// Returns the shape functions of a cell at x (grid coordinates); valid until the next call.
  const Shapes& shapes(int cell, const Vec3& x) {
    const Vec3 xi = cell_coordinates(*mesh_.cut_cells, cell, x);
    double N[8];
    hex_shape(xi.data(), N);
    if (cell != latest_cell_) {
      latest_cell_ = cell;
      latest_.number.clear();
      shares_.clear();
      for (int a = 0; a < 8; ++a)
        each_master(mesh_, mesh_.cell_nodes[cell][a] - mesh_.first_node, [&](int node, double weight) {
          const int number = add_node(node);
          const auto slot = std::find(latest_.number.begin(), latest_.number.end(), number);
          shares_.push_back({a, static_cast<int>(slot - latest_.number.begin()), weight});
          if (slot == latest_.number.end()) latest_.number.push_back(number);
        });
    }
    latest_.N.assign(latest_.size(), 0.0);
    for (const Share& share : shares_) latest_.N[share.slot] += share.weight * N[share.corner];
    return latest_;
  }

  /// Points come cell by cell.
  void add_point(int cell, const Vec3& x, double weight, double pressure, double plain) {
    const auto& [number, N] = shapes(cell, x);
    const std::size_t size = number.size();
    if (cells_.empty() || cells_.back().cell != cell)
      cells_.push_back({cell, number, std::vector<double>(size * size)});
    resize();
    weight *= area_unit_;
    double* mass = cells_.back().mass.data();
    for (std::size_t a = 0; a < size; ++a) {
      cell_size[number[a]] = std::max(cell_size[number[a]], mesh_.cut_cells->h(cell));
      area[number[a]] += weight * N[a];
      carried[number[a]] += weight * N[a] * pressure;
      carried_plain[number[a]] += weight * N[a] * plain;
      for (std::size_t b = 0; b < size; ++b) mass[size * a + b] += weight * N[a] * N[b];
    }
  }

  void add_contact(int cell, const Vec3& x, double weight, double pressure) {
    const auto& [number, N] = shapes(cell, x);
    resize();
    for (std::size_t a = 0; a < number.size(); ++a) {
      cell_size[number[a]] = std::max(cell_size[number[a]], mesh_.cut_cells->h(cell));
      covered[number[a]] += N[a] * weight;
      transmitted[number[a]] += N[a] * weight * pressure;
    }
  }

  /// Contact points end where the other body does, boundary points within whole cells: a few of these may stand for a
  /// larger area, and do not carry its force alone.
  double pressure_of(double force, int n) const {
    const double whole = std::max(area[n], covered[n]);
    return whole > 0 ? force / whole : 0.0;
  }

  /// After the points: a contact point that the face has, with the size of the larger cell there, m.
  void add_size(int cell, double larger_cell) {
    for (const int corner : mesh_.cell_nodes[cell])
      each_master(mesh_, corner - mesh_.first_node, [&](int node, double) {
        const auto found = number_.find(node);
        if (found == number_.end()) return;
        double& ratio = larger[found->second];
        ratio = std::max(ratio, larger_cell / mesh_.cut_cells->h(cell));
      });
  }

  /// Nodes beside no contact point take the ratio from those around.
  void spread_sizes() {
    for (bool any = true; any;) {
      any = false;
      std::vector<double> next = larger;
      for (const CellFace& c : cells_)
        for (const int a : c.node)
          for (const int b : c.node)
            if (larger[a] == 0 && larger[b] > next[a]) {
              next[a] = larger[b];
              any = true;
            }
      larger.swap(next);
    }
  }

  /// Spreads forces over the nodes of the cells around, as often as given for each, among the nodes marked: their sum
  /// stays.
  void smooth(const std::vector<char>& marked, const std::vector<double>& passes, std::vector<double>& force) const {
    std::vector<double> sum(nodes.size(), 0.0), next;
    each_product(marked, [&](int, int n, double mass) { sum[n] += mass; });
    const double most = passes.empty() ? 0 : *std::max_element(passes.begin(), passes.end());
    if (most > max_passes) return smooth_implicitly(marked, passes, sum, force);
    for (int pass = 0; pass < most; ++pass) {
      next.assign(nodes.size(), 0.0);
      each_product(marked, [&](int m, int n, double mass) {
        if (pass < passes[n] && sum[n] > 0) next[m] += mass / sum[n] * force[n];
      });
      for (std::size_t n = 0; n < nodes.size(); ++n)
        if (pass >= passes[n]) next[n] += force[n];
      force.swap(next);
    }
  }

  /// Adds the forces of a pressure (nodal values) to those that are carried.
  void carry(const std::vector<double>& pressure) {
    const std::vector<char> all(nodes.size(), 1);
    each_product(all, [&](int m, int n, double mass) { carried[m] += mass * pressure[n]; });
  }

  /// Moves the forces of unmarked nodes to the nodes of the cells around, step by step; what blocked nodes get, or does
  /// not reach a marked one, is lost.
  void redistribute_to_marked_nodes(const std::vector<char>& marked, const std::vector<char>& blocked,
                                    std::vector<double>& force) const {
    const std::vector<char> all(nodes.size(), 1);
    std::vector<double> moving(nodes.size(), 0.0), next;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      if (marked[n]) continue;
      if (!blocked[n]) moving[n] = force[n];
      force[n] = 0;
    }
    std::vector<double> sum(nodes.size(), 0.0), to_marked(nodes.size(), 0.0);
    each_product(all, [&](int m, int n, double mass) {
      sum[n] += mass;
      if (marked[m]) to_marked[n] += mass;
    });
    for (int step = 0; step < steps_aside; ++step) {
      next.assign(nodes.size(), 0.0);
      each_product(all, [&](int m, int n, double mass) {
        if (moving[n] == 0 || (to_marked[n] > 0 && !marked[m])) return;
        const double around = to_marked[n] > 0 ? to_marked[n] : sum[n];
        if (!(around > 0)) return;  // a node whose cells the face only touches
        const double share = mass / around * moving[n];
        if (marked[m])
          force[m] += share;
        else if (!blocked[m])
          next[m] += share;
      });
      moving.swap(next);
    }
  }

  /// As often as smooth() has to spread the force of each node for a mean of that width, the larger cells there.
  std::vector<double> passes_of_mean(double width) const {
    std::vector<double> passes;
    for (const double ratio : larger)
      passes.push_back(std::round(std::pow(width * std::max(1.0, ratio), 2) / pass_variance + 1e-6));
    return passes;
  }

  /// m^2, of a face of the larger cells at a node.
  double area_of_cell(std::size_t n) const { return std::pow(std::max(1.0, larger[n]) * cell_size[n], 2); }

  void resize() {
    for (auto* values : {&area, &covered, &carried, &carried_plain, &transmitted, &cell_size, &larger})
      values->resize(nodes.size(), 0.0);
  }
  bool empty() const { return cells_.empty(); }

  std::vector<int> nodes;                                   ///< of the body
  std::vector<double> area, covered;                        ///< m^2, of the boundary points and of the contact points
  std::vector<double> carried, carried_plain, transmitted;  ///< Scales::stress m^2
  std::vector<double> cell_size;                            ///< m, of the largest cell of the body at the face
  std::vector<double> larger;  ///< cells of the other body over the body's own, at least 1; 0: not known

 private:
  struct CellFace {
    int cell;
    std::vector<int> node;
    std::vector<double> mass;  ///< of each node with each
  };
  /// Share of a corner's shape function that counts to a node of `latest_`.
  struct Share {
    int corner, slot;
    double weight;
  };

  /// Passes are steps of a walk, S = M D^-1 with the mass matrix M and its sums D; n of them have the variance of
  /// (I + (I - S) n / k)^-k. Each step solves (D k/n + D - M) g = force: symmetric, with positive diagonal dominance.
  /// A walk that is as long as the square of the number of cells has been everywhere.
  void smooth_implicitly(const std::vector<char>& marked, const std::vector<double>& passes,
                         const std::vector<double>& sum, std::vector<double>& force) const {
    const double enough = std::max(max_passes, std::pow(static_cast<double>(cells_.size()), 2));
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd own = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(nodes.size()));
    Eigen::VectorXd values = own;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const int i = static_cast<int>(n);
      if (sum[n] > 0) {
        own[i] = sum[n] * implicit_steps / std::min(passes[n], enough);
        values[i] = force[n];
      }
      entries.emplace_back(i, i, sum[n] > 0 ? own[i] : 1.0);
    }
    each_product(marked, [&](int m, int n, double mass) {
      if (m == n) return;
      entries.emplace_back(m, n, -mass);
      entries.emplace_back(n, n, mass);
    });
    Eigen::SparseMatrix<double> matrix(own.size(), own.size());
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(matrix);
    for (int step = 0; step < implicit_steps; ++step) values = own.cwiseProduct(factors.solve(values));
    force.assign(values.data(), values.data() + values.size());
  }

  /// use(m, n, integral of N_m N_n over a cell) for all marked m, n.
  template <class Use>
  void each_product(const std::vector<char>& marked, const Use& use) const {
    for (const CellFace& c : cells_)
      for (std::size_t b = 0; b < c.node.size(); ++b) {
        if (!marked[c.node[b]]) continue;
        for (std::size_t a = 0; a < c.node.size(); ++a)
          if (marked[c.node[a]]) use(c.node[a], c.node[b], c.mass[c.node.size() * a + b]);
      }
  }

  const BodyMesh& mesh_;
  double area_unit_;
  std::map<int, int> number_;
  int latest_cell_ = -1;  ///< points mostly come cell by cell
  Shapes latest_;
  std::vector<Share> shares_;
  std::vector<CellFace> cells_;
};

/// Forces of the nodes as the pressure around, alike for pressing and pulling ones.
std::vector<double> level_of(const PairFace& face, std::vector<double> force, const BalanceOptions& options) {
  face.smooth(std::vector<char>(force.size(), 1), face.passes_of_mean(options.mean_width), force);
  for (std::size_t n = 0; n < force.size(); ++n) force[n] = std::abs(face.pressure_of(force[n], static_cast<int>(n)));
  return force;
}

/// The pressure, at the nodes, that is to be added. level: the pressure around; one_sign: all of it presses.
std::vector<double> missing_pressure(PairFace& face, const std::vector<char>& pressed, const std::vector<char>& term,
                                     const std::vector<double>& level, bool one_sign, const BalanceOptions& options) {
  const std::vector<double> passes = face.passes_of_mean(options.mean_width);
  const std::size_t size = face.nodes.size();
  std::vector<double> added(size, 0.0), step(size, 0.0);
  const auto defect = [&] {
    std::vector<double> force(size);
    for (std::size_t n = 0; n < size; ++n) force[n] = face.transmitted[n] - face.carried[n];
    face.redistribute_to_marked_nodes(pressed, term, force);
    return force;
  };
  const auto add = [&](const std::vector<double>& pressure) {
    for (std::size_t n = 0; n < size; ++n) added[n] += pressure[n];
    face.carry(pressure);
  };
  std::vector<double> force = defect();
  for (std::size_t n = 0; n < size; ++n) {
    const double share = std::max(face.area[n], face.covered[n]) / face.area_of_cell(n);
    if (!pressed[n] || !(share > 0)) continue;
    const double pressure = face.pressure_of(force[n], static_cast<int>(n));
    const double scatter = options.node_scatter * std::max(1.0, std::sqrt(half_cell / share)) * level[n];
    step[n] = std::copysign(std::max(std::abs(pressure) - scatter, 0.0), pressure);
  }
  add(step);
  force = defect();
  face.smooth(pressed, passes, force);
  for (std::size_t n = 0; n < size; ++n) {
    const double pressure = pressed[n] ? face.pressure_of(force[n], static_cast<int>(n)) : 0.0;
    const double exact = options.mean_exact, wrong = options.mean_wrong;
    const double fraction =
        std::clamp((std::abs(pressure) - exact * level[n]) / ((wrong - exact) * level[n]), 0.0, 1.0);
    step[n] = pressure == 0 ? 0.0 : fraction * pressure;
  }
  add(step);
  if (!one_sign) return added;
  // In total no farther than the plain recovery.
  double transmitted = 0, carried = 0, plain = 0, carrying = 0;
  for (std::size_t n = 0; n < size; ++n) {
    transmitted += face.transmitted[n];
    carried += face.carried[n];
    plain += face.carried_plain[n];
    if (pressed[n]) carrying += face.area[n] * level[n];
  }
  const double off = transmitted - carried;
  if (std::abs(off) > std::abs(transmitted - plain) + options.total_exact * std::abs(transmitted) && carrying > 0) {
    const double fraction = std::clamp(off / carrying, -options.mean_wrong, options.mean_wrong);
    for (std::size_t n = 0; n < size; ++n) step[n] = pressed[n] ? fraction * level[n] : 0.0;
    add(step);
  }
  return added;
}

/// The stresses of the smallest norm whose pressure is 1 on all faces around the nodes (-n n on one plane face).
std::vector<Vec6> pressing_stresses(const RecoveryBody& body, PairFace& face, const std::vector<int>& points,
                                    const std::vector<double>& added) {
  const CutCells& cc = *body.mesh->cut_cells;
  std::vector<Eigen::Matrix<double, 6, 6>> products(face.nodes.size(), Eigen::Matrix<double, 6, 6>::Zero());
  std::vector<Vec6> stress(face.nodes.size(), Vec6::Zero());
  for (const int p : points) {
    const auto& [number, N] = face.shapes(cc.boundary.cell[p], cc.boundary.position[p]);
    Vec6 scaled = normal_weights(cc.boundary.normal[p]);
    scaled.tail<3>() /= std::sqrt(2.0);  // the norm of a stress counts its shear components twice
    for (std::size_t a = 0; a < number.size(); ++a) {
      if (added[number[a]] == 0) continue;
      const double weight = std::abs(N[a]) * cc.boundary.weight[p];
      products[number[a]] += weight * scaled * scaled.transpose();
      stress[number[a]] -= weight * scaled;
    }
  }
  parallel_for("cgcontact::force_balance::constant_stress", stress.size(), grain_of_medium, [&](std::size_t n) {
    if (added[n] == 0) return;
    const SymmetricEigen<6> eigen(products[n]);
    const double least = normal_tolerance * normal_tolerance * eigen.eigenvalues()[5];
    Vec6 solution = Vec6::Zero();
    for (int i = 0; i < 6; ++i) {
      if (!(eigen.eigenvalues()[i] > least)) continue;
      const Vec6 e = eigen.eigenvectors().col(i);
      solution += e.dot(stress[n]) / eigen.eigenvalues()[i] * e;
    }
    solution.tail<3>() /= std::sqrt(2.0);
    stress[n] = solution;
  });
  return stress;
}

/// One pair of a body that carries force.
struct PressedPair {
  int number = 0;
  const std::vector<int>& points;  ///< boundary points of the body
};

/// Calls use(face, pair) for all pairs of a body with force and patches with a pressure of their own: that of a load is
/// in balance.
template <class Use>
void each_pressed_face(const std::vector<RecoveryBody>& bodies, std::size_t index, const RecoveredField& field,
                       const std::vector<double>& plain, const Scales& scales, const PatchStates& states,
                       const Use& use) {
  const RecoveryBody& body = bodies[index];
  const CutCells& cc = *body.mesh->cut_cells;
  const std::set<int> of_stress = states.pairs_of_stress();
  std::set<int> pressing;
  for (const ContactLink& link : body.boundary->links)
    if (link.pressure != 0 && !body.boundary->is_bonded(link.pair) && of_stress.count(link.pair) > 0)
      pressing.insert(link.pair);
  if (pressing.empty()) return;
  std::map<int, std::vector<int>> points;  // of the pairs
  for (std::size_t p = 0; p < cc.boundary.size(); ++p) {
    const int pair = body.boundary->pair_of_point[p];
    if (pressing.count(pair) == 0 || is_held(body, p)) continue;
    const int cell = cc.boundary.cell[p], surface = cc.boundary.surface[p];
    const bool on_open_side =
        states.presses(*body.mesh, cell, pair, -1) && !states.presses(*body.mesh, cell, pair, surface);
    if (!on_open_side) points[pair].push_back(static_cast<int>(p));
  }
  const std::vector<double> pressures = contact_pressures(body, field);
  for (const int pair : pressing) {
    PairFace face(*body.mesh);
    const Vec3 resultant = resultant_of_pair(body, pair);
    for (const int p : points[pair]) {
      const int cell = cc.boundary.cell[p];
      const double pressure = states.presses(*body.mesh, cell, pair, -1) ? pressures[p] : 0.0;
      face.add_point(cell, cc.boundary.position[p], cc.boundary.weight[p] * facing(body, p, resultant), pressure,
                     plain.empty() ? 0.0 : plain[p]);
    }
    if (face.empty()) continue;
    for (const ContactLink& link : body.boundary->links)
      if (link.pair == pair && link.spread_pressure != 0)
        face.add_contact(link.cell, link.position, link.weight, link.active ? link.pressure / scales.stress : 0.0);
    for (const ContactLink& link : body.boundary->links)
      if (link.pair == pair) face.add_size(link.cell, link.larger_cell);
    face.spread_sizes();
    use(face, PressedPair{pair, points[pair]});
  }
}

}  // namespace

std::vector<double> contact_pressures(const RecoveryBody& body, const RecoveredField& field) {
  const CutCells& cc = *body.mesh->cut_cells;
  std::vector<double> pressures(cc.boundary.size(), 0.0);
  parallel_for("cgcontact::force_balance::pressures", pressures.size(), grain_of_medium, [&](std::size_t p) {
    if (body.boundary->pair_of_point[p] < 0) return;
    const int cell = cc.boundary.cell[p];
    const Vec3 xi = cell_coordinates(cc, cell, cc.boundary.position[p]);
    double s[6];
    evaluate_recovered(*body.mesh, field, cell, xi.data(), s);
    pressures[p] = -normal_weights(cc.boundary.normal[p]).dot(Eigen::Map<const Vec6>(s));
  });
  return pressures;
}

namespace {

/// Traction at some boundary points of a body, Scales::stress, grid axes.
std::vector<Vec3> tractions_at(const RecoveryBody& body, const RecoveredField& field, const std::vector<int>& points) {
  const CutCells& cc = *body.mesh->cut_cells;
  std::vector<Vec3> tractions(points.size());
  parallel_for("cgcontact::force_balance::tractions", points.size(), grain_of_medium, [&](std::size_t i) {
    const int p = points[i], cell = cc.boundary.cell[p];
    const Vec3 xi = cell_coordinates(cc, cell, cc.boundary.position[p]);
    Vec6 s;
    evaluate_recovered(*body.mesh, field, cell, xi.data(), s.data());
    s.tail<3>() *= std::sqrt(2.0);
    tractions[i] = traction_weights(cc.boundary.normal[p]) * s;
  });
  return tractions;
}

/// Returns for each node the stress of the smallest norm with the traction that is to be added on all faces around it.
std::vector<Vec6> stresses_of_tractions(const RecoveryBody& body, PairFace& face, const std::vector<int>& points,
                                        const std::vector<double> (&added)[3]) {
  const CutCells& cc = *body.mesh->cut_cells;
  std::vector<Eigen::Matrix<double, 6, 6>> products(face.nodes.size(), Eigen::Matrix<double, 6, 6>::Zero());
  std::vector<Vec6> stress(face.nodes.size(), Vec6::Zero());
  for (const int p : points) {
    const auto& [number, N] = face.shapes(cc.boundary.cell[p], cc.boundary.position[p]);
    const Eigen::Matrix<double, 3, 6> weights = traction_weights(cc.boundary.normal[p]);
    for (std::size_t a = 0; a < number.size(); ++a) {
      const int n = number[a];
      const double weight = std::abs(N[a]) * cc.boundary.weight[p];
      products[n] += weight * weights.transpose() * weights;
      stress[n] += weight * weights.transpose() * Vec3(added[0][n], added[1][n], added[2][n]);
    }
  }
  parallel_for("cgcontact::force_balance::stress_of_traction", stress.size(), grain_of_medium, [&](std::size_t n) {
    const SymmetricEigen<6> eigen(products[n]);
    const double least = normal_tolerance * normal_tolerance * eigen.eigenvalues()[5];
    Vec6 solution = Vec6::Zero();
    for (int i = 0; i < 6; ++i)
      if (eigen.eigenvalues()[i] > least)
        solution += eigen.eigenvectors().col(i).dot(stress[n]) / eigen.eigenvalues()[i] * eigen.eigenvectors().col(i);
    solution.tail<3>() /= std::sqrt(2.0);
    stress[n] = solution;
  });
  return stress;
}

/// Balances the traction of a bonded pair, component by component; what scatters is decided by its magnitude.
void balance_bond(const RecoveryBody& body, int pair, const RecoveredField& field, const Scales& scales,
                  const BalanceOptions& options, PatchStates& states) {
  const CutCells& cc = *body.mesh->cut_cells;
  std::vector<int> points;
  for (std::size_t p = 0; p < cc.boundary.size(); ++p)
    if (body.boundary->pair_of_point[p] == pair) points.push_back(static_cast<int>(p));
  const std::vector<Vec3> tractions = tractions_at(body, field, points);
  PairFace face[3] = {PairFace(*body.mesh), PairFace(*body.mesh), PairFace(*body.mesh)};
  for (int k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < points.size(); ++i)
      face[k].add_point(cc.boundary.cell[points[i]], cc.boundary.position[points[i]], cc.boundary.weight[points[i]],
                        tractions[i][k], 0);
    if (face[k].empty()) return;
    for (const ContactLink& link : body.boundary->links)
      if (link.pair == pair)
        face[k].add_contact(link.cell, link.position, link.weight, link.traction[k] / scales.stress);
    for (const ContactLink& link : body.boundary->links)
      if (link.pair == pair) face[k].add_size(link.cell, link.larger_cell);
    face[k].spread_sizes();
  }
  const std::size_t size = face[0].nodes.size();
  std::vector<char> pressed(size), term(size);
  std::vector<double> magnitude(size), added[3];
  for (std::size_t n = 0; n < size; ++n) {
    magnitude[n] = Vec3(face[0].transmitted[n], face[1].transmitted[n], face[2].transmitted[n]).norm();
    term[n] = field.edge && field.edge->of_node(face[0].nodes[n]);
    pressed[n] = !term[n] && face[0].area[n] > 0 && states.is_of_stress(face[0].nodes[n], pair);
  }
  const std::vector<double> level = level_of(face[0], magnitude, options);
  for (int k = 0; k < 3; ++k) added[k] = missing_pressure(face[k], pressed, term, level, false, options);
  const std::vector<Vec6> stress = stresses_of_tractions(body, face[0], points, added);
  for (std::size_t n = 0; n < size; ++n) {
    if (added[0][n] == 0 && added[1][n] == 0 && added[2][n] == 0) continue;
    double* a = &field.values(field.nodes.row(face[0].nodes[n]), 0, 0);
    for (int k = 0; k < 6; ++k) a[num_terms * k] += stress[n][k];
    PatchStatus& status = states.status[face[0].nodes[n]];
    status = std::max(status, PatchStatus::balanced);
  }
}

}  // namespace

void balance_forces(const std::vector<RecoveryBody>& bodies, std::size_t index, const RecoveredField& field,
                    const std::vector<double>& plain, const Scales& scales, const BalanceOptions& options,
                    PatchStates& states) {
  const RecoveryBody& body = bodies[index];
  each_pressed_face(bodies, index, field, plain, scales, states, [&](PairFace& face, const PressedPair& pair) {
    std::vector<char> pressed(face.nodes.size()), term(face.nodes.size());
    for (std::size_t n = 0; n < face.nodes.size(); ++n) {
      term[n] = field.edge && field.edge->of_node(face.nodes[n]);
      pressed[n] = !term[n] && face.area[n] > 0 && states.is_of_stress(face.nodes[n], pair.number);
    }
    const std::vector<double> level = level_of(face, face.transmitted, options);
    const std::vector<double> added = missing_pressure(face, pressed, term, level, true, options);
    const std::vector<Vec6> stress = pressing_stresses(body, face, pair.points, added);
    for (std::size_t n = 0; n < added.size(); ++n) {
      if (added[n] == 0) continue;
      double* a = &field.values(field.nodes.row(face.nodes[n]), 0, 0);
      for (int k = 0; k < 6; ++k) a[num_terms * k] += added[n] * stress[n][k];
      PatchStatus& status = states.status[face.nodes[n]];
      status = std::max(status, PatchStatus::balanced);
    }
  });
  for (int pair = 0; pair < static_cast<int>(body.boundary->bonded.size()); ++pair)
    if (body.boundary->is_bonded(pair)) balance_bond(body, pair, field, scales, options, states);
}

}  // namespace cgcontact
