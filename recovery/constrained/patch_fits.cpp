/// The fits of a patch before constraints, and the integrals they are made of.
#include <algorithm>

#include "core/cells/cells_around.hpp"
#include "recovery/constrained/patch_assembly.hpp"
#include "recovery/patch/cells_in_box.hpp"

namespace cgcontact {
namespace {

/// Least part of its diagonal entry that a pivot of the mass matrix of a linear polynomial must keep.
constexpr double least_linear_pivot = 1e-14;

/// A patch carries quadratic polynomials if every term keeps this part of its square when the terms before it are taken
/// out: a plate 0.4 cells thick beside the node has 1e-3.
constexpr double least_pivot = 1e-3;

void sort_unique(std::vector<int>& cells) {
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

/// Part of the square of a stress that rounding may leave of a good fit.
constexpr double least_misfit = 1e-8;

/// Solves for the coefficients about fit.centre; fit.regular says whether the cells carry them.
template <int degree>
void fit_polynomial(const CellSums& sums, PatchFit& fit) {
  constexpr int terms = Polynomial<degree>::num_terms;
  constexpr double least = degree == 1 ? least_linear_pivot : least_pivot;
  using Mass = Eigen::Matrix<double, terms, terms>;
  const Mass mass = quadratic_mass(sums.moments).topLeftCorner<terms, terms>();
  fit.degree = degree;
  fit.mass = mass;
  const Eigen::LLT<Mass> cholesky(mass);
  fit.regular = cholesky.info() == Eigen::Success;
  if (!fit.regular) return;
  const Mass& factor = cholesky.matrixLLT();
  for (int t = 0; t < terms; ++t)
    if (!(factor(t, t) * factor(t, t) > least * mass(t, t))) fit.regular = false;
  const Eigen::Map<const Eigen::Matrix<double, CellSums::num_components, CellSums::num_stress>> stress(sums.stress[0]);
  const Eigen::Matrix<double, terms, 6> right = stress.topLeftCorner<6, terms>().transpose();
  fit.a.resize(6 * terms);
  Eigen::Map<Eigen::Matrix<double, terms, 6>> a(fit.a.data());
  a = cholesky.solve(right);
  fit.variance = std::max(sums.square - a.cwiseProduct(right).sum(), least_misfit * sums.square) / sums.moments[0];
}

/// Adds the cells at most `reach` cells away from any of the given ones along every axis, those with integrals.
void add_rings(const StressIntegrals& integrals, const CutCells& cc, int reach, std::vector<char>& box,
               std::vector<int>& cells) {
  if (cells.empty()) return;
  if (!cc.parts.empty()) {
    const std::vector<int> inner = cells;
    for (int c : inner) {
      const Vec3 low = cc.corner(c), width = Vec3::Constant(reach * cc.size(c));
      each_cell_within(cc, low - width, low + Vec3::Constant(cc.size(c)) + width, [&](int cell) {
        if (integrals.hold(cell)) cells.push_back(cell);
      });
    }
    sort_unique(cells);
    return;
  }
  Index3 low = cc.cells[cells.front()], size;
  Index3 high = low;
  for (int c : cells)
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], cc.cells[c][d]);
      high[d] = std::max(high[d], cc.cells[c][d]);
    }
  for (int d = 0; d < 3; ++d) low[d] -= reach, size[d] = high[d] + reach + 1 - low[d];
  box.assign(static_cast<std::size_t>(size[0]) * size[1] * size[2], 0);
  for (int c : cells) {
    const Index3& at = cc.cells[c];
    for (int k = at[2] - low[2] - reach; k <= at[2] - low[2] + reach; ++k)
      for (int j = at[1] - low[1] - reach; j <= at[1] - low[1] + reach; ++j) {
        const auto row = box.begin() + (static_cast<std::ptrdiff_t>(k) * size[1] + j) * size[0] + at[0] - low[0];
        std::fill(row - reach, row + reach + 1, char{1});
      }
  }
  cells.clear();
  std::size_t n = 0;
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i, ++n) {
        if (!box[n]) continue;
        const int c = cc.find({low[0] + i, low[1] + j, low[2] + k});
        if (c >= 0 && integrals.hold(c)) cells.push_back(c);
      }
}

}  // namespace

void fit_cells(const RecoveryBody& body, int n, PatchPolynomial polynomial, std::vector<int>& cells) {
  const PatchSet& patches = *body.patches;
  const auto first = patches.cells.begin() + patches.begin[n], last = patches.cells.begin() + patches.begin[n + 1];
  const int rings = polynomial.rings;
  cells.clear();
  if (rings > 1) {
    const CutCells& cc = *body.mesh->cut_cells;
    if (!cc.parts.empty()) {
      const Vec3 centre = body.mesh->node_position(n), width = Vec3::Constant(rings * unit_of(*body.mesh, n));
      each_cell_within(cc, centre - width, centre + width, [&](int cell) { cells.push_back(cell); });
      cells.insert(cells.end(), first, last);
      return sort_unique(cells);
    }
    const Index3& node = body.mesh->nodes[n];
    for (int k = -rings; k < rings; ++k)
      for (int j = -rings; j < rings; ++j)
        for (int i = -rings; i < rings; ++i) {
          const int c = cc.find({node[0] + i, node[1] + j, node[2] + k});
          if (c >= 0) cells.push_back(c);
        }
  }
  if (rings > 1 && !patches.grown[n]) return;  // the patch is inside
  cells.insert(cells.end(), first, last);
  sort_unique(cells);
}

