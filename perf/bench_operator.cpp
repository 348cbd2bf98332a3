/// The matrix-free operator, in double and in single precision: the whole of it and its terms, and Tpetra's CrsMatrix
/// with the same matrix, in the same run where it fits (`times_crs`: its time over the operator's).
///   cube     no cell cut: stencil nodes, and full cells at the faces; sizes are cells along an edge
///   ball     about 20 % of the cells cut at 46 cells across
///   contact  the groups of scenes/two_solids_3d.toml; sizes are n of the scene
///   tree     a block refined to 6 levels, in turns with the block of as many unknowns on a uniform grid (`of_uniform`:
///            the rate per unknown over the uniform grid's); sizes are cells along an edge of the latter
///   rings    half a ball as a body of revolution, refined to 6 levels, in turns with the same cells in plane strain
///            (`of_plane_strain`: the rate per unknown over theirs); sizes are coarsest cells along the radius
/// All results are compared with the plain kernels'.
///
/// Bytes: every vector entry once (x read; y written, which counts twice), and what is stored of cells and faces. The
/// terms of cut cells and ghost faces add to y: it is read and written at the nodes they touch.
#include <Tpetra_Core.hpp>
#include <array>
#include <memory>

#include "kernels/assembled/assembly.hpp"
#include "kernels/operator/fast_operator.hpp"
#include "kernels/reference/plain_matrix.hpp"
#include "kernels/reference/plain_operator.hpp"
#include "perf/harness.hpp"
#include "perf/problems.hpp"

namespace {

using namespace cgcontact;
using namespace cgcontact::perf;

/// Beyond this the assembled matrix (1 kB per unknown, three times as much while it is made) is left out.
constexpr int max_assembled = 1200000;

enum class Shape { cube, ball };
enum class Term { all, interior, cut, ghost };

/// A cube of full cells (make_cut_cells would call those at the faces cut).
CutCells whole_cells(int n) {
  CutCells cc;
  cc.grid.num_cells = {n, n, n};
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) cc.cells.push_back({i, j, k});
  cc.numbers = GridNumbers(cc.grid.num_cells, cc.cells);
  cc.cut_of_active.assign(cc.cells.size(), -1);
  return cc;
}

CutCells ball_cells(int n) {
  Grid grid;
  grid.num_cells = {n + 1, n + 1, n + 1};
  const Vec3 centre = Vec3(0.414, 0.732, 0.236) + Vec3::Constant(0.5 * n);
  return make_cut_cells(Solid::sphere(centre, 0.5 * n, "ball"), grid);
}

struct Body {
  CutCells cut_cells;
  ElasticSystem system;
  Body(Shape shape, int n) : cut_cells(shape == Shape::cube ? whole_cells(n) : ball_cells(n)) {
    system = make_elastic_system({&cut_cells}, {Material{1, 0.3}}, Scales{1, 1}, 0.01);
  }
  double cut_share() const {
    return static_cast<double>(cut_cells.moments.size()) / static_cast<double>(cut_cells.cells.size());
  }
};

template <class Real>
using RealVector = Kokkos::View<Real*, MemSpace>;

/// The same numbers in another precision.
template <class Real, class From>
RealVector<Real> copy(const From& x) {
  const RealVector<Real> y("cgcontact::perf::x", x.extent(0));
  for (std::size_t i = 0; i < x.extent(0); ++i) y(i) = static_cast<Real>(x(i));
  return y;
}

RealView single_precision_vector(int size) {
  const RealView x = random_vector(size, 1);
  for (int i = 0; i < size; ++i) x(i) = static_cast<float>(x(i));
  return x;
}

/// Assembled matrix and its product.
struct Assembled {
  Teuchos::RCP<const TpetraMap> map;
  Teuchos::RCP<TpetraMatrix> matrix;
  TpetraVector x, y;
  explicit Assembled(const ElasticSystem& system)
      : map(system.dofs.vector_map(Tpetra::getDefaultComm())),
        matrix(assemble_matrix(system, map)),
        x(map, 1),
        y(map, 1) {
    auto host = x.getLocalViewHost(Tpetra::Access::OverwriteAll);
    const RealView values = single_precision_vector(system.num_dofs());
    for (std::size_t i = 0; i < values.extent(0); ++i) host(i, 0) = values(i);
  }
  void apply() { matrix->apply(x, y); }
  double entries() const { return static_cast<double>(matrix->getGlobalNumEntries()); }
};

