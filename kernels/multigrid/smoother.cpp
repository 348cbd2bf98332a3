#include "kernels/multigrid/smoother.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>

#include "core/base/numbers/decompositions.hpp"
#include "kernels/mesh/halo.hpp"
#include "kernels/mesh/host_copy.hpp"
#include "kernels/mesh/launch.hpp"
#include "kernels/multigrid/surface_rows.hpp"

namespace cgcontact {
namespace {

constexpr int at[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

/// Terms that a node's block is the sum of, each with its rounding: eight cells, as many ghost faces.
constexpr double sums_of_a_block = 16;

constexpr int longest_run = 512;   // nodes
constexpr int items_at_once = 16;  // runs or columns

/// Step at the nodes of one column.
template <int size, class Real, class Vector>
KOKKOS_INLINE_FUNCTION void step_column(const NodeColumns<Real>& columns, int c, const Vector& r, Real alpha, Real beta,
                                        const Vector& d, const Vector& x, bool overwrite) {
  constexpr int n = dof_of(size);
  const auto& column = columns.columns(c);
  const Real* __restrict m = &columns.matrices(column.matrix);
  const int* nodes = &columns.nodes(column.first);
  Real z[n] = {};
  for (int q = 0; q < size; ++q)
    for (int j = 0; j < 3; ++j) {  // symmetric: row c is column c
      const Real value = alpha * r(dof_offset(nodes[q], j));
      for (int i = 0; i < n; ++i) z[i] += m[dof_of(q, j) * n + i] * value;
    }
  for (int p = 0; p < size; ++p)
    for (int i = 0; i < 3; ++i) {
      const std::size_t dof = dof_offset(nodes[p], i);
      Real change = z[dof_of(p, i)];
      if (beta != 0) change += beta * d(dof);
      d(dof) = change;
      x(dof) = overwrite ? change : x(dof) + change;
    }
}

}  // namespace

template <class Real>
SupportRows make_support_rows(const ElasticSystem& system, const NodeColumns<Real>& columns) {
  SupportRows result;
  const auto add_block = [&](int node, const Mat3& block) {
    const int c = system.constraint_of_node.empty() ? -1 : system.constraint_of_node[node];
    if (c < 0) return result.blocks.emplace_back(node, block), void();
    for (const auto& [master, weight] : system.constraints[c].masters)
      result.blocks.emplace_back(master, weight * weight * block);
  };
  const std::vector<const BodyMesh*> levels = system.level_meshes();
  for (std::size_t b = 0; b < levels.size(); ++b) {
    const BodyMesh& mesh = *levels[b];
    std::vector<SupportTerm> terms;
    for (const SupportTerm& t : system.supports[b])
      if (t.thin && std::none_of(mesh.cell_nodes[t.cell].begin(), mesh.cell_nodes[t.cell].end(),
                                 [&](const int n) { return columns.column_of_node(n) >= 0; }))
        terms.push_back(t);
    std::stable_sort(terms.begin(), terms.end(),
                     [](const SupportTerm& x, const SupportTerm& y) { return x.cell < y.cell; });
    for (std::size_t first = 0, last; first < terms.size(); first = last) {
      for (last = first; last < terms.size() && terms[last].cell == terms[first].cell;) ++last;
      // Directions of one cell that lie within 45 degrees share a row.
      std::vector<Vec3> direction;
      std::vector<std::array<double, 24>> sum;
      std::vector<double> stiffness;
      for (std::size_t t = first; t < last; ++t) {
        std::size_t r = 0;
        while (r < direction.size() && direction[r].dot(terms[t].direction) < 0.7) ++r;
        if (r == direction.size()) {
          direction.push_back(terms[t].direction);
          sum.emplace_back();
          stiffness.push_back(0);
        }
        double N[8];
        hex_shape(terms[t].xi.data(), N);
        for (int a = 0; a < 8; ++a)
          for (int i = 0; i < 3; ++i) sum[r][dof_of(a, i)] += terms[t].stiffness * N[a] * terms[t].direction[i];
        stiffness[r] += terms[t].stiffness;
      }
      for (std::size_t r = 0; r < direction.size(); ++r) {
        GroupRow row;
        row.level = static_cast<int>(b);
        row.cell = terms[first].cell;
        for (int a = 0; a < 8; ++a) {
          const int node = mesh.cell_nodes[row.cell][a];
          const Vec3 mean = Eigen::Map<const Vec3>(&sum[r][dof_of(a, 0)]) / stiffness[r];
          for (int i = 0; i < 3; ++i)
            if (mean[i] != 0) row.entries.emplace_back(dof_of(node, i), mean[i]);
          add_block(node, stiffness[r] * mean * mean.transpose());
        }
        resolve_constraints(system, row.entries);
        result.rows.push_back(std::move(row));
        result.stiffness.push_back(stiffness[r]);
      }
    }
  }
  return result;
}

template SupportRows make_support_rows(const ElasticSystem&, const NodeColumns<float>&);
template SupportRows make_support_rows(const ElasticSystem&, const NodeColumns<double>&);

/// In double: across a sliver the entries of a column differ by many orders.
template <class Real>
void SurfaceSmoother<Real>::invert_columns(const BlocksView& blocks) {
  const NodeColumns<Real> columns = columns_;
  Kokkos::parallel_for(
      "cgcontact::smoother::invert_columns", Kokkos::RangePolicy<ExecSpace>(0, columns.num_columns()),
      KOKKOS_LAMBDA(const int c) {
        using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor,
                                     dof_of(NodeColumns<Real>::longest), dof_of(NodeColumns<Real>::longest)>;
        const auto& column = columns.columns(c);
        const int n = dof_of(column.size);
        Real* entries = &columns.matrices(column.matrix);
        Matrix m(n, n), nodes = Matrix::Zero(n, n);
        for (int row = 0; row < n; ++row)
          for (int col = 0; col < n; ++col) m(row, col) = 0.5 * (entries[row * n + col] + entries[col * n + row]);
        for (int p = 0; p < column.size; ++p)
          for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
              m(dof_of(p, i), dof_of(p, j)) = nodes(dof_of(p, i), dof_of(p, j)) =
                  blocks(columns.nodes(column.first + p), at[i][j]);
        Eigen::LLT<Matrix> llt(m);
        if (llt.info() != Eigen::Success) llt.compute(nodes);  // single precision has lost the blocks between nodes
        const Matrix inverse = llt.solve(Matrix::Identity(n, n));
        for (int row = 0; row < n; ++row)
          for (int col = 0; col < n; ++col) entries[row * n + col] = static_cast<Real>(inverse(row, col));
      });
}

/// Takes the support rows out of the node blocks, but where rounding leaves nothing definite: what is counted twice
/// there makes M larger, not indefinite.
template <class Real>
void SurfaceSmoother<Real>::take_out_supports(const BlocksView& blocks) {
  std::vector<std::pair<int, Mat3>>& taken = supports_.blocks;
  std::stable_sort(taken.begin(), taken.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t first = 0, last; first < taken.size(); first = last) {
    const int node = taken[first].first;
    Mat3 rest;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) rest(i, j) = blocks(node, at[i][j]);
    const double rounding = sums_of_a_block * std::numeric_limits<Real>::epsilon() * rest.trace();
    for (last = first; last < taken.size() && taken[last].first == node; ++last) rest -= taken[last].second;
    if (!(eigenvalues(rest)[0] > rounding)) continue;
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j) blocks(node, at[i][j]) = static_cast<Real>(rest(i, j));
  }
  taken = {};
}

