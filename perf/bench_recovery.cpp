/// Stress recovery: cell integrals, unconstrained fits (SPR), constrained fits (SPR-C) of boundary and contact patches
/// against dense KKT systems, and the whole constrained recovery.
///
/// Sizes: cells along the block's edge for SPR, n of scenes/two_solids_3d.toml for the patches, cells along the lower
/// block for the whole recovery (scenes/patch_test.toml, the upper grid turned).
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>

#include "perf/harness.hpp"
#include "perf/problems.hpp"
#include "recovery/constrained_fit.hpp"
#include "recovery/constraints.hpp"
#include "recovery/recover_stress.hpp"

namespace {

using namespace cgcontact;
using namespace cgcontact::perf;

constexpr int num_unknowns = 6 * num_terms;

struct SprProblem {
  BlockProblem block;
  PatchSet patches;
  CellStressView stress;
  RecoveredField field;
  RealView u;
  explicit SprProblem(int size)
      : block(size),
        patches(make_patches(mesh())),
        stress("cgcontact::perf::stress", mesh().cell_nodes.size()),
        field{Subset(mesh().num_nodes), CoefficientView("cgcontact::perf::coefficients", mesh().num_nodes)},
        u("cgcontact::perf::u", block.system.num_dofs()) {}
  const BodyMesh& mesh() const { return block.system.meshes[0]; }
  Subset cells() const { return Subset(static_cast<int>(mesh().cell_nodes.size())); }
  const MonomialMoments& moments(int cell) const { return patches.moments_of(block.cut_cells, cell); }
};

/// Gradients of the displacement in grid axes -> the displacement itself at the nodes of a mesh.
void set_linear_field(const BodyMesh& mesh, const Mat3& gradient, const RealView& u) {
  for (int n = 0; n < mesh.num_nodes; ++n) {
    const Vec3 value = gradient * Vec3(mesh.nodes[n][0], mesh.nodes[n][1], mesh.nodes[n][2]);
    for (int i = 0; i < 3; ++i) u(3 * (mesh.first_node + n) + i) = value[i];
  }
}

/// Integrals of a constant stress: stress times the cell's moments, in every cell.
double constant_stress_error(const SprProblem& p, const Mat3& gradient) {
  double g[3][3], s[6], largest = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) g[i][j] = gradient(i, j);
  p.mesh().law.stress(g, s);
  for (std::size_t c = 0; c < p.stress.extent(0); ++c)
    for (int k = 0; k < 6; ++k)
      for (int t = 0; t < num_terms; ++t)
        largest = std::max(largest, std::abs(p.stress(c, k, t) - s[k] * p.moments(static_cast<int>(c))[t]));
  return largest;
}

/// Sums and differences of the corners 72 flop; for each of the four integrals 9 gradients of 8, factors 12, stress 15,
/// scaling 6. Bytes: displacements once, node numbers and number of the moments, 17 moments of cut cells, 24 integrals
/// written.
Kernel cell_stress(int size) {
  auto p = std::make_shared<SprProblem>(size);
  Mat3 gradient;
  gradient << 0.7, -0.2, 0.4, 0.3, -0.5, 0.1, -0.6, 0.25, 0.9;
  set_linear_field(p->mesh(), gradient, p->u);
  const auto run = [p] { integrate_cell_stress(p->mesh(), p->patches, p->cells(), p->u, p->stress); };
  run();
  Kokkos::fence();
  const double cells = static_cast<double>(p->stress.extent(0));
  const double cut = static_cast<double>(p->block.cut_cells.moments.size());
  Kernel k;
  k.unit = "cells";
  k.items = cells;
  k.cost = {cells * (72 + 4 * (72 + 12 + 15 + 6)), 24.0 * p->mesh().num_nodes + cells * (36 + 2 * 192) + cut * 136};
  k.error = constant_stress_error(*p, gradient), k.tolerance = 1e-12, k.against = "a constant stress";
  k.run = run;
  return k;
}