StressIntegrals integrate_stress(const RecoveryBody& body, const std::vector<PatchPolynomial>& polynomials,
                                 const CellStress& stress, const RecoveryOptions& options) {
  const CutCells& cc = *body.mesh->cut_cells;
  std::vector<int> closed;
  for (const ContactLink& link : body.boundary->links)
    if (link.active && (closed.empty() || closed.back() != link.cell)) closed.push_back(link.cell);
  std::vector<char> marked(cc.cells.size(), 0);
  std::vector<int> cells;
  int rings = 2;
  for (int n = 0; n < body.mesh->num_nodes; ++n) {
    if (polynomials[n].degree == 1) continue;
    rings = std::max<int>(rings, polynomials[n].rings);
    fit_cells(body, n, polynomials[n], cells);
    for (int c : cells) marked[c] = 1;
  }
  mark_cells_around(cc, closed, static_cast<int>(std::ceil(options.auxiliary_depth)) + rings, marked);
  return integrate_stress(*body.mesh, stress, Subset(marked));
}

double fit_variance(const BodyMesh& mesh, const StressIntegrals& integrals, const std::vector<int>& cells,
                    const PatchFit& fit) {
  double square = 0, volume = 0, fitted = 0;
  for (int cell : cells) {
    if (!integrals.hold(cell)) return 0;
    square += integrals.square[integrals.cells.row(cell)];
    volume += mesh.cut_cells->volume_fraction(cell);
  }
  for (int k = 0; k < 6; ++k) {
    const auto a = fit.a.segment(fit.terms() * k, fit.terms());
    fitted += a.dot(fit.mass * a);
  }
  return std::max(square - fitted, least_misfit * square) / volume;
}

void PatchAssembly::own_fit(int n, int degree, const std::vector<int>& cells, PatchFit& fit) const {
  fit.centre = body_.mesh->node_position(n);
  fit.unit = unit_of(*body_.mesh, n);
  if (degree == 2) {
    fit_polynomial<2>(sum_cells(*body_.mesh, integrals_[index_], cells.data(), static_cast<int>(cells.size()),
                                fit.centre.data(), fit.unit),
                      fit);
    return;
  }
  double m[num_terms][num_terms];
  const Vec3 centre = fit.centre / fit.unit;
  gather_mass(arrays_, cells.data(), static_cast<int>(cells.size()), centre.data(), m, level_of(*body_.mesh, n));
  fit.mass = Eigen::Map<const Eigen::Matrix<double, num_terms, num_terms>>(m[0]);
  fit.a = Eigen::Map<const Eigen::Matrix<double, 6 * num_terms, 1>>(body_.field.at(n));
  fit.regular = cholesky(m);
}

/// Fit over whole active cells of the other body under the patch's contact points, down to the auxiliary depth
/// (equation 13); with degree 2 over more than one ring the cells around those as well.
void PatchAssembly::auxiliary_fit(int node, const PairState& state, PatchPolynomial polynomial,
                                  PatchWorkspace& workspace, PatchFit& fit) const {
  const RecoveryBody& other = bodies_[state.other_body];
  const StressIntegrals& integrals = integrals_[state.other_body];
  const CutCells& cc = *other.mesh->cut_cells;
  const PatchSet& patches = *body_.patches;
  std::vector<int>& cells = workspace.auxiliary;
  fit.centre = Vec3::Zero();
  cells.clear();
  const int begin = patches.begin[node];
  contact_.each(&patches.cells[begin], patches.begin[node + 1] - begin, state.pair, [&](const ContactPiece& piece) {
    fit.centre += piece.other_position / state.area;
    const ListPart<int> under = contact_.under(piece);
    cells.insert(cells.end(), under.begin(), under.end());
  });
  sort_unique(cells);
  if (polynomial.rings > 1) add_rings(integrals, cc, polynomial.rings - 1, workspace.box, cells);
  double volume = 0, largest = 0;
  for (int c : cells) {
    volume += cc.volume_fraction(c);
    largest = std::max(largest, cc.size(c));
  }
  if (volume < options_.least_auxiliary_volume) return;
  fit.unit = largest;
  const CellSums sums =
      sum_cells(*other.mesh, integrals, cells.data(), static_cast<int>(cells.size()), fit.centre.data(), fit.unit);
  if (polynomial.degree == 1)
    fit_polynomial<1>(sums, fit);
  else
    fit_polynomial<2>(sums, fit);
}

}  // namespace cgcontact