template <class Real>
SurfaceSmoother<Real>::SurfaceSmoother(const ElasticSystem& system, const BlocksView& blocks,
                                       const NodeColumns<Real>& columns, SupportRows supports)
    : num_nodes_(system.num_nodes), dofs_(system.dofs), columns_(columns), supports_(std::move(supports)) {
  take_out_supports(blocks);
  // The blocks of the stencil are multiples of the identity: most nodes need no matrix.
  std::vector<std::array<int, 3>> runs;
  std::vector<Real> run_inverse;
  block_of_node_ = IntView("cgcontact::smoother::block_of_node", num_nodes_);
  int num_blocks = 0;
  for (int n = 0; n < num_nodes_; ++n) {
    const Real d = blocks(n, 0);
    const bool scalar =
        blocks(n, 1) == d && blocks(n, 2) == d && blocks(n, 3) == 0 && blocks(n, 4) == 0 && blocks(n, 5) == 0;
    const bool in_column = columns_.column_of_node(n) >= 0;
    const Real inverse = in_column ? -1 : scalar ? 1 / d : 0;
    block_of_node_(n) = in_column ? -2 : scalar ? -1 : num_blocks;
    if (runs.empty() || run_inverse.back() != inverse || runs.back()[1] == longest_run) {
      runs.push_back({n, 0, block_of_node_(n)});
      run_inverse.push_back(inverse);
    }
    ++runs.back()[1];
    num_blocks += !scalar && !in_column;
  }
  run_ = copy_rows_to_view<decltype(run_)>("cgcontact::smoother::run", runs);
  run_inverse_ = copy_to_view<Vector>("cgcontact::smoother::run_inverse", run_inverse);
  inverse_ = BlocksView("cgcontact::smoother::inverse", num_blocks);
  const auto block_of_node = block_of_node_;
  const auto inverses = inverse_;
  Kokkos::parallel_for(
      "cgcontact::smoother::invert", Kokkos::RangePolicy<ExecSpace>(0, num_nodes_), KOKKOS_LAMBDA(const int n) {
        const int b = block_of_node(n);
        if (b < 0) return;
        Mat3 m;
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) m(i, j) = blocks(n, at[i][j]);
        const Mat3 inverse = m.inverse();
        for (int i = 0; i < 3; ++i)
          for (int j = i; j < 3; ++j) inverses(b, at[i][j]) = static_cast<Real>(inverse(i, j));
      });
  invert_columns(blocks);
}