/// Nodes of cut cells, nodes of ghost faces.
std::array<double, 2> touched_nodes(const ElasticSystem& system) {
  std::array<double, 2> count{};
  for (const BodyMesh& mesh : system.meshes) {
    std::vector<char> by_cells(mesh.num_nodes, 0), by_faces(mesh.num_nodes, 0);
    for (std::size_t e = 0; e < mesh.cell_nodes.size(); ++e)
      if (mesh.cut_cells->cut_of_active[e] >= 0)
        for (int node : mesh.cell_nodes[e]) by_cells[node - mesh.first_node] = 1;
    const FaceNodesView faces = colour_mesh(mesh).nodes_of_face;
    for (std::size_t i = 0; i < faces.size(); ++i) by_faces[faces.data()[i] - mesh.first_node] = 1;
    for (char touched : by_cells) count[0] += touched;
    for (char touched : by_faces) count[1] += touched;
  }
  return count;
}

/// flop per stencil node: 108 (27 x 9 multiply-adds unfactorised would be 486). Per cut cell 780: modes and corners
/// 144, products with the moments 441, taking back the full cell 171, sums 24; per full cell at the rim 243. Per ghost
/// face 156 and 96 per chain's two last layers. Bytes: a cut cell 27 moments, 4 node numbers, lanes; a full one the
/// latter; a chain 16 and two node numbers per layer; a run of stencil nodes little.
template <class Real>
Cost term_cost(const ElasticSystem& system, const FastOperator<Real>& op, Term term) {
  const auto& s = op.sizes();
  const double real = sizeof(Real), nodes = static_cast<double>(s.num_nodes);
  const auto number = [](long long n) { return static_cast<double>(n); };
  const std::array<double, 2> touched =
      term == Term::cut || term == Term::ghost ? touched_nodes(system) : std::array<double, 2>{};
  Cost interior{108 * number(s.stencil_nodes), 0}, vectors{0, 9 * real * nodes};
  Cost cells{780 * number(s.cut_cells) + 243 * number(s.full_cells),
             number(s.cut_cells) * 27 * real + (number(s.cut_cells) + number(s.full_cells)) * 24};
  Cost ghosts{156 * number(s.ghost_faces) + 96 * number(s.ghost_chains),
              8 * number(s.ghost_faces) + 32 * number(s.ghost_chains)};
  Cost cost;
  if (term == Term::all) cost = {interior.flop + cells.flop + ghosts.flop, vectors.bytes + cells.bytes + ghosts.bytes};
  if (term == Term::interior) cost = {interior.flop, vectors.bytes};
  if (term == Term::cut) cost = {cells.flop, cells.bytes + 9 * real * touched[0]};
  if (term == Term::ghost) cost = {ghosts.flop, ghosts.bytes + 9 * real * touched[1]};
  cost.single = sizeof(Real) == 4;
  return cost;
}

/// Largest difference of a term from the plain kernels. The stencil gives the cells' share at nodes of full cells only;
/// elsewhere the cut cells complete it (or take back), so that both together are the plain sum over all cells.
template <class Real>
double term_error(const ElasticSystem& system, const FastOperator<Real>& op, Term term, const RealView& xd,
                  const RealVector<Real>& x) {
  const BodyMesh& mesh = system.meshes[0];
  const RealView plain("cgcontact::perf::plain", xd.extent(0));
  const RealVector<Real> y("cgcontact::perf::y", xd.extent(0));
  std::vector<char> compared(mesh.num_nodes, 1);
  const ExecSpace exec;
  if (term == Term::all) {
    op.apply(exec, x, y);
    PlainOperator(system).apply(exec, xd, plain);
  } else if (term == Term::ghost) {
    op.add_band(exec, x, y, false, true);
    apply_ghost_faces(exec, colour_mesh(mesh), make_ghost_matrix(mesh, system.ghost_penalty), xd, plain);
  } else {
    op.apply_stencil(exec, x, y);
    if (term == Term::cut) op.add_band(exec, x, y, true, false);
    apply_cells(exec, colour_mesh(mesh), make_cell_matrices(mesh, {}), xd, plain);
    if (term == Term::interior) {
      std::vector<int> full_cells(mesh.num_nodes, 0);
      for (std::size_t e = 0; e < mesh.cell_nodes.size(); ++e)
        if (mesh.cut_cells->cut_of_active[e] < 0)
          for (int node : mesh.cell_nodes[e]) ++full_cells[node];
      for (int n = 0; n < mesh.num_nodes; ++n) compared[n] = full_cells[n] == 8;
    }
  }
  exec.fence();
  double difference = 0, scale = 0;
  for (std::size_t i = 0; i < plain.extent(0); ++i) {
    if (!compared[node_of_dof(i)]) continue;
    difference = std::max(difference, std::abs(y(i) - plain(i)));
    scale = std::max(scale, std::abs(plain(i)));
  }
  return difference / scale;
}

