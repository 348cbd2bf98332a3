#include "recovery/error/error_estimate.hpp"

#include "core/base/process/parallel.hpp"
#include "core/base/process/ranks.hpp"
#include "kernels/mesh/mean_dilatation.hpp"
#include "recovery/patch/polynomials.hpp"

namespace cgcontact {
namespace {

/// Chunks whose nodes' polynomials are in memory at a time, with what they are made of: some 100 MB.
constexpr std::size_t chunks_per_block = 4096;

/// Tables for the stresses at n^3 Gauss points of a cell; the points run along the rows, so that all loops over them
/// are contiguous.
template <int n>
struct GaussTables {
  static constexpr int num_points = n * n * n;
  using Row = std::array<double, num_points>;
  std::array<std::array<double, 3>, num_points> xi;
  std::array<std::array<Row, num_terms>, 8> recovered;  ///< shape function of a corner times {1, x, y, z} about it
  std::array<std::array<Row, QuadraticTerms::count>, 8> quadratic;  ///< the same times xx, yy, zz, xy, yz, zx
  std::array<std::array<Row, 3>, 8> gradient;                       ///< of the shape function of a corner

  GaussTables() {
    for (int q = 0; q < num_points; ++q) {
      double N[8], dN[8][3];
      for (int i = 0, stride = n * n; i < 3; ++i, stride /= n)
        xi[q][i] = n == 3 ? Gauss3::point[q / stride % n] : Gauss5::point[q / stride % n];
      hex_shape(xi[q].data(), N);
      hex_gradient(xi[q].data(), dN);
      for (int a = 0; a < 8; ++a) {
        recovered[a][0][q] = N[a];
        double d[3], p[Polynomial<2>::num_terms];
        for (int i = 0; i < 3; ++i) d[i] = 0.5 * (xi[q][i] + 1) - (a >> i & 1);
        Polynomial<2>::terms(d, p);
        for (int t = 0; t < QuadraticTerms::count; ++t) quadratic[a][t][q] = N[a] * p[num_terms + t];
        for (int i = 0; i < 3; ++i) {
          recovered[a][1 + i][q] = N[a] * d[i];
          gradient[a][i][q] = dN[a][i];
        }
      }
    }
  }
};

/// Stresses at the Gauss points of one cell: component, point.
template <int n>
struct CellStresses {
  using Tables = GaussTables<n>;
  double raw[6][Tables::num_points], recovered[6][Tables::num_points];

  CellStresses(const Tables& tables, const BodyMesh& mesh, int cell, const double u[8][3], const RecoveredField& field,
               const PolynomialBlock& block) {
    set_raw(tables, mesh, cell, u);
    set_recovered(tables, mesh, cell, block);
    if (field.quadratic) add_quadratic(tables, mesh, cell, *field.quadratic);
    if (field.edge) add_edge(tables, mesh, cell, field);
  }

 private:
  void set_raw(const Tables& tables, const BodyMesh& mesh, int cell, const double u[8][3]) {
    double g[3][3][Tables::num_points] = {};
    for (int a = 0; a < 8; ++a)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          for (int q = 0; q < Tables::num_points; ++q) g[i][j][q] += u[a][i] * tables.gradient[a][j][q];
    if (const Ring ring = mesh.ring_of(cell); ring.across >= 0)
      for (int q = 0; q < Tables::num_points; ++q) {
        double gradient[3][3] = {};
        add_ring_strain(ring, u, tables.xi[q].data(), gradient);
        g[ring.across][ring.across][q] = gradient[ring.across][ring.across];
      }
    const double factor = mesh.stress_factor(cell);
    const double lambda = factor * mesh.law.lambda_at_points(), mu = factor * mesh.law.mu;
    const double of_mean = factor * mesh.law.lambda_of_mean * mean_dilatation(mesh, cell, u);
    for (int q = 0; q < Tables::num_points; ++q) {
      const double trace = lambda * (g[0][0][q] + g[1][1][q] + g[2][2][q]) + of_mean;
      for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        raw[i][q] = trace + 2 * mu * g[i][i][q];
        raw[3 + i][q] = mu * (g[i][j][q] + g[j][i][q]);
      }
    }
  }