template <class Real>
Mat3 SurfaceSmoother<Real>::inverse(int node) const {
  const int b = block_of_node_(node);
  Mat3 m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = b < 0 ? 0 : inverse_(b, at[i][j]);
  if (b >= 0) return m;
  int low = 0, high = static_cast<int>(run_.extent(0));
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    (run_(middle, 0) <= node ? low : high) = middle;
  }
  return run_inverse_(low) * Mat3::Identity();
}

template <class Real>
void SurfaceSmoother<Real>::set_groups(const std::vector<GroupRow>& rows, const std::vector<double>& stiffness) {
  SurfaceRows surface;
  const auto add = [&](const GroupRow& row, double k) {
    surface.add(row, k, columns_, [this](int node) { return inverse(node); });
  };
  for (std::size_t r = 0; r < supports_.rows.size(); ++r) add(supports_.rows[r], supports_.stiffness[r]);
  for (std::size_t r = 0; r < rows.size(); ++r) add(rows[r], stiffness[r]);
  surface.sort_by_nodes(num_nodes_);
  store_rows(surface);
  make_matrix(surface);
}

/// Copies the rows to where kernels read them.
template <class Real>
void SurfaceSmoother<Real>::store_rows(const SurfaceRows& rows) {
  num_rows_ = rows.num_rows();
  touched_ = copy_to_view<IntView>("cgcontact::smoother::touched", rows.touched_nodes);
  node_begin_ = copy_to_view<IntView>("cgcontact::smoother::node_begin", rows.node_begin);
  node_row_ = copy_to_view<IntView>("cgcontact::smoother::node_row", rows.node_row);
  row_begin_ = copy_to_view<IntView>("cgcontact::smoother::row_begin", rows.begin);
  row_node_ = copy_to_view<IntView>("cgcontact::smoother::row_node", rows.node);
  node_w_ = decltype(node_w_)("cgcontact::smoother::node_w", rows.node.size());
  row_w_ = decltype(row_w_)("cgcontact::smoother::row_w", rows.node.size());
  for (std::size_t e = 0; e < rows.node.size(); ++e)
    for (int i = 0; i < 3; ++i) {
      row_w_(e, i) = static_cast<Real>(rows.w[e][i]);
      node_w_(e, i) = static_cast<Real>(rows.w[rows.node_entry[e]][i]);
    }
  surface_ = Vector("cgcontact::smoother::surface", num_rows_);
}

/// Makes C = 1 + sum over touched nodes b^T D^-1 b.
template <class Real>
void SurfaceSmoother<Real>::make_matrix(const SurfaceRows& rows) {
  matrix_.reset();
  if (num_rows_ == 0) return;
  typename SurfaceMatrix<Real>::Entries entries;
  std::vector<double> sum(num_rows_, 0.0);
  std::vector<int> marked;
  std::vector<char> seen(num_rows_, 0);
  for (int r = 0; r < num_rows_; ++r) {
    if (dofs_.halo() && rows.begin[r] == rows.begin[r + 1]) continue;  // the row of other ranks
    marked.assign(1, r);
    seen[r] = 1;
    sum[r] = dofs_.halo() ? 0 : 1;
    for (int e = rows.begin[r]; e < rows.begin[r + 1]; ++e) {
      const int t = rows.touched[rows.node[e]];
      for (int p = rows.node_begin[t]; p < rows.node_begin[t + 1]; ++p) {
        const int s = rows.node_row[p];
        if (s < r) continue;
        if (!seen[s]) {
          seen[s] = 1;
          marked.push_back(s);
        }
        sum[s] += rows.b[e].dot(rows.w[rows.node_entry[p]]);
      }
    }
    for (const int s : marked) {
      entries.emplace_back(s, r, static_cast<Real>(sum[s]));
      sum[s] = 0;
      seen[s] = 0;
    }
  }
  matrix_ = dofs_.halo() ? std::make_shared<const SurfaceMatrix<Real>>(num_rows_, entries, dofs_.halo()->comm())
                         : std::make_shared<const SurfaceMatrix<Real>>(num_rows_, entries);
}