template <class Real>
Kernel operator_kernel(Shape shape, int n, Term term) {
  auto body = std::make_shared<Body>(shape, n);
  auto op = std::make_shared<FastOperator<Real>>(body->system);
  const int num_dofs = body->system.num_dofs();
  const RealView xd = single_precision_vector(num_dofs);
  const auto x = copy<Real>(xd);
  const RealVector<Real> y("cgcontact::perf::y", num_dofs);
  Kernel k;
  k.items = num_dofs;
  k.cost = term_cost(body->system, *op, term);
  k.error = term_error(body->system, *op, term, xd, x), k.tolerance = sizeof(Real) == 8 ? 1e-12 : 1e-5;
  k.against = "the plain kernels";
  k.run = [op, x, y, term] {
    const ExecSpace exec;
    if (term == Term::all) op->apply(exec, x, y);
    if (term == Term::interior) op->apply_stencil(exec, x, y);
    if (term == Term::cut) op->add_band(exec, x, y, true, false);
    if (term == Term::ghost) op->add_band(exec, x, y, false, true);
  };
  k.figures = {{"cut_share", body->cut_share()}, {"B/DoF", static_cast<double>(op->sizes().bytes) / num_dofs}};
  if (term == Term::all && num_dofs < max_assembled) {
    auto assembled = std::make_shared<Assembled>(body->system);
    k.baseline = [assembled] { assembled->apply(); };
    k.ratio = "times_crs";
  }
  return k;
}

/// 12 bytes and 2 flop per entry; the rows' beginnings, x and y.
Kernel crs(Shape shape, int n) {
  const Body body(shape, n);
  auto assembled = std::make_shared<Assembled>(body.system);
  const int num_dofs = body.system.num_dofs();
  const RealView x = single_precision_vector(num_dofs), plain("cgcontact::perf::plain", num_dofs);
  PlainOperator(body.system).apply(ExecSpace(), x, plain);
  assembled->apply();
  Kokkos::fence();
  Kernel k;
  {
    const auto y = assembled->y.getLocalViewHost(Tpetra::Access::ReadOnly);
    const RealView result("cgcontact::perf::result", num_dofs);
    for (int i = 0; i < num_dofs; ++i) result(i) = y(i, 0);
    k.error = relative_difference(result, plain), k.tolerance = 1e-12, k.against = "the plain kernels";
  }
  k.items = num_dofs;
  k.cost = {2 * assembled->entries(), 12 * assembled->entries() + 32.0 * num_dofs};
  k.run = [assembled] { assembled->apply(); };
  k.figures = {{"cut_share", body.cut_share()}, {"B/DoF", 12 * assembled->entries() / num_dofs}};
  return k;
}