  void add_quadratic(const Tables& tables, const BodyMesh& mesh, int cell, const QuadraticTerms& terms) {
    for (int a = 0; a < 8; ++a) {
      const QuadraticTerms::Values* values = terms.of_node(mesh.cell_nodes[cell][a] - mesh.first_node);
      if (!values) continue;
      for (int k = 0; k < 6; ++k)
        for (int t = 0; t < QuadraticTerms::count; ++t)
          for (int q = 0; q < Tables::num_points; ++q) recovered[k][q] += (*values)[k][t] * tables.quadratic[a][t][q];
    }
  }

  void add_edge(const Tables& tables, const BodyMesh& mesh, int cell, const RecoveredField& field) {
    bool any = false;
    for (int corner : mesh.cell_nodes[cell])
      each_master(mesh, corner - mesh.first_node, [&](int node, double) { any = any || field.edge->of_node(node); });
    if (!any) return;
    for (int q = 0; q < Tables::num_points; ++q) {
      double N[8], s[6] = {};
      hex_shape(tables.xi[q].data(), N);
      add_edge_terms(mesh, field, cell, tables.xi[q].data(), N, s);
      for (int k = 0; k < 6; ++k) recovered[k][q] += s[k];
    }
  }

  void set_recovered(const Tables& tables, const BodyMesh& mesh, int cell, const PolynomialBlock& block) {
    for (auto& row : recovered) std::fill(std::begin(row), std::end(row), 0.0);
    for (int a = 0; a < 8; ++a) {
      const double* A = block.at(mesh.cell_nodes[cell][a] - mesh.first_node);
      for (int k = 0; k < 6; ++k)
        for (int q = 0; q < Tables::num_points; ++q)
          recovered[k][q] += A[4 * k] * tables.recovered[a][0][q] + A[4 * k + 1] * tables.recovered[a][1][q] +
                             A[4 * k + 2] * tables.recovered[a][2][q] + A[4 * k + 3] * tables.recovered[a][3][q];
    }
  }
};

/// Integral of (a - b) : D^-1 : (a - b) for unit Young's modulus; b = nullptr: zero. Shear entries are tensor
/// components.
template <int num_points>
double complementary_energy(const double (*a)[num_points], const double (*b)[num_points], const double* weights,
                            double nu) {
  double sum = 0;
  for (int q = 0; q < num_points; ++q) {
    double s[6];
    for (int k = 0; k < 6; ++k) s[k] = a[k][q] - (b ? b[k][q] : 0.0);
    const double normal = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
    const double mixed = s[0] * s[1] + s[1] * s[2] + s[2] * s[0];
    const double shear = s[3] * s[3] + s[4] * s[4] + s[5] * s[5];
    sum += weights[q] * (normal - 2 * nu * mixed + 2 * (1 + nu) * shear);
  }
  return sum;
}

/// Integrates over the cells of one body.
class Estimator {
 public:
  Estimator(const BodyMesh& mesh, const Scales& scales, const RecoveredField& recovered, const RealView& u,
            const ExactStress& exact)
      : mesh_(mesh), scales_(scales), recovered_(recovered), u_(u), exact_(exact) {}

  /// Adds one cell of a block to the sums; returns its own error.
  double add_cell(int cell, const PolynomialBlock& block, EnergySums& sums) const {
    // An edge's term lies in cells with contact.
    const bool three = mesh_.cut_cells->cut_of_active[cell] < 0 && !exact_ && !is_quadratic(cell);
    return three ? integrate<3>(cell, block, sums) : integrate<5>(cell, block, sums);
  }

 private:
  bool is_quadratic(int cell) const {
    if (!recovered_.quadratic) return false;
    for (int node : mesh_.cell_nodes[cell])
      if (recovered_.quadratic->of_node(node - mesh_.first_node)) return true;
    return false;
  }

