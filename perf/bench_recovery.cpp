/// Stress recovery: cell integrals, unconstrained fits (SPR), constrained fits (SPR-C) of boundary and contact patches
/// against dense KKT systems, and the whole constrained recovery.
///
/// Sizes: cells along the block's edge for SPR, n of scenes/two_solids_3d.toml for the patches, cells along the lower
/// block for the whole recovery (scenes/patch_test.toml, the upper grid turned).
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>

#include "core/base/numbers/decompositions.hpp"
#include "kernels/mesh/hex.hpp"
#include "perf/harness.hpp"
#include "perf/problems.hpp"
#include "recovery/batched/batched_fit.hpp"
#include "recovery/constrained/boundary_facets.hpp"
#include "recovery/constrained/fit_kernels.hpp"
#include "recovery/constrained/patch_lists.hpp"
#include "recovery/constrained/recover_stress.hpp"
#include "recovery/patch/patch_arrays.hpp"

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
    for (int i = 0; i < 3; ++i) u(dof_of(mesh.first_node + n, i)) = value[i];
  }
}

/// Integrals of a constant stress: stress times the cell's moments, in every cell.
double constant_stress_error(const SprProblem& p, const Mat3& gradient) {
  double g[3][3], s[6], largest = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) g[i][j] = gradient(i, j);
  p.mesh().law.stress(g, 0, s);
  for (std::size_t c = 0; c < p.stress.extent(0); ++c)
    for (int k = 0; k < 6; ++k)
      for (int t = 0; t < num_terms; ++t)
        largest = std::max(largest, std::abs(p.stress(c, k, t) - s[k] * p.moments(static_cast<int>(c))[t]));
  return largest;
}

/// Sums and differences of the corners 72 flop; for each of the four integrals 9 gradients of 8, factors 12, stress
/// 15, scaling 6. Bytes: displacements once, node numbers and number of the moments, 17 moments of cut cells, 24
/// integrals written.
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