/// Plain twin of one fit: normal equations summed cell by cell, solved by Eigen.
Eigen::Matrix<double, num_terms, 6> plain_fit(const SprProblem& p, int n) {
  MassMatrix m = MassMatrix::Zero();
  Eigen::Matrix<double, num_terms, 6> rhs = rhs.Zero();
  for (int i = p.patches.begin[n]; i < p.patches.begin[n + 1]; ++i) {
    const int c = p.patches.cells[i];
    MassMatrix own, shift = MassMatrix::Identity();  // {1, x, y, z} about the cell's centre -> about the node
    const MonomialMoments& m1 = p.moments(c);
    own << m1[0], m1[1], m1[2], m1[3], m1[1], m1[4], m1[7], m1[9], m1[2], m1[7], m1[5], m1[8], m1[3], m1[9], m1[8],
        m1[6];
    for (int d = 0; d < 3; ++d) shift(1 + d, 0) = p.block.cut_cells.cells[c][d] + 0.5 - p.mesh().nodes[n][d];
    m += shift * own * shift.transpose();
    for (int k = 0; k < 6; ++k)
      rhs.col(k) += shift * Eigen::Vector4d(p.stress(c, k, 0), p.stress(c, k, 1), p.stress(c, k, 2), p.stress(c, k, 3));
  }
  return m.ldlt().solve(rhs);
}

double fit_error(const SprProblem& p) {
  double largest = 0;
  for (int n = 0; n < p.mesh().num_nodes; ++n) {
    const auto plain = plain_fit(p, n);
    double difference = 0;
    for (int k = 0; k < 6; ++k)
      for (int t = 0; t < num_terms; ++t)
        difference = std::max(difference, std::abs(plain(t, k) - p.field.values(n, k, t)));
    largest = std::max(largest, difference / plain.cwiseAbs().maxCoeff());
  }
  return largest;
}

/// As if all patches were fitted alike (full ones take a shorter way). Per cell of a patch: offset 3, mass matrix 70,
/// right-hand sides 60 flop; per patch: Cholesky 30, six solves of 32. Bytes: cell data (moments, integrals, centre:
/// 296) once, cell lists, position, 24 coefficients written.
Kernel fit(int size) {
  auto p = std::make_shared<SprProblem>(size);
  const RealView random = random_vector(static_cast<int>(p->stress.size()), 3);
  for (std::size_t i = 0; i < p->stress.size(); ++i) p->stress.data()[i] = random(i);
  const auto run = [p] { fit_patches(p->mesh(), p->patches, p->stress, p->cells(), p->field); };
  run();
  const double patches = p->mesh().num_nodes, entries = static_cast<double>(p->patches.cells.size());
  Kernel k;
  k.unit = "patches";
  k.items = patches;
  k.cost = {entries * 133 + patches * 222,
            296.0 * static_cast<double>(p->stress.extent(0)) + 4 * entries + patches * (4 + 24 + 2 * 192)};
  k.error = fit_error(*p), k.tolerance = 1e-10, k.against = "Eigen's LDLT of every patch";
  k.run = run;
  return k;
}

/// Input of one constrained fit.
struct Patch {
  std::vector<MassMatrix> mass;
  Eigen::MatrixXd C;
  Eigen::VectorXd lambda, a;  ///< a: unconstrained
};

/// Mass matrix of a node's patch.
MassMatrix patch_mass(const BodyMesh& mesh, const PatchSet& patches, int n) {
  const double centre[3] = {double(mesh.nodes[n][0]), double(mesh.nodes[n][1]), double(mesh.nodes[n][2])};
  double m[num_terms][num_terms];
  gather_mass(mesh, patches, &patches.cells[patches.begin[n]], patches.begin[n + 1] - patches.begin[n], centre, m);
  return MassMatrix(&m[0][0]);  // symmetric
}

/// Rows as in recovery/recover_stress.cpp: equilibrium, known tractions on free and loaded faces, zero shear on
/// supports; on contact faces zero shear of both bodies and equal normal tractions.
class PatchBuilder {
 public:
  PatchBuilder(const SceneProblem& problem, int body)
      : p_(problem.simulation),
        body_(body),
        other_(1 - body),
        pieces_(p_.bodies[body].cut_cells, p_.bodies[body].boundary) {}