/// The way from the system to the matrix, against the plain reference, entry by entry on one thread. Per cell, 24 x 24
/// sums and the cell's nodes (its matrix once if it is cut); per ghost face 12 x 12 x 3; 12 bytes per entry are
/// written.
Kernel assembly(Shape shape, int n) {
  auto body = std::make_shared<Body>(shape, n);
  auto map = body->system.dofs.vector_map(Tpetra::getDefaultComm());
  Kernel k;
  k.items = body->system.num_dofs();
  {
    const auto matrix = assemble_matrix(body->system, map);
    const auto local = matrix->getLocalMatrixHost();
    BlockMatrix plain = plain_matrix(body->system);
    double largest = 0;
    if (local.nnz() != plain.value.size()) throw std::logic_error("the matrices have different graphs");
    for (int row = 0; row < local.numRows(); ++row)
      for (auto e = local.graph.row_map(row); e < local.graph.row_map(row + 1); ++e) {
        const int column = local.graph.entries(e);
        const double value = plain.block(row / 3, column / 3)[3 * (row % 3) + column % 3];
        k.error = std::max(k.error, std::abs(local.values(e) - value));
        largest = std::max(largest, std::abs(value));
      }
    k.error /= largest, k.tolerance = 1e-14, k.against = "the plain reference";
    const double cells = static_cast<double>(body->cut_cells.cells.size()),
                 cut = static_cast<double>(body->cut_cells.moments.size()),
                 faces = static_cast<double>(colour_mesh(body->system.meshes[0]).nodes_of_face.extent(0)),
                 entries = static_cast<double>(local.nnz());
    k.cost = {576 * cells + 864 * faces, 32 * cells + 4608 * cut + 56 * faces + 24 * entries};
    k.figures = {{"cut_share", body->cut_share()}, {"entries", entries}};
  }
  k.run = [body, map] { benchmark::DoNotOptimize(assemble_matrix(body->system, map).get()); };
  k.baseline = [body] { benchmark::DoNotOptimize(plain_matrix(body->system).value.data()); };
  return k;
}

/// Construction from the system; the operator made is compared.
template <class Real>
Kernel setup(int n) {
  auto body = std::make_shared<Body>(Shape::ball, n);
  const RealView x = single_precision_vector(body->system.num_dofs());
  Kernel k;
  k.items = body->system.num_dofs();
  k.error = term_error(body->system, FastOperator<Real>(body->system), Term::all, x, copy<Real>(x));
  k.tolerance = sizeof(Real) == 8 ? 1e-12 : 1e-5, k.against = "the plain kernels";
  k.run = [body] { benchmark::DoNotOptimize(FastOperator<Real>(body->system).num_dofs()); };
  return k;
}

constexpr int tree_levels = 6;

/// A problem with all that one application of its operator needs.
template <class Real, class Problem>
struct Applied {
  Problem problem;
  FastOperator<Real> op;
  RealView xd;
  RealVector<Real> x, y;
  template <class Kind>
  Applied(int size, Kind kind)
      : problem(size, kind),
        op(problem.system),
        xd(single_precision_vector(problem.system.num_dofs())),
        y("cgcontact::perf::y", xd.extent(0)) {
    apply_constraints(ExecSpace(), problem.system.dofs, xd);
    x = copy<Real>(xd);
  }
  void apply() const { op.apply(ExecSpace(), x, y); }
  double error() const { return term_error(problem.system, op, Term::all, xd, x); }
  double cut_share() const {
    const CutCells& cc = problem.cut_cells;
    return static_cast<double>(cc.moments.size()) / static_cast<double>(cc.cells.size());
  }
  double bytes_per_unknown() const { return static_cast<double>(op.sizes().bytes) / problem.system.num_free_dofs(); }
};

/// Applies one problem and, in turns, another one.
template <class Real, class Problem, class Run>
Kernel one_against_other(std::shared_ptr<Applied<Real, Problem>> one, std::shared_ptr<Applied<Real, Problem>> other,
                         const Run& run) {
  Kernel k;
  k.items = one->problem.system.num_free_dofs(), k.baseline_items = other->problem.system.num_free_dofs();
  k.error = std::max(one->error(), other->error()), k.tolerance = sizeof(Real) == 8 ? 1e-12 : 1e-5;
  k.against = "the plain kernels";
  k.run = [one, run] { run(*one); };
  k.baseline = [other, run] { run(*other); };
  const ElasticSystem& system = one->problem.system;
  k.figures = {{"cut_share", one->cut_share()},
               {"constrained", static_cast<double>(system.constraints.size()) / system.num_nodes},
               {"B/DoF", one->bytes_per_unknown()}};
  return k;
}

template <class Real>
using BlockOperator = Applied<Real, BlockProblem>;