/// Plain reference of one fit: normal equations summed cell by cell, solved by Eigen.
Eigen::Matrix<double, num_terms, 6> plain_fit(const SprProblem& p, int n) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, num_terms, 6> rhs = rhs.Zero();
  for (int i = p.patches.begin[n]; i < p.patches.begin[n + 1]; ++i) {
    const int c = p.patches.cells[i];
    Eigen::Matrix4d own, shift = Eigen::Matrix4d::Identity();  // {1, x, y, z} about the cell's centre -> about the node
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

/// Conditions on one patch's stresses, for one body or two, of any degree.
struct Patch {
  std::vector<std::pair<int, int>> node;  ///< body and node of each polynomial
  std::vector<FitRow<2>> rows;
};

/// Mass matrix of a node's patch, packed. Degree 2: as if all cells were whole (cut cells have no moments of degree
/// 4; the work is the same).
template <int degree>
void patch_mass(const BodyMesh& mesh, const PatchSet& patches, int n, double* packed) {
  constexpr int T = Polynomial<degree>::num_terms;
  const double centre[3] = {double(mesh.nodes[n][0]), double(mesh.nodes[n][1]), double(mesh.nodes[n][2])};
  const int* cells = &patches.cells[patches.begin[n]];
  const int num_cells = patches.begin[n + 1] - patches.begin[n];
  double m[T][T] = {};
  if constexpr (degree == 1) {
    gather_mass(host_arrays(mesh, patches), cells, num_cells, centre, m);
  } else {
    for (int q = 0; q < 27 * num_cells; ++q) {
      const int point[3] = {q % 3, q / 3 % 3, q / 9 % 3};
      double d[3], terms[T], weight = 1;
      for (int i = 0; i < 3; ++i) {
        d[i] = mesh.cut_cells->cells[cells[q / 27]][i] + 0.5 * (1 + Gauss3::point[point[i]]) - centre[i];
        weight *= (point[i] == 1 ? 8.0 : 5.0) / 18;
      }
      Polynomial<degree>::terms(d, terms);
      for (int i = 0; i < T; ++i)
        for (int j = 0; j <= i; ++j) m[i][j] += weight * terms[i] * terms[j];
    }
  }
  for (int i = 0; i < T; ++i)
    for (int j = 0; j <= i; ++j) packed[i * (i + 1) / 2 + j] = m[i][j];
}

/// Rows as in recovery/constrained/patch_rows.cpp: known tractions on free and loaded faces, zero shear on
/// supports; on contact faces zero shear of both bodies and equal normal tractions. Three points per face; degree 2:
/// and those between them.
class PatchBuilder {
 public:
  PatchBuilder(const SceneProblem& problem, int body, int degree)
      : p_(problem.simulation.state),
        patches_(problem.patches),
        body_(body),
        other_(1 - body),
        degree_(degree),
        facets_(p_.bodies[body].cut_cells, p_.bodies[body].boundary) {}

  /// False if the node's patch is not of the kind asked for.
  bool build(int n, bool contact, Patch& patch) {
    const PatchSet& set = patches_[body_];
    const auto groups = facets_.groups(&set.cells[set.begin[n]], set.begin[n + 1] - set.begin[n]);
    const bool touches = std::any_of(groups.begin(), groups.end(), [](const auto& g) { return g.pair >= 0; });
    if (groups.empty() || touches != contact) return false;
    const Index3& node = p_.system.meshes[body_].nodes[n];
    centre_ = Vec3(node[0], node[1], node[2]);
    patch.node = {{body_, n}};
    if (contact) add_other_body(groups, patch);
    for (const ConstraintGroup& g : groups) add_group(g, patch.rows);
    return true;
  }

 private:
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
    patch.node.emplace_back(other_, nearest);
  }

  Vec3 to_other(const Vec3& x) const {
    return p_.bodies[other_].cut_cells.grid.to_grid(p_.bodies[body_].cut_cells.grid.to_global(x));
  }

  static void set_term(FitRow<2>& row, int b, const Vec3& position, const Vec3& n, const Vec3& e) {
    traction_weight(n.data(), e.data(), row.weight[b]);
    for (int i = 0; i < 3; ++i) row.position[b][i] = position[i];
  }
  static FitRow<2> row_of(int b, const Vec3& position, const Vec3& n, const Vec3& e) {
    FitRow<2> row{};
    set_term(row, b, position, n, e);
    row.value = Eigen::Vector2d::Random()[0];
    return row;
  }

  void add_group(const ConstraintGroup& g, std::vector<FitRow<2>>& rows) const {
    for (int i = 0; i < g.num_points; ++i) {
      add_point(g, g.position[i], g.normal[i], rows);
      const int j = (i + 1) % g.num_points;
      if (degree_ == 2 && j != i && (j > i || g.num_points > 2))
        add_point(g, 0.5 * (g.position[i] + g.position[j]), (g.normal[i] + g.normal[j]).normalized(), rows);
    }
  }

  void add_point(const ConstraintGroup& g, const Vec3& x, const Vec3& n, std::vector<FitRow<2>>& rows) const {
    const bool support = g.pair < 0 && p_.bodies[body_].boundary.conditions[g.condition].is_support();
    const auto [t1, t2] = tangents(n);
    rows.push_back(row_of(0, x - centre_, n, t1));
    rows.push_back(row_of(0, x - centre_, n, t2));
    if (support) return;
    FitRow<2> normal = row_of(0, x - centre_, n, n);
    if (g.pair >= 0) {
      const Mat3 turn =
          p_.bodies[other_].cut_cells.grid.rotation.transpose() * p_.bodies[body_].cut_cells.grid.rotation;
      const Vec3 e = to_other(x) - other_centre_, m = turn * n;
      rows.push_back(row_of(1, e, m, turn * t1));
      rows.push_back(row_of(1, e, m, turn * t2));
      set_term(normal, 1, e, m, -m);
    }
    rows.push_back(normal);
  }

  const SolvedState& p_;
  const std::vector<PatchSet>& patches_;
  int body_, other_, degree_;
  BoundaryFacets facets_;
  Vec3 centre_, other_centre_;
};