template <class Real>
void SurfaceSmoother<Real>::multiply_rows(const ExecSpace& exec, const Vector& r) const {
  const auto row_begin = row_begin_, row_node = row_node_;
  const auto w = row_w_;
  const auto surface = surface_;
  launch(
      "cgcontact::smoother::rows", Kokkos::RangePolicy<ExecSpace>(exec, 0, num_rows_), grain_of_medium,
      KOKKOS_LAMBDA(const int k) {
        Real sum = 0;
        for (int e = row_begin(k); e < row_begin(k + 1); ++e)
          for (int i = 0; i < 3; ++i) sum += w(e, i) * r(dof_of(row_node(e), i));
        surface(k) = sum;
      });
}

template <class Real>
void SurfaceSmoother<Real>::step(const ExecSpace& exec, const Vector& r, Real alpha, Real beta, const Vector& d,
                                 const Vector& x, bool overwrite) const {
  if (num_rows_ > 0) {
    multiply_rows(exec, r);
    exec.fence();
    matrix_->solve(exec, surface_);
  }
  const int num_runs = static_cast<int>(run_.extent(0));
  const NodeColumns<Real> columns = columns_;
  const auto run = run_;
  const auto run_inverse = run_inverse_;
  const auto inverse = inverse_;
  launch(
      "cgcontact::smoother::nodes",
      Kokkos::RangePolicy<ExecSpace, Kokkos::Schedule<Kokkos::Dynamic>>(exec, 0, num_runs + columns.num_columns(),
                                                                        Kokkos::ChunkSize(items_at_once)),
      grain_of_heavy, KOKKOS_LAMBDA(const int k) {
        if (k >= num_runs) {
          const int c = k - num_runs;
          switch (columns.columns(c).size) {
            case 2:
              return step_column<2>(columns, c, r, alpha, beta, d, x, overwrite);
            case 3:
              return step_column<3>(columns, c, r, alpha, beta, d, x, overwrite);
            case 4:
              return step_column<4>(columns, c, r, alpha, beta, d, x, overwrite);
            default:
              return step_column<NodeColumns<Real>::longest>(columns, c, r, alpha, beta, d, x, overwrite);
          }
        }
        const std::size_t first = dof_offset(run(k, 0));
        const int nodes = run(k, 1);
        const Real* __restrict rk = r.data() + first;
        Real* __restrict dk = d.data() + first, * __restrict xk = x.data() + first;
        const auto add = [&](int i, Real z) {
          Real change = alpha * z;
          if (beta != 0) change += beta * dk[i];
          dk[i] = change;
          xk[i] = overwrite ? change : xk[i] + change;
        };
        if (run(k, 2) == -2) return;
        if (run(k, 2) < 0) {
          const Real scalar = run_inverse(k);
          for (int i = 0; i < dof_of(nodes); ++i) add(i, scalar * rk[i]);
          return;
        }
        for (int n = 0; n < nodes; ++n) {
          const Real* m = &inverse(run(k, 2) + n, 0);
          const Real r0 = rk[dof_of(n, 0)], r1 = rk[dof_of(n, 1)], r2 = rk[dof_of(n, 2)];
          add(dof_of(n, 0), m[0] * r0 + m[3] * r1 + m[5] * r2);
          add(dof_of(n, 1), m[3] * r0 + m[1] * r1 + m[4] * r2);
          add(dof_of(n, 2), m[5] * r0 + m[4] * r1 + m[2] * r2);
        }
      });
  static_assert(NodeColumns<Real>::longest == 5);
  if (num_rows_ == 0) return;
  const auto surface = surface_;
  const auto touched = touched_, node_begin = node_begin_, node_row = node_row_;
  const auto w = node_w_;
  launch(
      "cgcontact::smoother::touched", Kokkos::RangePolicy<ExecSpace>(exec, 0, touched.extent(0)), grain_of_medium,
      KOKKOS_LAMBDA(const int t) {
        for (int i = 0; i < 3; ++i) {
          Real z = 0;
          for (int e = node_begin(t); e < node_begin(t + 1); ++e) z += w(e, i) * surface(node_row(e));
          d(dof_of(touched(t), i)) -= alpha * z;
          x(dof_of(touched(t), i)) -= alpha * z;
        }
      });
}

template class SurfaceSmoother<float>;
template class SurfaceSmoother<double>;

}  // namespace cgcontact