  template <int n>
  double integrate(int cell, const PolynomialBlock& block, EnergySums& sums) const {
    static const GaussTables<n> tables;
    const CutCells& cc = *mesh_.cut_cells;
    const double nu = mesh_.poisson_ratio();
    const double volume_factor =
        std::pow(mesh_.h(cell), 3) * cc.grid.thickness_of_cell(cc.level(cell)) / 8 / mesh_.modulus;
    const int cut = cc.cut_of_active[cell];
    double weights[n * n * n], u[8][3];
    fitted_weights(cut < 0 ? full_cell_moments() : cc.moments[cut], n, weights);
    for (int q = 0; q < n * n * n; ++q)
      weights[q] *= volume_factor * cc.grid.ring(grid_position(cc, cell, Vec3(tables.xi[q].data())));
    corner_values(mesh_.cell_nodes[cell], u_, u);
    const CellStresses<n> stress(tables, mesh_, cell, u, recovered_, block);
    const double error = complementary_energy(stress.recovered, stress.raw, weights, nu);
    sums.error += error;
    sums.solution += complementary_energy<n * n * n>(stress.raw, nullptr, weights, nu);
    if (exact_) {
      double exact[6][n * n * n];
      set_exact<n>(tables, cell, exact);
      sums.exact_error += complementary_energy(exact, stress.raw, weights, nu);
      sums.recovered_error += complementary_energy(exact, stress.recovered, weights, nu);
    }
    return error;
  }

  template <int n>
  void set_exact(const GaussTables<n>& tables, int cell, double (*exact)[n * n * n]) const {
    const Grid& grid = mesh_.cut_cells->grid;
    const Mat3& R = grid.rotation;
    for (int q = 0; q < n * n * n; ++q) {
      const auto& xi = tables.xi[q];
      const Vec3 x = grid_position(*mesh_.cut_cells, cell, Vec3(xi[0], xi[1], xi[2]));
      const Sym3 s = voigt(R.transpose() * tensor(exact_(grid.to_global(x))) * R) / scales_.stress;
      for (int k = 0; k < 6; ++k) exact[k][q] = s[k];
    }
  }

  const BodyMesh& mesh_;
  const Scales& scales_;
  const RecoveredField& recovered_;
  const RealView& u_;
  const ExactStress& exact_;
};

}  // namespace

EnergySums estimate_error(const BodyMesh& mesh, const Scales& scales, const RecoveredField& recovered,
                          const RealView& u, const ExactStress& exact) {
  const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), u);
  const Estimator estimator(mesh, scales, recovered, host, exact);
  const std::size_t num_cells = mesh.cell_nodes.size();
  EnergySums sums;
  sums.error_of_cell.resize(num_cells);
  sums.solution_of_cell.resize(num_cells);
  struct Sum {
    double error, solution, exact_error, recovered_error;
  };
  std::vector<Sum> chunks(num_chunks(num_cells, grain_of_heavy));
  // Each rank integrates its own chunks, so that sums are the same on any number of ranks.
  const std::size_t first = share_out(chunks.size()).first, last = share_out(chunks.size()).second;
  for (std::size_t begin = first; begin < last; begin += chunks_per_block) {
    const std::size_t end_of_block = std::min(begin + chunks_per_block, last);
    const PolynomialBlock block(mesh, recovered, begin * grain_of_heavy,
                                std::min(num_cells, end_of_block * grain_of_heavy));
    dispatch_chunks("cgcontact::error_estimate::cells", end_of_block - begin, [&](std::size_t own) {
      const std::size_t chunk = begin + own, end = std::min(num_cells, (chunk + 1) * grain_of_heavy);
      EnergySums sum;
      for (std::size_t e = chunk * grain_of_heavy; e < end; ++e) {
        const double before = sum.solution;
        sums.error_of_cell[e] = std::max(estimator.add_cell(static_cast<int>(e), block, sum), 0.0);
        sums.solution_of_cell[e] = std::max(sum.solution - before, 0.0);
      }
      chunks[chunk] = {sum.error, sum.solution, sum.exact_error, sum.recovered_error};
    });
  }
  put_together(chunks);
  put_chunks_together(sums.error_of_cell, grain_of_heavy);
  put_chunks_together(sums.solution_of_cell, grain_of_heavy);
  for (const Sum& chunk : chunks) {
    sums.error += chunk.error;
    sums.solution += chunk.solution;
    sums.exact_error += chunk.exact_error;
    sums.recovered_error += chunk.recovered_error;
  }
  return sums;
}

}  // namespace cgcontact