/// Patches of one kind, as the batched fits take them.
template <int degree, int bodies>
struct PatchBatch {
  using Input = FitInput<degree, bodies>;
  static constexpr int T = Polynomial<degree>::num_terms, num_interior = bodies * Polynomial<degree>::num_interior;
  static constexpr int num_columns = bodies * 6 * T;
  std::vector<std::vector<FitRow<bodies>>> rows;
  std::vector<Input> inputs;  ///< unconstrained

  void add(const SceneProblem& problem, const Patch& patch) {
    Input in;
    for (int b = 0; b < bodies; ++b) {
      const auto [body, node] = patch.node[b];
      patch_mass<degree>(problem.system.meshes[body], problem.patches[body], node, in.mass[b]);
      Eigen::Map<Eigen::VectorXd>(in.a[b][0], 6 * T).setRandom();
      Eigen::Map<Eigen::VectorXd>(in.interior[b], Polynomial<degree>::num_interior).setRandom();
      in.poisson_ratio[b] = 0.3;
    }
    rows.emplace_back();
    for (const FitRow<2>& from : patch.rows) {
      FitRow<bodies>& row = rows.back().emplace_back();
      for (int b = 0; b < bodies; ++b) {
        std::copy_n(from.weight[b], 6, row.weight[b]);
        std::copy_n(from.position[b], 3, row.position[b]);
      }
      row.value = from.value;
    }
    in.rows = rows.back().data();
    in.num_rows = static_cast<int>(rows.back().size());
    inputs.push_back(in);
  }

  /// Chunks as the recovery hands them out, to all threads.
  void fit(std::vector<Input>& fitted, std::vector<FitStatus>& status) const {
    constexpr std::size_t chunk = 2048;
    fitted = inputs;
    status.resize(inputs.size());
    for (std::size_t begin = 0; begin < inputs.size(); begin += chunk)
      fit_batch(Kokkos::DefaultHostExecutionSpace(), &fitted[begin],
                static_cast<int>(std::min(chunk, inputs.size() - begin)), RecoveryOptions{}.rank_tolerance_of(degree),
                &status[begin]);
  }
};

/// One patch with dense matrices, for the straightforward solutions.
struct DensePatch {
  Eigen::MatrixXd mass[2], C;
  Eigen::VectorXd lambda, a;

  template <int degree, int bodies>
  explicit DensePatch(const FitInput<degree, bodies>& in) {
    using P = Polynomial<degree>;
    constexpr int T = P::num_terms, interior = P::num_interior;
    C = Eigen::MatrixXd::Zero(bodies * interior + in.num_rows, bodies * 6 * T);
    lambda.resize(C.rows());
    a = Eigen::Map<const Eigen::VectorXd>(in.a[0][0], C.cols());
    for (int b = 0; b < bodies; ++b) {
      mass[b].resize(T, T);
      for (int i = 0; i < T; ++i)
        for (int j = 0; j <= i; ++j) mass[b](i, j) = mass[b](j, i) = in.mass[b][i * (i + 1) / 2 + j];
      for (int r = 0; r < interior; ++r) {
        lambda[b * interior + r] = in.interior[b][r];
        P::visit_row(r, 1 / (1 + in.poisson_ratio[b]),
                     [&](int c, int t, double entry) { C(b * interior + r, (b * 6 + c) * T + t) += entry; });
      }
      for (int r = 0; r < in.num_rows; ++r) {
        double terms[T];
        P::terms(in.rows[r].position[b], terms);
        for (int c = 0; c < 6; ++c)
          for (int t = 0; t < T; ++t)
            C(bodies * interior + r, (b * 6 + c) * T + t) = in.rows[r].weight[b][c] * terms[t];
      }
    }
    for (int r = 0; r < in.num_rows; ++r) lambda[bodies * interior + r] = in.rows[r].value;
  }

  template <class Matrix>
  void for_each_mass(const Matrix& use) const {
    const Eigen::Index T = mass[0].rows();
    for (Eigen::Index k = 0; k < C.cols() / T; ++k) use(k * T, T, mass[k / 6]);
  }
};

enum class Method { lu, orthogonal };