  /// False if the node's patch is not of the kind asked for.
  bool build(int n, bool contact, Patch& patch) {
    const PatchSet& set = p_.patches[body_];
    const auto groups = pieces_.groups(&set.cells[set.begin[n]], set.begin[n + 1] - set.begin[n]);
    const bool touches = std::any_of(groups.begin(), groups.end(), [](const auto& g) { return g.pair >= 0; });
    if (groups.empty() || touches != contact) return false;
    rows_.clear();
    const Index3& node = p_.system.meshes[body_].nodes[n];
    centre_ = Vec3(node[0], node[1], node[2]);
    patch.mass = {patch_mass(p_.system.meshes[body_], set, n)};
    for (int i = 0; i < 3; ++i) add(divergence_rows().row(i), Row24::Zero());
    if (contact) add_other_body(groups, patch);
    for (const ConstraintGroup& g : groups) add_group(g);
    patch.C.resize(rows_.size(), contact ? 2 * num_unknowns : num_unknowns);
    for (std::size_t r = 0; r < rows_.size(); ++r) patch.C.row(r) = rows_[r].head(patch.C.cols());
    patch.lambda = Eigen::VectorXd::Random(patch.C.rows());
    patch.a = Eigen::VectorXd::Random(patch.C.cols());
    return true;
  }

 private:
  using Row48 = Eigen::Matrix<double, 1, 2 * num_unknowns>;

  void add(const Row24& own, const Row24& other) {
    rows_.emplace_back();
    rows_.back() << own, other;
  }

  /// The patch of the other body's node nearest to the contact face stands in for the auxiliary patch.
  void add_other_body(const std::vector<ConstraintGroup>& groups, Patch& patch) {
    const auto on_face = std::find_if(groups.begin(), groups.end(), [](const auto& g) { return g.pair >= 0; });
    const Vec3 x = to_other(on_face->position[0]);
    const BodyMesh& mesh = p_.system.meshes[other_];
    int nearest = 0;
    double distance = 1e300;
    for (int n = 0; n < mesh.num_nodes; ++n) {
      const Vec3 position(mesh.nodes[n][0], mesh.nodes[n][1], mesh.nodes[n][2]);
      if ((position - x).squaredNorm() >= distance) continue;
      distance = (position - x).squaredNorm();
      nearest = n;
      other_centre_ = position;
    }
    patch.mass.push_back(patch_mass(mesh, p_.patches[other_], nearest));
    for (int i = 0; i < 3; ++i) add(Row24::Zero(), divergence_rows().row(i));
  }

  Vec3 to_other(const Vec3& x) const {
    return p_.bodies[other_].cut_cells.grid.to_grid(p_.bodies[body_].cut_cells.grid.to_global(x));
  }

  void add_group(const ConstraintGroup& g) {
    const bool support = g.pair < 0 && p_.bodies[body_].boundary.conditions[g.condition].is_support();
    const Mat3 turn = p_.bodies[other_].cut_cells.grid.rotation.transpose() * p_.bodies[body_].cut_cells.grid.rotation;
    for (int i = 0; i < g.num_points; ++i) {
      const Vec3 d = g.position[i] - centre_, n = g.normal[i];
      const auto [t1, t2] = tangents(n);
      add(traction_row(d, n, t1), Row24::Zero());
      add(traction_row(d, n, t2), Row24::Zero());
      if (g.pair < 0) {
        if (!support) add(traction_row(d, n, n), Row24::Zero());
        continue;
      }
      const Vec3 e = to_other(g.position[i]) - other_centre_, m = turn * n;
      add(Row24::Zero(), traction_row(e, m, turn * t1));
      add(Row24::Zero(), traction_row(e, m, turn * t2));
      add(traction_row(d, n, n), -traction_row(e, m, m));
    }
  }

  const Simulation& p_;
  int body_, other_;
  BoundaryPieces pieces_;
  Vec3 centre_, other_centre_;
  std::vector<Row48> rows_;
};

/// The straightforward solution for independent rows: dense KKT matrix, LU with partial pivoting.
void kkt_lu(const Patch& p, Eigen::VectorXd& a) {
  const Eigen::Index n = p.C.cols(), rows = p.C.rows();
  Eigen::MatrixXd kkt = Eigen::MatrixXd::Zero(n + rows, n + rows);
  for (Eigen::Index b = 0; b < n / num_terms; ++b)
    kkt.block<num_terms, num_terms>(b * num_terms, b * num_terms) = p.mass[b / 6];
  kkt.topRightCorner(n, rows) = p.C.transpose();
  kkt.bottomLeftCorner(rows, n) = p.C;
  Eigen::VectorXd rhs(n + rows);
  rhs.head(n) = kkt.topLeftCorner(n, n) * a;
  rhs.tail(rows) = p.lambda;
  a = kkt.partialPivLu().solve(rhs).head(n);
}

