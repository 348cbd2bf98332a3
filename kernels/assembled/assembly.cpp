#include "kernels/assembled/assembly.hpp"

#include <TpetraExt_MatrixMatrix.hpp>
#include <TpetraExt_TripleMatrixMultiply.hpp>

#include "kernels/mesh/host_copy.hpp"
#include "kernels/operator/element_matrices.hpp"
#include "kernels/reference/coloured_mesh.hpp"

namespace cgcontact {
namespace {

using LocalMatrix = TpetraMatrix::local_matrix_device_type;
using SizeView = Kokkos::View<std::size_t*, MemSpace>;
using GhostMatrixView = Kokkos::View<double[12][12], Kokkos::LayoutRight, MemSpace>;
using Policy = Kokkos::RangePolicy<ExecSpace>;

/// Turns counts in list(0 .. n - 1) into offsets: list(i) = sum of the counts before i, list(n) = the sum of all.
void counts_to_offsets(const ExecSpace& exec, const char* label, const SizeView& list) {
  Kokkos::parallel_scan(
      label, Policy(exec, 0, list.extent(0)), KOKKOS_LAMBDA(const int i, std::size_t& sum, const bool is_final) {
        const std::size_t count = list(i);
        if (is_final) list(i) = sum;
        sum += count;
      });
}

std::size_t last_of(const SizeView& list) {
  std::size_t last = 0;
  Kokkos::deep_copy(last, Kokkos::subview(list, list.extent(0) - 1));
  return last;
}

/// Numbers of the items (cells, faces) around each node of a body, ascending.
struct ItemsOfNodes {
  SizeView begin;  ///< node of the body -> first, and the end
  IntView items;
};

/// nodes: (item, node number).
template <class Nodes>
ItemsOfNodes items_of_nodes(const ExecSpace& exec, const Nodes& nodes, int first_node, int num_nodes) {
  const SizeView begin("cgcontact::assembly::items_begin", num_nodes + 1);
  const int corners = static_cast<int>(nodes.extent(1)), size = static_cast<int>(nodes.extent(0));
  Kokkos::parallel_for(
      "cgcontact::assembly::count_items", Policy(exec, 0, size), KOKKOS_LAMBDA(const int item) {
        for (int a = 0; a < corners; ++a) Kokkos::atomic_fetch_add(&begin(nodes(item, a) - first_node), std::size_t(1));
      });
  counts_to_offsets(exec, "cgcontact::assembly::place_items", begin);
  const SizeView next("cgcontact::assembly::next_item", num_nodes + 1);
  Kokkos::deep_copy(exec, next, begin);
  const IntView items(Kokkos::view_alloc(Kokkos::WithoutInitializing, "cgcontact::assembly::items"),
                      static_cast<std::size_t>(size) * corners);
  Kokkos::parallel_for(
      "cgcontact::assembly::list_items", Policy(exec, 0, size), KOKKOS_LAMBDA(const int item) {
        for (int a = 0; a < corners; ++a)
          items(Kokkos::atomic_fetch_add(&next(nodes(item, a) - first_node), std::size_t(1))) = item;
      });
  Kokkos::parallel_for(
      "cgcontact::assembly::sort_items", Policy(exec, 0, num_nodes), KOKKOS_LAMBDA(const int n) {
        for (std::size_t i = begin(n); i < begin(n + 1); ++i) {
          const int item = items(i);
          std::size_t k = i;
          for (; k > begin(n) && items(k - 1) > item; --k) items(k) = items(k - 1);
          items(k) = item;
        }
      });
  return {begin, items};
}

/// Rows that one body adds to.
struct BodyConnectivity {
  int first_node = 0, num_nodes = 0;
  CellNodesView nodes_of_cell;  ///< in the order of the cells
  IntView matrix_of_cell;
  FaceNodesView nodes_of_face;
  RealView ring_of_face;
  ItemsOfNodes cells, faces;
};

BodyConnectivity connectivity_of(const ExecSpace& exec, const BodyMesh& mesh) {
  BodyConnectivity result;
  result.first_node = mesh.first_node;
  result.num_nodes = mesh.num_nodes;
  result.nodes_of_cell = copy_rows_to_view<CellNodesView>("cgcontact::assembly::nodes_of_cell", mesh.cell_nodes);
  result.matrix_of_cell = copy_to_view<IntView>("cgcontact::assembly::matrix_of_cell", mesh.cut_cells->cut_of_active);
  const ColouredMesh coloured = colour_mesh(mesh);
  result.nodes_of_face = coloured.nodes_of_face;
  result.ring_of_face = coloured.ring_of_face;
  result.cells = items_of_nodes(exec, result.nodes_of_cell, mesh.first_node, mesh.num_nodes);
  result.faces = items_of_nodes(exec, result.nodes_of_face, mesh.first_node, mesh.num_nodes);
  return result;
}

/// Returns the index of a DoF among those that the contact groups touch, or -1.
KOKKOS_INLINE_FUNCTION int touched_dof(const IntView& dof_list, int dof) {
  int low = 0, high = static_cast<int>(dof_list.extent(0));
  while (low < high) {
    const int middle = (low + high) / 2;
    if (dof_list(middle) < dof)
      low = middle + 1;
    else
      high = middle;
  }
  return low < static_cast<int>(dof_list.extent(0)) && dof_list(low) == dof ? low : -1;
}

/// Use of the groups' entries that share a group with a DoF: use(entry of `groups.row_dof`, entry of the transpose).
template <class Use>
KOKKOS_INLINE_FUNCTION void each_partner(const GroupRows& groups, int dof, const Use& use) {
  const int touched = touched_dof(groups.dof_list, dof);
  if (touched < 0) return;
  for (int k = groups.dof_begin(touched); k < groups.dof_begin(touched + 1); ++k) {
    const int g = groups.column_group(k);
    for (int e = groups.row_begin(g); e < groups.row_begin(g + 1); ++e) use(e, k);
  }
}

/// Columns (nodes) of the rows of each node, ascending.
struct NodeGraph {
  SizeView begin;  ///< node -> first, and the end
  IntView column;