/// Dense KKT matrix: LU with partial pivoting, for independent rows; complete orthogonal decomposition, for any.
void solve(const DensePatch& p, Method method, Eigen::VectorXd& a) {
  const Eigen::Index n = p.C.cols(), rows = p.C.rows();
  Eigen::MatrixXd kkt = Eigen::MatrixXd::Zero(n + rows, n + rows);
  p.for_each_mass([&](Eigen::Index i, Eigen::Index T, const auto& m) { kkt.block(i, i, T, T) = m; });
  kkt.topRightCorner(n, rows) = p.C.transpose();
  kkt.bottomLeftCorner(rows, n) = p.C;
  Eigen::VectorXd rhs(n + rows);
  rhs.head(n) = kkt.topLeftCorner(n, n) * p.a;
  rhs.tail(rows) = p.lambda;
  if (method == Method::lu)
    a = kkt.partialPivLu().solve(rhs).head(n);
  else
    a = kkt.completeOrthogonalDecomposition().solve(rhs).head(n);
}

/// The truncated solution from a singular value decomposition of the whitened, normalised rows.
Eigen::VectorXd solve_truncated(const DensePatch& p) {
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(p.C.cols(), p.C.cols());
  p.for_each_mass([&](Eigen::Index i, Eigen::Index T, const auto& m) { M.block(i, i, T, T) = m; });
  const Eigen::LLT<Eigen::MatrixXd> factor(M);
  Eigen::MatrixXd rows = factor.matrixL().solve(p.C.transpose()).transpose();
  const Eigen::VectorXd norm = rows.rowwise().norm();
  rows = norm.cwiseInverse().asDiagonal() * rows;
  const SingularValues svd(rows, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const auto values = svd.values().array();
  const double least = RecoveryOptions{}.rank_tolerance_of(p.C.cols() % 60 == 0 ? 2 : 1) *  // 60 or 24 columns per body
                       values[0];
  const Eigen::VectorXd inverse = (values > least).select(values.inverse(), 0);
  const Eigen::VectorXd defect = (p.lambda - p.C * p.a).cwiseQuotient(norm);
  return p.a + factor.matrixU().solve(svd.right() * (inverse.asDiagonal() * (svd.left().transpose() * defect)));
}

/// Patches whose rows are independent (all ways to solve them give the same answer), or those with truncated ones.
template <int degree, int bodies>
PatchBatch<degree, bodies> collect_patches(int n, bool truncated) {
  const SceneProblem problem("scenes/two_solids_3d.toml", {"n=" + std::to_string(n)});
  PatchBatch<degree, bodies> batch;
  const std::size_t enough = is_toy() ? 20 : 2000;
  for (int body : {0, 1}) {
    PatchBuilder builder(problem, body, degree);
    for (int node = 0; node < problem.system.meshes[body].num_nodes && batch.inputs.size() < enough; ++node) {
      Patch patch;
      if (!builder.build(node, bodies == 2, patch)) continue;
      batch.add(problem, patch);
      FitInput<degree, bodies> trial = batch.inputs.back();
      FitStatus status;
      fit_batch(Kokkos::DefaultHostExecutionSpace(), &trial, 1, RecoveryOptions{}.rank_tolerance_of(degree), &status);
      if (status.finite && (status.truncated > 0) == truncated) continue;
      batch.inputs.pop_back();
      batch.rows.pop_back();
    }
  }
  if (batch.inputs.empty()) throw std::logic_error("no such patch");
  return batch;
}

template <int degree, int bodies>
std::function<void()> solve_all(std::shared_ptr<PatchBatch<degree, bodies>> batch, Method method) {
  auto dense = std::make_shared<std::vector<DensePatch>>(batch->inputs.begin(), batch->inputs.end());
  return [dense, method] {
    Eigen::VectorXd a;
    for (const DensePatch& p : *dense) solve(p, method, a);
    benchmark::DoNotOptimize(a.data());
  };
}

template <int degree, int bodies>
void set_figures(const PatchBatch<degree, bodies>& batch, Kernel& k) {
  double rows = 0;
  for (const auto& in : batch.inputs) rows += in.num_rows + batch.num_interior;
  k.unit = "patches";
  k.items = static_cast<double>(batch.inputs.size());
  k.figures = {{"rows", rows / k.items}};
}

/// The copy of the unconstrained coefficients is included in the run. Flop: fit_flop; bytes: input once, coefficients
/// back.
template <int degree, int bodies>
Kernel batched(int n, bool truncated) {
  auto batch = std::make_shared<PatchBatch<degree, bodies>>(collect_patches<degree, bodies>(n, truncated));
  auto fitted = std::make_shared<std::vector<FitInput<degree, bodies>>>();
  auto status = std::make_shared<std::vector<FitStatus>>();
  Kernel k;
  set_figures(*batch, k);
  batch->fit(*fitted, *status);
  for (std::size_t i = 0; i < fitted->size(); ++i) {
    const auto& in = batch->inputs[i];
    const DensePatch dense(in);
    Eigen::VectorXd plain;
    if (truncated)
      plain = solve_truncated(dense);
    else
      solve(dense, Method::orthogonal, plain);
    const Eigen::Map<const Eigen::VectorXd> a((*fitted)[i].a[0][0], batch->num_columns);
    k.error = std::max(k.error, (a - plain).norm() / plain.norm());
    k.cost.flop += fit_flop(degree, bodies, in.num_rows, truncated);
    k.cost.bytes += sizeof in + sizeof in.a + in.num_rows * sizeof(FitRow<bodies>);
  }
  k.tolerance = 1e-9;
  k.against = truncated ? "truncated singular values" : "the KKT system by orthogonal decomposition";
  k.run = [batch, fitted, status] { batch->fit(*fitted, *status); };
  k.baseline = solve_all(batch, truncated ? Method::orthogonal : Method::lu);
  return k;
}

/// N unknowns and multipliers. LU: 2/3 N^3 + 2 N^2; orthogonal decomposition: twice the first term. Bytes: matrix and
/// vectors once.
template <int degree, int bodies>
Kernel straightforward(int n, bool truncated, Method method) {
  auto batch = std::make_shared<PatchBatch<degree, bodies>>(collect_patches<degree, bodies>(n, truncated));
  Kernel k;
  set_figures(*batch, k);
  for (const auto& in : batch->inputs) {
    const DensePatch dense(in);
    if (!truncated) {  // else each has an answer of its own
      Eigen::VectorXd a, plain;
      solve(dense, method, a);
      solve(dense, method == Method::orthogonal ? Method::lu : Method::orthogonal, plain);
      k.error = std::max(k.error, (a - plain).norm() / plain.norm());
    }
    const double r = static_cast<double>(dense.C.rows()), c = static_cast<double>(dense.C.cols()), N = r + c;
    k.cost.flop += (method == Method::lu ? 1 : 2) * 2 * N * N * N / 3 + 2 * N * N;
    k.cost.bytes += 8 * (r * c + r + 2 * c) + sizeof in.mass;
  }
  k.tolerance = 1e-9, k.against = "the KKT system by another decomposition";
  k.run = solve_all(batch, method);
  return k;
}

template <int degree, int bodies>
void add_constrained_fits() {
  const std::string kind = std::string(bodies == 2 ? "contact" : "boundary") + "_p" + std::to_string(degree);
  const Sizes sizes{{8}, {16}};
  perf::add(
      "spr_c/" + kind, [](int n) { return batched<degree, bodies>(n, false); }, sizes);
  perf::add(
      "spr_c_truncated/" + kind, [](int n) { return batched<degree, bodies>(n, true); }, sizes);
  perf::add(
      "kkt_lu/" + kind, [](int n) { return straightforward<degree, bodies>(n, false, Method::lu); }, sizes);
  for (const bool truncated : {false, true})
    perf::add((truncated ? "kkt_orthogonal_truncated/" : "kkt_orthogonal/") + kind,
              [=](int n) { return straightforward<degree, bodies>(n, truncated, Method::orthogonal); }, sizes);
}

/// The whole recovery of the contact patch test, whose exact stress (uniform pressure) every patch must meet.
struct RecoveryProblem {
  SceneProblem problem;
  std::vector<RecoveryBody> bodies;
  std::vector<Sym3> exact;  ///< per body, grid axes, Scales::stress
  std::vector<CoefficientView> unconstrained;
  RealView u;
  RecoveryOptions options;

  RecoveryProblem(int cells, const RecoveryDegree& degree)
      : problem("scenes/patch_test.toml", {"h=1/" + std::to_string(cells)}) {
    options.degree = degree;
    const double p = 1e8;
    const SolvedState& sim = problem.simulation.state;
    u = RealView("cgcontact::perf::u", problem.system.num_dofs());
    for (std::size_t b = 0; b < sim.bodies.size(); ++b) {
      const BodyModel& body = sim.bodies[b];
      const BodyMesh& mesh = problem.system.meshes[b];
      const Mat3& R = body.cut_cells.grid.rotation;
      const double E = body.spec->material.youngs_modulus, nu = body.spec->material.poisson_ratio;
      const Mat3 strain = Vec3(nu * p / E, nu * p / E, -p / E).asDiagonal();
      set_linear_field(mesh, mesh.h_of_level(0) * (R.transpose() * strain * R), u);
      const Mat3 s = R.transpose() * Vec3(0, 0, -p / sim.scales.stress).asDiagonal() * R;
      exact.emplace_back();
      exact.back() << s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0);
      unconstrained.emplace_back("cgcontact::perf::spr", mesh.num_nodes);
      const Subset all(mesh.num_nodes);
      recover_all(mesh, problem.patches[b], u, {all, unconstrained.back()});
      bodies.push_back({&mesh,
                        &problem.patches[b],
                        &body.boundary,
                        {all, CoefficientView("cgcontact::perf::spr_c", mesh.num_nodes)}});
    }
  }
  RecoveryCounts run() {
    for (std::size_t b = 0; b < bodies.size(); ++b) Kokkos::deep_copy(bodies[b].field.values, unconstrained[b]);
    return recover_constrained(HostExec(), bodies, u, problem.simulation.state.scales, options).counts;
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

/// Fits of patches of two rings of cells (one for degree 1) from the integrals over their cells, all of one class.
template <int degree>
struct SumFits {
  RecoveryProblem problem;
  StressIntegrals integrals;
  std::vector<Vec3> centre;
  std::vector<double> unit;
  std::vector<int> patch;
  FlatLists<int> cells;
  ClassArrays<Kokkos::HostSpace, degree, 1> arrays;

  explicit SumFits(int size) : problem(size, {}) {
    const RecoveryBody& body = problem.bodies[0];
    integrals = integrate_stress(*body.mesh, stress_of_displacements(*body.mesh, problem.u),
                                 Subset(static_cast<int>(body.mesh->cell_nodes.size())));
    std::vector<int> list;
    for (int n = 0; n < body.mesh->num_nodes; ++n) {
      cgcontact::fit_cells(body, n, {degree, degree}, list);
      cells.add(list);
      centre.push_back(body.mesh->node_position(n));
      unit.push_back(unit_of(*body.mesh, n));
      patch.push_back(n);
    }
    using Arrays = ClassArrays<Kokkos::HostSpace, degree, 1>;
    arrays = {view_of<decltype(Arrays::patch)>(patch), decltype(arrays.inputs)("cgcontact::perf::inputs", patch.size()),
              decltype(arrays.regular)("cgcontact::perf::regular", patch.size()),
              decltype(arrays.variance)("cgcontact::perf::variance", patch.size())};
  }
  void run() const {
    const HostExec exec;
    fit_sums(exec, host_arrays(*problem.bodies[0].mesh, integrals), host_arrays(centre, unit, cells),
             SubsetArrays<Kokkos::HostSpace>{{}, {}, static_cast<int>(patch.size())}, 0, arrays);
    exec.fence();
  }
  double error() const {
    double largest = 0;
    for (std::size_t n = 0; n < patch.size(); ++n)
      for (int k = 0; k < 6 && arrays.regular(n, 0); ++k)
        for (int t = 0; t < Polynomial<degree>::num_terms; ++t)
          largest = std::max(largest, std::abs(arrays.inputs(n).a[0][k][t] - (t == 0 ? problem.exact[0][k] : 0.0)));
    return largest / problem.exact[0].cwiseAbs().maxCoeff();
  }
};

/// Per cell of a patch 21 flop for each of six components and two for each of 70 products of moments, once along a
/// line (lines and layers are some tenths more and not counted); per patch Cholesky and six solves. Bytes: integrals
/// and moments of the cells of the body once, lists, what is written.
template <int degree>
Kernel sum_fits(int size) {
  constexpr double T = Polynomial<degree>::num_terms;
  auto p = std::make_shared<SumFits<degree>>(size);
  p->run();
  Kernel k;
  k.unit = "patches";
  k.items = static_cast<double>(p->patch.size());
  const auto entries = static_cast<double>(p->cells.items.size());
  k.cost = {entries * (6 * 21 + 2 * 70) + k.items * (T * T * T / 3 + 6 * 2 * T * T),
            8 * (80 + 35 + 1) * static_cast<double>(p->integrals.square.size()) + 4 * entries +
                8 * k.items * (T * (T + 1) / 2 + 6 * T + 5)};
  k.error = p->error(), k.tolerance = 1e-8, k.against = "the exact uniform stress";
  k.run = [p] { p->run(); };
  return k;
}

/// The copy of the unconstrained fit is included in the run. As if every patch were one constrained fit with the rows
/// PatchBuilder would give it, after an unconstrained one (133 flop per cell, 222 per patch; 296 bytes per cell).
/// Finding the groups of boundary points is not counted.
Cost whole_cost(const SceneProblem& problem) {
  Cost sum;
  for (std::size_t b = 0; b < problem.system.meshes.size(); ++b) {
    const PatchSet& set = problem.patches[b];
    const BodyModel& model = problem.simulation.state.bodies[b];
    const BoundaryFacets facets(model.cut_cells, model.boundary);
    for (int n = 0; n < problem.system.meshes[b].num_nodes; ++n) {
      const int cells = set.begin[n + 1] - set.begin[n];
      int rows = 3, columns = num_unknowns;
      for (const ConstraintGroup& g : facets.groups(&set.cells[set.begin[n]], cells)) {
        const bool support = g.pair < 0 && model.boundary.conditions[g.condition].is_support();
        rows += g.num_points * (g.pair >= 0 ? 5 : support ? 2 : 3);
        if (g.pair >= 0 && columns == num_unknowns) {
          columns = 2 * num_unknowns;
          rows += 3;
        }
      }
      sum.flop += fit_flop(1, columns / num_unknowns, rows - 3 * columns / num_unknowns, false) + 133 * cells + 222;
      sum.bytes += 80.0 * rows + 16.0 * columns + 296 * cells;
    }
  }
  return sum;
}

Kernel whole(int cells, const RecoveryDegree& degree) {
  auto p = std::make_shared<RecoveryProblem>(cells, degree);
  const RecoveryCounts counts = p->run();
  Kernel k;
  k.unit = "patches";
  k.items = p->problem.system.num_nodes;
  k.cost = whole_cost(p->problem);
  k.error = p->error(), k.tolerance = 1e-8, k.against = "the exact uniform stress";
  k.run = [p] { p->run(); };
  for (int kind = 0; kind < num_patch_kinds; ++kind)
    if (counts.kinds[kind] > 0) k.figures.emplace_back(patch_kind_names[kind], static_cast<double>(counts.kinds[kind]));
  k.figures.emplace_back("quadratic", static_cast<double>(counts.quadratic));
  k.figures.emplace_back("truncated", static_cast<double>(counts.statuses[static_cast<int>(PatchStatus::truncated)]));
  return k;
}

}  // namespace

int main(int argc, char** argv) {
  return run_benchmarks(argc, argv, [] {
    add("spr/cell_stress", cell_stress, {{6}, {50}});
    add("spr/fit", fit, {{6}, {50}});
    add("spr_c/sums_p1", sum_fits<1>, {{5}, {16}});
    add("spr_c/sums_p2", sum_fits<2>, {{5}, {16}});
    add_constrained_fits<1, 1>();
    add_constrained_fits<1, 2>();
    add_constrained_fits<2, 1>();
    add_constrained_fits<2, 2>();
    add("spr_c/whole", [](int cells) { return whole(cells, {}); }, {{5}, {16}});
    add("spr_c/whole_p1", [](int cells) { return whole(cells, {1, 1, 1}); }, {{5}, {16}});
  });
}