/// Patches of one kind whose rows are independent: all ways to solve them give the same answer.
std::vector<Patch> collect_patches(int n, bool contact) {
  const SceneProblem problem("scenes/two_solids_3d.toml", {"n=" + std::to_string(n)});
  std::vector<Patch> patches;
  const std::size_t enough = is_toy() ? 20 : 2000;
  for (int body : {0, 1}) {
    PatchBuilder builder(problem, body);
    for (int node = 0; node < problem.system.meshes[body].num_nodes && patches.size() < enough; ++node) {
      Patch patch;
      if (!builder.build(node, contact, patch)) continue;
      Eigen::VectorXd a = patch.a;
      if (constrain_fit(patch.mass, patch.C, patch.lambda, RecoveryOptions{}.rank_tolerance, a).truncated == 0)
        patches.push_back(std::move(patch));
    }
  }
  if (patches.empty()) throw std::logic_error("no such patch");
  return patches;
}

enum class Method { fit, lu, orthogonal };

void solve(const Patch& p, Method method, Eigen::VectorXd& a) {
  a = p.a;
  if (method == Method::fit)
    constrain_fit(p.mass, p.C, p.lambda, RecoveryOptions{}.rank_tolerance, a);
  else if (method == Method::lu)
    kkt_lu(p, a);
  else
    constrain_fit_kkt(p.mass, p.C, p.lambda, a);
}

/// r rows, c columns. Ours: whitening and normalising 7 r c, rows' products 2 r^2 c, eigenvalues and vectors 9 r^3,
/// correction 4 r c + 4 r^2. KKT by LU: 2/3 (r + c)^3 + 2 (r + c)^2; by orthogonal decomposition twice the first term.
/// Bytes: rows, right-hand sides, masses read once, coefficients read and written.
Cost patch_cost(Eigen::Index rows, Eigen::Index columns, Method method) {
  const double r = static_cast<double>(rows), c = static_cast<double>(columns), n = r + c;
  const double bytes = 8 * (r * c + r + 2 * c) + 128.0 * c / num_unknowns;
  if (method == Method::fit) return {11 * r * c + 2 * r * r * c + 9 * r * r * r + 4 * r * r, bytes};
  return {(method == Method::lu ? 1 : 2) * 2 * n * n * n / 3 + 2 * n * n, bytes};
}

Kernel constrained(int n, bool contact, Method method) {
  auto patches = std::make_shared<std::vector<Patch>>(collect_patches(n, contact));
  Kernel k;
  double rows = 0;
  for (const Patch& p : *patches) {
    Eigen::VectorXd a, plain;
    solve(p, method, a);
    solve(p, method == Method::orthogonal ? Method::lu : Method::orthogonal, plain);
    k.error = std::max(k.error, (a - plain).norm() / plain.norm());
    const Cost cost = patch_cost(p.C.rows(), p.C.cols(), method);
    k.cost.flop += cost.flop, k.cost.bytes += cost.bytes;
    rows += static_cast<double>(p.C.rows());
  }
  k.tolerance = 1e-9, k.against = "the KKT system by another decomposition";
  k.unit = "patches";
  k.items = static_cast<double>(patches->size());
  const auto solve_all = [patches](Method with) {
    return [patches, with] {
      Eigen::VectorXd a;
      for (const Patch& p : *patches) solve(p, with, a);
      benchmark::DoNotOptimize(a.data());
    };
  };
  k.run = solve_all(method);
  if (method == Method::fit) k.baseline = solve_all(Method::lu);
  k.figures = {{"rows", rows / k.items}};
  return k;
}

/// The whole recovery of the contact patch test, whose exact stress (uniform pressure) every patch must meet.
struct RecoveryProblem {
  SceneProblem problem;
  std::vector<RecoveryBody> bodies;
  std::vector<Sym3> exact;  ///< per body, grid axes, Scales::stress
  std::vector<CoefficientView> unconstrained;
  RealView u;