  /// Returns the index of a column that is there.
  KOKKOS_INLINE_FUNCTION std::size_t find(int node, int col) const {
    std::size_t low = begin(node), high = begin(node + 1);
    while (low + 1 < high) {
      const std::size_t middle = (low + high) / 2;
      if (column(middle) <= col)
        low = middle;
      else
        high = middle;
    }
    return low;
  }
};

/// Puts a number into an ascending list unless it is there; returns the new length.
KOKKOS_INLINE_FUNCTION int insert(int* list, int length, int number) {
  int k = length;
  while (k > 0 && list[k - 1] > number) --k;
  if (k > 0 && list[k - 1] == number) return length;
  for (int i = length; i > k; --i) list[i] = list[i - 1];
  list[k] = number;
  return length + 1;
}

NodeGraph make_graph(const ExecSpace& exec, const std::vector<BodyConnectivity>& bodies, const GroupRows& groups,
                     int num_nodes) {
  // Room for all that may come, each node's columns in a range of their own.
  const SizeView room("cgcontact::assembly::room", num_nodes + 1), begin("cgcontact::assembly::begin", num_nodes + 1);
  for (const BodyConnectivity& body : bodies) {
    const SizeView cells = body.cells.begin, faces = body.faces.begin;
    const int first = body.first_node;
    Kokkos::parallel_for(
        "cgcontact::assembly::room", Policy(exec, 0, body.num_nodes), KOKKOS_LAMBDA(const int n) {
          std::size_t most = 8 * (cells(n + 1) - cells(n)) + 12 * (faces(n + 1) - faces(n));
          for (int i = 0; i < 3; ++i) each_partner(groups, dof_of(first + n, i), [&](int, int) { ++most; });
          room(first + n) = most;
        });
  }
  counts_to_offsets(exec, "cgcontact::assembly::place_room", room);
  const IntView all(Kokkos::view_alloc(Kokkos::WithoutInitializing, "cgcontact::assembly::all_columns"), last_of(room));
  for (const BodyConnectivity& body : bodies) {
    const ItemsOfNodes cells = body.cells, faces = body.faces;
    const CellNodesView nodes_of_cell = body.nodes_of_cell;
    const FaceNodesView nodes_of_face = body.nodes_of_face;
    const int first = body.first_node;
    Kokkos::parallel_for(
        "cgcontact::assembly::columns", Policy(exec, 0, body.num_nodes), KOKKOS_LAMBDA(const int n) {
          int* const list = all.data() + room(first + n);
          int length = 0;
          for (std::size_t i = cells.begin(n); i < cells.begin(n + 1); ++i)
            for (int a = 0; a < 8; ++a) length = insert(list, length, nodes_of_cell(cells.items(i), a));
          for (std::size_t i = faces.begin(n); i < faces.begin(n + 1); ++i)
            for (int a = 0; a < 12; ++a) length = insert(list, length, nodes_of_face(faces.items(i), a));
          for (int i = 0; i < 3; ++i)
            each_partner(groups, dof_of(first + n, i),
                         [&](int entry, int) { length = insert(list, length, node_of_dof(groups.row_dof(entry))); });
          begin(first + n) = length;
        });
  }
  counts_to_offsets(exec, "cgcontact::assembly::place_columns", begin);
  const IntView column(Kokkos::view_alloc(Kokkos::WithoutInitializing, "cgcontact::assembly::columns"), last_of(begin));
  Kokkos::parallel_for(
      "cgcontact::assembly::compress", Policy(exec, 0, num_nodes), KOKKOS_LAMBDA(const int n) {
        for (std::size_t k = begin(n), from = room(n); k < begin(n + 1); ++k, ++from) column(k) = all(from);
      });
  return {begin, column};
}

/// Entries of the rows of a node: three rows of blocks, in turn.
struct RowValues {
  NodeGraph graph;
  typename LocalMatrix::values_type value;

