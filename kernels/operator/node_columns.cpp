#include "kernels/operator/node_columns.hpp"

#include <algorithm>

#include "kernels/mesh/grid_numbers.hpp"
#include "kernels/mesh/host_copy.hpp"

namespace cgcontact {

template <class Real>
std::size_t NodeColumns<Real>::bytes() const {
  return columns.extent(0) * sizeof(Column) + (nodes.extent(0) + column_of_node.extent(0)) * sizeof(int) +
         matrices.extent(0) * sizeof(Real);
}

template <class Real>
NodeColumns<Real> make_node_columns(const ElasticSystem& system) {
  using Columns = NodeColumns<Real>;
  using Column = typename Columns::Column;
  constexpr int longest = Columns::longest;
  struct Line {
    int body, axis, size;
    long long start, stride;  // in the grid
  };
  std::vector<Line> lines[longest + 1];
  std::vector<std::vector<int>> number;
  for (std::size_t b = 0; b < system.meshes.size(); ++b) {
    const BodyMesh& mesh = system.meshes[b];
    const Grid& grid = mesh.cut_cells->grid;
    number.push_back(numbers_on_grid(mesh));
    const std::vector<int>& at = number.back();
    for (int d = 2; d >= 0; --d) {
      const long long stride = grid.node_index({d == 0, d == 1, d == 2});
      for (const Index3& n : mesh.nodes) {
        const long long start = grid.node_index(n);
        if (n[d] > 0 && at[start - stride] >= 0) continue;
        int size = 1;
        while (size <= longest && n[d] + size <= grid.num_cells[d] && at[start + size * stride] >= 0) ++size;
        if (size <= longest) lines[size].push_back({static_cast<int>(b), d, size, start, stride});
      }
    }
  }
  std::vector<int> column_of_node(system.num_nodes, -1), nodes;
  std::vector<Column> columns;
  std::size_t entries = 0;
  Columns result;
  for (int size = 2; size <= longest; ++size) {
    result.size_begin[size] = static_cast<int>(columns.size());
    for (const Line& line : lines[size]) {
      const auto node = [&](int p) { return number[line.body][line.start + p * line.stride]; };
      bool free = true;
      for (int p = 0; p < size; ++p) free &= column_of_node[node(p)] < 0;
      if (!free) continue;
      for (int p = 0; p < size; ++p) {
        column_of_node[node(p)] = static_cast<int>(columns.size());
        nodes.push_back(node(p));
      }
      columns.push_back({line.body, line.axis, size, static_cast<int>(nodes.size()) - size, entries});
      entries += 9 * static_cast<std::size_t>(size) * size;
    }
  }
  result.size_begin[longest + 1] = static_cast<int>(columns.size());
  result.columns = copy_to_view<decltype(result.columns)>("cgcontact::node_columns::columns", columns);
  result.nodes = copy_to_view<IntView>("cgcontact::node_columns::nodes", nodes);
  result.column_of_node = copy_to_view<IntView>("cgcontact::node_columns::column_of_node", column_of_node);
  result.matrices = decltype(result.matrices)("cgcontact::node_columns::matrices", entries);
  return result;
}

template struct NodeColumns<float>;
template struct NodeColumns<double>;
template NodeColumns<float> make_node_columns(const ElasticSystem&);
template NodeColumns<double> make_node_columns(const ElasticSystem&);

}  // namespace cgcontact
