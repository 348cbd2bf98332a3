#include "kernels/operator/node_columns.hpp"

#include <algorithm>

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
    int body, axis;
    std::array<int, longest> nodes;
  };
  std::vector<Line> lines[longest + 1];
  const std::vector<const BodyMesh*> levels = system.level_meshes();
  const auto is_constrained = [&](int node) {
    return !system.constraint_of_node.empty() && system.constraint_of_node[node] >= 0;
  };
  for (std::size_t b = 0; b < levels.size(); ++b) {
    const BodyMesh& mesh = *levels[b];
    for (int d = 2; d >= 0; --d)
      for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
        Index3 position = mesh.nodes[n];
        --position[d];
        if (mesh.find_node(position) >= 0) continue;
        ++position[d];
        Line line{static_cast<int>(b), d, {}};
        int size = 0;
        for (int node = mesh.first_node + static_cast<int>(n); node >= 0 && size <= longest; ++size) {
          if (size < longest) line.nodes[size] = node;
          ++position[d];
          node = mesh.find_node(position);
        }
        if (size <= longest) lines[size].push_back(line);
      }
  }
  std::vector<int> column_of_node(system.num_nodes, -1), nodes;
  std::vector<Column> columns;
  std::size_t entries = 0;
  Columns result;
  for (int size = 2; size <= longest; ++size) {
    result.size_begin[size] = static_cast<int>(columns.size());
    for (const Line& line : lines[size]) {
      bool free = true;
      for (int p = 0; p < size; ++p) free &= column_of_node[line.nodes[p]] < 0 && !is_constrained(line.nodes[p]);
      if (!free) continue;
      for (int p = 0; p < size; ++p) {
        column_of_node[line.nodes[p]] = static_cast<int>(columns.size());
        nodes.push_back(line.nodes[p]);
      }
      columns.push_back({line.body, line.axis, size, static_cast<int>(nodes.size()) - size, entries});
      entries += dof_offset(size) * dof_offset(size);
    }
  }
  result.size_begin[longest + 1] = static_cast<int>(columns.size());
  result.columns = copy_to_view<decltype(result.columns)>("cgcontact::node_columns::columns", columns);
  result.nodes = copy_to_view<IntView>("cgcontact::node_columns::nodes", nodes);
  result.column_of_node = copy_to_view<IntView>("cgcontact::node_columns::column_of_node", column_of_node);
  result.matrices = decltype(result.matrices)("cgcontact::node_columns::matrices", entries);
  return result;
}

template <class Real>
std::vector<std::vector<int>> nodes_of_columns(const NodeColumns<Real>& columns) {
  std::vector<std::vector<int>> lists;
  for (int c = 0; c < columns.num_columns(); ++c) {
    const auto& column = columns.columns(c);
    lists.emplace_back();
    for (int p = 0; p < column.size; ++p) lists.back().push_back(columns.nodes(column.first + p));
  }
  return lists;
}

template struct NodeColumns<float>;
template struct NodeColumns<double>;
template NodeColumns<float> make_node_columns(const ElasticSystem&);
template NodeColumns<double> make_node_columns(const ElasticSystem&);
template std::vector<std::vector<int>> nodes_of_columns(const NodeColumns<float>&);
template std::vector<std::vector<int>> nodes_of_columns(const NodeColumns<double>&);

}  // namespace cgcontact