  KOKKOS_INLINE_FUNCTION double& at(int node, std::size_t slot, int i, int j) const {
    const std::size_t begin = graph.begin(node), length = graph.begin(node + 1) - begin;
    return value(9 * begin + 3 * (i * length + (slot - begin)) + j);
  }
};

void add_body(const ExecSpace& exec, const BodyConnectivity& body, const CellMatrixView& matrices,
              const GhostMatrixView& ghost, const RowValues& rows) {
  const ItemsOfNodes cells = body.cells, faces = body.faces;
  const CellNodesView nodes_of_cell = body.nodes_of_cell;
  const FaceNodesView nodes_of_face = body.nodes_of_face;
  const RealView ring_of_face = body.ring_of_face;
  const IntView matrix_of_cell = body.matrix_of_cell;
  const int first = body.first_node;
  Kokkos::parallel_for(
      "cgcontact::assembly::values", Policy(exec, 0, body.num_nodes), KOKKOS_LAMBDA(const int n) {
        const int node = first + n;
        for (std::size_t k = cells.begin(n); k < cells.begin(n + 1); ++k) {
          const int cell = cells.items(k), m = 1 + matrix_of_cell(cell);
          int r = 0;
          while (nodes_of_cell(cell, r) != node) ++r;
          for (int c = 0; c < 8; ++c) {
            const std::size_t slot = rows.graph.find(node, nodes_of_cell(cell, c));
            for (int i = 0; i < 3; ++i)
              for (int j = 0; j < 3; ++j) rows.at(node, slot, i, j) += matrices(m, dof_of(r, i), dof_of(c, j));
          }
        }
        for (std::size_t k = faces.begin(n); k < faces.begin(n + 1); ++k) {
          const int face = faces.items(k);
          int r = 0;
          while (nodes_of_face(face, r) != node) ++r;
          for (int c = 0; c < 12; ++c) {
            const std::size_t slot = rows.graph.find(node, nodes_of_face(face, c));
            for (int i = 0; i < 3; ++i) rows.at(node, slot, i, i) += ring_of_face(face) * ghost(r, c);
          }
        }
      });
}

/// Row by row of the DoFs that the groups touch.
void add_groups(const ExecSpace& exec, const GroupRows& groups, const RowValues& rows) {
  Kokkos::parallel_for(
      "cgcontact::assembly::groups", Policy(exec, 0, groups.dof_list.extent(0)), KOKKOS_LAMBDA(const int row) {
        const int dof = groups.dof_list(row), node = node_of_dof(dof);
        each_partner(groups, dof, [&](int entry, int k) {
          const double stiffness = groups.stiffness(groups.column_group(k));
          if (stiffness == 0) return;
          const int other = groups.row_dof(entry);
          rows.at(node, rows.graph.find(node, node_of_dof(other)), component_of_dof(dof), component_of_dof(other)) +=
              stiffness * groups.column_value(k) * groups.row_value(entry);
        });
      });
}

GhostMatrixView ghost_matrix_of(const BodyMesh& mesh, double penalty) {
  const GhostMatrix matrix = make_ghost_matrix(mesh, penalty);
  const GhostMatrixView view("cgcontact::assembly::ghost");
  const auto host = Kokkos::create_mirror_view(view);
  for (int r = 0; r < 12; ++r)
    for (int c = 0; c < 12; ++c) host(r, c) = matrix[r][c];
  Kokkos::deep_copy(view, host);
  return view;
}

/// P^T A P of the free values, and the identity at constrained nodes and where the displacement is zero.
Teuchos::RCP<TpetraMatrix> constrained(const ElasticSystem& system, const TpetraMatrix& matrix) {
  const auto map = matrix.getRowMap();
  TpetraMatrix P(map, 8), identity(map, 1), product(map, 0);
  for (int dof = 0; dof < system.num_dofs(); ++dof) {
    const int c = system.constraint_of_node[node_of_dof(dof)];
    std::vector<TpetraMatrix::global_ordinal_type> columns{dof};
    std::vector<double> weights{1.0};
    const bool zero = system.is_zero(dof);
    if (c >= 0 || zero) {
      identity.insertGlobalValues(dof, 1, weights.data(), columns.data());
      columns.clear();
      weights.clear();
    }
    if (zero) continue;
    if (c >= 0)
      for (const auto& [master, weight] : system.constraints[c].masters) {
        if (system.is_zero(dof_of(master, component_of_dof(dof)))) continue;
        columns.push_back(dof_of(master, component_of_dof(dof)));
        weights.push_back(weight);
      }
    P.insertGlobalValues(dof, static_cast<int>(columns.size()), weights.data(), columns.data());
  }
  P.fillComplete(map, map);
  identity.fillComplete(map, map);
  Tpetra::TripleMatrixMultiply::MultiplyRAP(P, true, matrix, false, P, false, product);
  return Tpetra::MatrixMatrix::add(1.0, false, product, 1.0, false, identity);
}

}  // namespace

Teuchos::RCP<TpetraMatrix> assemble_matrix(const ElasticSystem& system, const Teuchos::RCP<const TpetraMap>& map) {
  const ExecSpace exec;
  std::vector<BodyConnectivity> bodies;
  const std::vector<const BodyMesh*> levels = system.level_meshes();
  for (const BodyMesh* level : levels) bodies.push_back(connectivity_of(exec, *level));
  // Without any group the views of the groups are empty ones.
  const NodeGraph graph = make_graph(exec, bodies, system.groups, system.num_nodes);
  const std::size_t blocks = graph.column.extent(0);
  const RowValues rows{graph, typename LocalMatrix::values_type("cgcontact::assembly::value", 9 * blocks)};
  for (std::size_t b = 0; b < bodies.size(); ++b)
    add_body(exec, bodies[b], make_cell_matrices(*levels[b], system.supports[b]),
             ghost_matrix_of(*levels[b], system.ghost_penalty), rows);
  add_groups(exec, system.groups, rows);

  const int num_rows = system.num_dofs();
  const typename LocalMatrix::row_map_type::non_const_type begin("cgcontact::assembly::row_begin", num_rows + 1);
  const typename LocalMatrix::index_type::non_const_type column(
      Kokkos::view_alloc(Kokkos::WithoutInitializing, "cgcontact::assembly::column"), 9 * blocks);
  Kokkos::parallel_for(
      "cgcontact::assembly::rows", Policy(exec, 0, num_rows), KOKKOS_LAMBDA(const int row) {
        const int node = node_of_dof(row);
        const std::size_t first = graph.begin(node), length = graph.begin(node + 1) - first;
        begin(row) = 9 * first + 3 * component_of_dof(row) * length;
        for (std::size_t k = 0; k < length; ++k)
          for (int j = 0; j < 3; ++j) column(begin(row) + 3 * k + j) = dof_of(graph.column(first + k), j);
        if (row + 1 == num_rows) begin(num_rows) = 9 * (first + length);
      });
  exec.fence();
  auto matrix = Teuchos::rcp(new TpetraMatrix(map, map, begin, column, rows.value));
  matrix->expertStaticFillComplete(map, map);
  return system.constraints.empty() ? matrix : constrained(system, *matrix);
}

}  // namespace cgcontact