  explicit RecoveryProblem(int cells) : problem("scenes/patch_test.toml", {"h=1/" + std::to_string(cells)}) {
    const double p = 1e8;
    const Simulation& sim = problem.simulation;
    u = RealView("cgcontact::perf::u", problem.system.num_dofs());
    for (std::size_t b = 0; b < sim.bodies.size(); ++b) {
      const BodyModel& body = sim.bodies[b];
      const BodyMesh& mesh = problem.system.meshes[b];
      const Mat3& R = body.cut_cells.grid.rotation;
      const double E = body.spec->material.youngs_modulus, nu = body.spec->material.poisson_ratio;
      const Mat3 strain = Vec3(nu * p / E, nu * p / E, -p / E).asDiagonal();
      set_linear_field(mesh, mesh.cell_size * (R.transpose() * strain * R), u);
      const Mat3 s = R.transpose() * Vec3(0, 0, -p / sim.scales.stress).asDiagonal() * R;
      exact.emplace_back();
      exact.back() << s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0);
      unconstrained.emplace_back("cgcontact::perf::spr", mesh.num_nodes);
      const Subset all(mesh.num_nodes);
      recover_all(mesh, sim.patches[b], u, {all, unconstrained.back()});
      bodies.push_back(
          {&mesh, &sim.patches[b], &body.boundary, {all, CoefficientView("cgcontact::perf::spr_c", mesh.num_nodes)}});
    }
  }
  RecoveryCounts run() {
    for (std::size_t b = 0; b < bodies.size(); ++b) Kokkos::deep_copy(bodies[b].field.values, unconstrained[b]);
    return recover_constrained(bodies, u, problem.simulation.scales, {});
  }
  double error() const {
    double largest = 0;
    for (std::size_t b = 0; b < bodies.size(); ++b)
      for (int n = 0; n < bodies[b].mesh->num_nodes; ++n)
        for (int k = 0; k < 6; ++k)
          for (int t = 0; t < num_terms; ++t)
            largest = std::max(largest, std::abs(bodies[b].field.values(n, k, t) - (t == 0 ? exact[b][k] : 0.0)));
    return largest / exact[0].cwiseAbs().maxCoeff();
  }
};

/// The copy of the unconstrained fit is part of the run. As if every patch were one constrained fit with the rows
/// PatchBuilder would give it, after an unconstrained one (133 flop per cell, 222 per patch; 296 bytes per cell).
/// Finding the groups of boundary points is not counted.
Cost whole_cost(const SceneProblem& problem) {
  Cost sum;
  for (std::size_t b = 0; b < problem.system.meshes.size(); ++b) {
    const PatchSet& set = problem.simulation.patches[b];
    const BodyModel& model = problem.simulation.bodies[b];
    const BoundaryPieces pieces(model.cut_cells, model.boundary);
    for (int n = 0; n < problem.system.meshes[b].num_nodes; ++n) {
      const int cells = set.begin[n + 1] - set.begin[n];
      Eigen::Index rows = 3, columns = num_unknowns;
      for (const ConstraintGroup& g : pieces.groups(&set.cells[set.begin[n]], cells)) {
        const bool support = g.pair < 0 && model.boundary.conditions[g.condition].is_support();
        rows += g.num_points * (g.pair >= 0 ? 5 : support ? 2 : 3);
        if (g.pair >= 0 && columns == num_unknowns) {
          columns = 2 * num_unknowns;
          rows += 3;
        }
      }
      const Cost fit = patch_cost(rows, columns, Method::fit);
      sum.flop += fit.flop + 133 * cells + 222;
      sum.bytes += fit.bytes + 296 * cells;
    }
  }
  return sum;
}

Kernel whole(int cells) {
  auto p = std::make_shared<RecoveryProblem>(cells);
  const RecoveryCounts counts = p->run();
  Kernel k;
  k.unit = "patches";
  k.items = p->problem.system.num_nodes;
  k.cost = whole_cost(p->problem);
  k.error = p->error(), k.tolerance = 1e-8, k.against = "the exact uniform stress";
  k.run = [p] { p->run(); };
  for (const auto& [kind, count] : counts.patches_by_kind) k.figures.emplace_back(kind, static_cast<double>(count));
  return k;
}

}  // namespace

int main(int argc, char** argv) {
  return run_benchmarks(argc, argv, [] {
    add("spr/cell_stress", cell_stress, {{6}, {50}});
    add("spr/fit", fit, {{6}, {50}});
    for (const bool contact : {false, true}) {
      const std::string kind = contact ? "contact" : "boundary";
      const auto with = [contact](Method method) { return [=](int n) { return constrained(n, contact, method); }; };
      add("spr_c/" + kind, with(Method::fit), {{8}, {16}});
      add("kkt_lu/" + kind, with(Method::lu), {{8}, {16}});
      add("kkt_orthogonal/" + kind, with(Method::orthogonal), {{8}, {16}});
    }
    add("spr_c/whole", whole, {{5}, {16}});
  });
}
