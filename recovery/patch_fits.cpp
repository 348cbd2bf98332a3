/// The fits of a patch before constraints, and the integrals they are made of.
#include <algorithm>

#include "core/parallel.hpp"
#include "recovery/patch_assembly.hpp"

namespace cgcontact {
namespace {

/// Least volume of an auxiliary patch, cells: less carries no linear polynomial of six components.
constexpr double least_auxiliary_volume = 0.25;

/// A patch carries quadratic polynomials if every term keeps this part of its square when the terms before it are taken
/// out: a plate 0.4 cells thick beside the node has 1e-3.
constexpr double least_pivot = 1e-3;

constexpr std::size_t grain = 64;

Eigen::Matrix<double, num_terms, num_terms> to_matrix(const double m[num_terms][num_terms]) {
  Eigen::Matrix<double, num_terms, num_terms> matrix;
  for (int i = 0; i < num_terms; ++i)
    for (int j = 0; j < num_terms; ++j) matrix(i, j) = m[i][j];
  return matrix;
}

void sort_unique(std::vector<int>& cells) {
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

/// Solves for the coefficients; fit.regular says whether the patch carries them.
void fit_quadratic(const BodyMesh& mesh, const QuadraticCells& near, const std::vector<int>& cells, PatchFit& fit) {
  constexpr int terms = Polynomial<2>::num_terms;
  const QuadraticSums sums =
      gather_quadratic(mesh, near, cells.data(), static_cast<int>(cells.size()), fit.centre.data());
  fit.degree = 2;
  fit.mass = sums.mass;
  const Eigen::LLT<QuadraticMass> cholesky(sums.mass);
  fit.regular = cholesky.info() == Eigen::Success;
  if (!fit.regular) return;
  const QuadraticMass& factor = cholesky.matrixLLT();
  for (int t = 0; t < terms; ++t)
    if (!(factor(t, t) * factor(t, t) > least_pivot * sums.mass(t, t))) fit.regular = false;
  fit.a.resize(6 * terms);
  for (int k = 0; k < 6; ++k) fit.a.segment<terms>(terms * k) = cholesky.solve(sums.right.row(k).transpose());
}

/// Whether the body is at least so many cells thick in all directions of its grid, seen from the fullest cell beside
/// the given one.
bool is_thick(const CutCells& cc, int cell) {
  constexpr int least = 4;
  int fullest = cell;
  const auto at = [&](const Index3& c, int i, int j, int k) { return cc.find({c[0] + i, c[1] + j, c[2] + k}); };
  for (int n = 0; n < 27; ++n) {
    const int near = at(cc.cells[cell], n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
    if (near >= 0 && cc.volume_fraction(near) > cc.volume_fraction(fullest)) fullest = near;
  }
  const Index3& c = cc.cells[fullest];
  for (int d = 0; d < 3; ++d) {
    int count = 1;
    for (const int side : {-1, 1})
      for (int s = side; count < least && at(c, d == 0 ? s : 0, d == 1 ? s : 0, d == 2 ? s : 0) >= 0; s += side)
        ++count;
    if (count < least) return false;
  }
  return true;
}

/// What the closed contact points of a cell say: there are none, or both bodies are thick at all of them, or not.
enum class Closed : char { nowhere, on_thick_bodies, on_a_thin_body };

Closed closed_at(const std::vector<RecoveryBody>& bodies, const RecoveryBody& body, int cell) {
  int seen = -1;  // cell of the other body
  for (int l : body.boundary->links_of_cell[cell]) {
    const ContactLink& link = body.boundary->links[l];
    if (!link.active || link.other_cell == seen) continue;
    if (!is_thick(*bodies[link.other_body].mesh->cut_cells, link.other_cell)) return Closed::on_a_thin_body;
    seen = link.other_cell;
  }
  if (seen < 0) return Closed::nowhere;
  return is_thick(*body.mesh->cut_cells, cell) ? Closed::on_thick_bodies : Closed::on_a_thin_body;
}

}  // namespace

AuxiliaryCells auxiliary_cells(const RecoveryBody& body, const CellStress& stress, double depth) {
  const CutCells& cc = *body.mesh->cut_cells;
  std::vector<int> touched;
  for (const ContactLink& link : body.boundary->links)
    if (link.active) touched.push_back(link.cell);
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  const int reach = static_cast<int>(std::ceil(depth)) + 2, width = 2 * reach + 1;
  std::vector<char> marked(cc.cells.size(), 0);
  for (int t : touched)
    for (int n = 0; n < width * width * width; ++n) {
      const Index3& c = cc.cells[t];
      const int near =
          cc.find({c[0] + n % width - reach, c[1] + n / width % width - reach, c[2] + n / width / width - reach});
      if (near >= 0) marked[near] = 1;
    }
  AuxiliaryCells auxiliary{Subset(marked), {}, {}};
  auxiliary.stress = CellStressView("cgcontact::recovery::auxiliary", auxiliary.cells.size());
  auxiliary.square.resize(auxiliary.cells.size());
  parallel_for(auxiliary.square.size(), grain, [&](std::size_t row) {
    const int cell = auxiliary.cells.number(static_cast<int>(row)), cut = cc.cut_of_active[cell];
    const QuadraticMass mass = quadratic_mass(quartic_moments(cut < 0 ? full_cell_moments() : cc.moments[cut]));
    const CellPolynomial polynomial = stress(cell), integrals = polynomial * mass;
    for (int k = 0; k < 6; ++k)
      for (int t = 0; t < num_terms; ++t) auxiliary.stress(row, k, t) = integrals(k, t);
    auxiliary.square[row] = integrals.cwiseProduct(polynomial).sum();
  });
  return auxiliary;
}

bool touches_contact(const RecoveryBody& body, int n) {
  const PatchSet& patches = *body.patches;
  for (int p = patches.begin[n]; p < patches.begin[n + 1]; ++p)
    if (!body.boundary->links_of_cell[patches.cells[p]].empty()) return true;
  return false;
}

std::vector<char> node_degrees(const std::vector<RecoveryBody>& bodies, std::size_t index,
                               const RecoveryDegree& degree) {
  const RecoveryBody& body = bodies[index];
  std::vector<Closed> closed(body.mesh->cell_nodes.size());
  parallel_for(closed.size(), grain,
               [&](std::size_t cell) { closed[cell] = closed_at(bodies, body, static_cast<int>(cell)); });
  const auto holds = [&](int node, Closed state) {
    const auto begin = body.patches->cells.begin();
    return std::any_of(begin + body.patches->begin[node], begin + body.patches->begin[node + 1],
                       [&](int cell) { return closed[cell] == state; });
  };
  std::vector<char> degrees(body.mesh->num_nodes, static_cast<char>(degree.interior));
  parallel_for(degrees.size(), grain, [&](std::size_t n) {
    const int node = static_cast<int>(n);
    if (touches_contact(body, node)) {
      const bool thick = holds(node, Closed::on_thick_bodies) && !holds(node, Closed::on_a_thin_body);
      degrees[n] = static_cast<char>(degree.contact > 0 ? degree.contact : thick ? 2 : 1);
    } else if (!body.patches->full[n]) {
      degrees[n] = static_cast<char>(degree.boundary);
    }
  });
  return degrees;
}

void fit_cells(const RecoveryBody& body, int n, int degree, int rings, std::vector<int>& cells) {
  const PatchSet& patches = *body.patches;
  cells.assign(patches.cells.begin() + patches.begin[n], patches.cells.begin() + patches.begin[n + 1]);
  if (degree == 1 || rings == 1) return;
  const CutCells& cc = *body.mesh->cut_cells;
  const Index3& node = body.mesh->nodes[n];
  for (int k = -rings; k < rings; ++k)
    for (int j = -rings; j < rings; ++j)
      for (int i = -rings; i < rings; ++i) {
        const int c = cc.find({node[0] + i, node[1] + j, node[2] + k});
        if (c >= 0) cells.push_back(c);
      }
  sort_unique(cells);
}

QuadraticCells quadratic_cells(const RecoveryBody& body, const std::vector<char>& degrees, const CellStress& stress,
                               const AuxiliaryCells& auxiliary, const RecoveryOptions& options) {
  const RecoveryDegree& degree = options.degree;
  if (degree.interior == 1 && degree.boundary == 1 && degree.contact == 1) return {};
  std::vector<char> marked(body.mesh->cell_nodes.size(), 0);
  std::vector<int> cells;
  for (int n = 0; n < body.mesh->num_nodes; ++n) {
    if (degrees[n] == 1) continue;
    fit_cells(body, n, 2, options.quadratic_rings, cells);
    for (int c : cells) marked[c] = 1;
  }
  for (int row = 0; row < auxiliary.cells.size() && degree.contact != 1; ++row) marked[auxiliary.cells.number(row)] = 1;
  return integrate_quadratic(*body.mesh, stress, Subset(marked));
}

double fit_variance(const BodyMesh& mesh, const AuxiliaryCells& near, const std::vector<int>& cells,
                    const PatchFit& fit) {
  constexpr double least = 1e-8;
  double square = 0, volume = 0, fitted = 0;
  for (int cell : cells) {
    const int row = near.cells.row(cell);
    if (row < 0) return 0;
    square += near.square[row];
    volume += mesh.cut_cells->volume_fraction(cell);
  }
  for (int k = 0; k < 6; ++k) {
    const auto a = fit.a.segment(fit.terms() * k, fit.terms());
    fitted += a.dot(fit.mass * a);
  }
  return std::max(square - fitted, least * square) / volume;
}

void PatchAssembly::own_fit(int n, int degree, const std::vector<int>& cells, PatchFit& fit) const {
  const Index3& node = body_.mesh->nodes[n];
  fit.centre = Vec3(node[0], node[1], node[2]);
  if (degree == 2) {
    fit_quadratic(*body_.mesh, quadratic_[index_], cells, fit);
    return;
  }
  double m[num_terms][num_terms];
  gather_mass(*body_.mesh, *body_.patches, cells.data(), static_cast<int>(cells.size()), fit.centre.data(), m);
  fit.mass = to_matrix(m);
  fit.a = Eigen::Map<const Eigen::Matrix<double, 6 * num_terms, 1>>(body_.field.at(n));
  fit.regular = cholesky(m);
}

/// Fit over whole active cells of the other body under the patch's contact points, down to the auxiliary depth
/// (equation 13); with degree 2 over two rings the cells around those as well.
void PatchAssembly::auxiliary_fit(int node, const PairState& state, int degree, std::vector<int>& cells,
                                  PatchFit& fit) const {
  const RecoveryBody& other = bodies_[state.other_body];
  const AuxiliaryCells& auxiliary = auxiliary_[state.other_body];
  const CutCells& cc = *other.mesh->cut_cells;
  const Mat3 to_other = cc.grid.rotation.transpose() * grid_.rotation;
  const PatchSet& patches = *body_.patches;
  fit.centre = Vec3::Zero();
  cells.clear();
  for (int p = patches.begin[node]; p < patches.begin[node + 1]; ++p)
    for (int l : body_.boundary->links_of_cell[patches.cells[p]]) {
      const ContactLink& link = body_.boundary->links[l];
      if (link.pair != state.pair) continue;
      fit.centre += link.weight / state.area * link.other_position;
      const Vec3 inward = to_other * link.normal;
      for (double depth : {0.05, 0.35, 0.65, 0.95}) {
        const Vec3 x = link.other_position + depth * options_.auxiliary_depth * inward;
        const int c = cc.find({static_cast<int>(std::floor(x[0])), static_cast<int>(std::floor(x[1])),
                               static_cast<int>(std::floor(x[2]))});
        if (c >= 0 && (cells.empty() || cells.back() != c) && auxiliary.cells.row(c) >= 0) cells.push_back(c);
      }
    }
  sort_unique(cells);
  if (degree == 2 && options_.quadratic_rings == 2) {
    const std::size_t under = cells.size();
    for (std::size_t i = 0; i < under; ++i)
      for (int n = 0; n < 27; ++n) {
        const Index3& at = cc.cells[cells[i]];
        const int c = cc.find({at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1});
        if (c >= 0 && auxiliary.cells.row(c) >= 0) cells.push_back(c);
      }
    sort_unique(cells);
  }
  double volume = 0;
  for (int c : cells) volume += cc.volume_fraction(c);
  if (volume < least_auxiliary_volume) return;
  if (degree == 2) {
    fit_quadratic(*other.mesh, quadratic_[state.other_body], cells, fit);
    return;
  }
  PatchSums sums = gather_patch(*other.mesh, *other.patches, cells.data(), static_cast<int>(cells.size()),
                                fit.centre.data(), auxiliary.stress, auxiliary.cells);
  fit.mass = to_matrix(sums.m);
  fit.regular = cholesky(sums.m);
  fit.a.setZero(6 * num_terms);
  for (int k = 0; k < 6 && fit.regular; ++k) {
    cholesky_solve(sums.m, sums.H[k]);
    for (int t = 0; t < num_terms; ++t) fit.a[num_terms * k + t] = sums.H[k][t];
  }
}

}  // namespace cgcontact