template <class Real, class Run>
Kernel tree_against_uniform(int n, const Run& run) {
  auto tree = std::make_shared<BlockOperator<Real>>(n, tree_levels),
       uniform = std::make_shared<BlockOperator<Real>>(n, 1);
  Kernel k = one_against_other(tree, uniform, run);
  k.ratio = "of_uniform";
  k.figures.insert(k.figures.end(), {{"uniform_DoF", k.baseline_items},
                                     {"uniform_cut_share", uniform->cut_share()},
                                     {"uniform_B/DoF", uniform->bytes_per_unknown()}});
  return k;
}

template <class Real>
Kernel tree(int n) {
  return tree_against_uniform<Real>(n, [](const BlockOperator<Real>& b) { b.apply(); });
}

template <class Real>
Kernel tree_setup(int n) {
  return tree_against_uniform<Real>(n, [](const BlockOperator<Real>& b) {
    benchmark::DoNotOptimize(FastOperator<Real>(b.problem.system).num_dofs());
  });
}

template <class Real>
Kernel rings(int n) {
  using Disc = Applied<Real, DiscProblem>;
  Kernel k = one_against_other(std::make_shared<Disc>(n, true), std::make_shared<Disc>(n, false),
                               [](const Disc& disc) { disc.apply(); });
  k.ratio = "of_plane_strain";
  return k;
}

/// Per entry of the rows two multiply-adds (gap and force), number and value in both directions; y is read and written.
template <class Real>
Kernel groups(int n) {
  auto p =
      std::make_shared<SceneProblem>("scenes/two_solids_3d.toml", std::vector<std::string>{"n=" + std::to_string(n)});
  auto op = std::make_shared<FastOperator<Real>>(p->system);
  const int num_dofs = p->system.num_dofs();
  const RealView xd = single_precision_vector(num_dofs), plain("cgcontact::perf::plain", num_dofs);
  const auto x = copy<Real>(xd);
  const RealVector<Real> y("cgcontact::perf::y", num_dofs);
  op->add_groups(ExecSpace(), x, y);
  apply_groups(ExecSpace(), p->system.groups, xd, plain);
  Kokkos::fence();
  const double entries = static_cast<double>(op->sizes().group_entries), real = sizeof(Real);
  Kernel k;
  k.error = relative_difference(copy<double>(y), plain);
  k.tolerance = sizeof(Real) == 8 ? 1e-12 : 1e-5, k.against = "the plain kernels";
  k.items = static_cast<double>(p->system.groups.dof_list.extent(0));
  k.cost = {4 * entries, 2 * entries * (4 + real) + 3 * real * k.items, real == 4};
  k.run = [op, x, y] { op->add_groups(ExecSpace(), x, y); };
  k.figures = {{"groups", static_cast<double>(op->sizes().groups)}};
  return k;
}

template <class Real>
void add_all(const std::string& precision) {
  const auto term = [](Shape shape, Term p) { return [=](int n) { return operator_kernel<Real>(shape, n, p); }; };
  add("operator/cube_" + precision, term(Shape::cube, Term::all), {{6}, {36, 60, 118}});
  add("operator/ball_" + precision, term(Shape::ball, Term::all), {{6}, {46}});
  add("operator/interior_" + precision, term(Shape::ball, Term::interior), {{6}, {46}});
  add("operator/cut_" + precision, term(Shape::ball, Term::cut), {{6}, {46}});
  add("operator/ghost_" + precision, term(Shape::ball, Term::ghost), {{6}, {46}});
  add("operator/contact_" + precision, groups<Real>, {{5}, {32}});
  add("operator/setup_" + precision, setup<Real>, {{6}, {46}});
  add("operator/tree_" + precision, tree<Real>, {{6}, {68}});
  add("operator/tree_setup_" + precision, tree_setup<Real>, {{6}, {68}});
  add("operator/rings_" + precision, rings<Real>, {{6}, {150}});
}

}  // namespace

int main(int argc, char** argv) {
  return run_benchmarks(argc, argv, [] {
    add_all<double>("double");
    add_all<float>("float");
    add("assembly/cube", [](int n) { return assembly(Shape::cube, n); }, {{6}, {36}});
    add("assembly/ball", [](int n) { return assembly(Shape::ball, n); }, {{6}, {46}});
    add("crs/cube", [](int n) { return crs(Shape::cube, n); }, {{6}, {36, 60}});
    add("crs/ball", [](int n) { return crs(Shape::ball, n); }, {{6}, {46}});
  });
}
