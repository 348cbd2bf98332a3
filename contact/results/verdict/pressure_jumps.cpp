#include "contact/results/verdict/pressure_jumps.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/base/process/parallel.hpp"

namespace cgcontact {
namespace {

/// Values of the finite element stress, of plain SPR and of the transmitted pressure around a row.
struct Around {
  double least = 1e300, most = -1e300;
  double difference = 0;  ///< largest between the first two
  bool closed = true;     ///< all of it

  void add(const Around& more) {
    least = std::min(least, more.least);
    most = std::max(most, more.most);
    difference = std::max(difference, more.difference);
    closed = closed && more.closed;
  }
};

Around of_row(const ContactRow& row) {
  Around values{std::min(row.pressure_raw, row.pressure_spr), std::max(row.pressure_raw, row.pressure_spr),
                std::abs(row.pressure_raw - row.pressure_spr), row.active};
  if (std::isfinite(row.pressure_transmitted)) {
    values.least = std::min(values.least, row.pressure_transmitted);
    values.most = std::max(values.most, row.pressure_transmitted);
  }
  return values;
}

/// Rows of an undivided branch of the tree.
constexpr std::size_t few_rows = 8;

/// The rows of one face of a pair, as a tree of halves across the longest side of their box: what is wholly near a row
/// counts at once, so that a row costs the rim of its surroundings.
class RowTree {
 public:
  explicit RowTree(const std::vector<ContactRow>& rows) : rows_(rows) {}
  void add(int row) { order_.push_back(row); }
  /// After the last row.
  void build() { build(0, order_.size()); }

  Around within(const Vec3& x, double reach) const {
    Around around;
    collect(0, x, reach * reach, around);
    return around;
  }

 private:
  struct Node {
    std::size_t begin, end;  ///< of order_
    Eigen::AlignedBox3d box;
    Around all;
    std::size_t second = 0;  ///< half; the first one follows; 0: not divided
  };

  void build(std::size_t begin, std::size_t end) {
    Node node{begin, end, {}, {}};
    for (std::size_t i = begin; i < end; ++i) {
      node.box.extend(rows_[order_[i]].x);
      node.all.add(of_row(rows_[order_[i]]));
    }
    const std::size_t number = nodes_.size();
    nodes_.push_back(node);
    if (end - begin <= few_rows) return;
    Eigen::Index axis = 0;
    node.box.sizes().maxCoeff(&axis);
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [&](int a, int b) { return rows_[a].x[axis] < rows_[b].x[axis]; });
    build(begin, middle);
    nodes_[number].second = nodes_.size();
    build(middle, end);
  }

  void collect(std::size_t number, const Vec3& x, double reach_squared, Around& around) const {
    const Node& node = nodes_[number];
    if (node.box.squaredExteriorDistance(x) > reach_squared) return;
    const Vec3 farthest = (x - node.box.min()).cwiseAbs().cwiseMax((x - node.box.max()).cwiseAbs());
    if (farthest.squaredNorm() <= reach_squared) return around.add(node.all);
    if (node.second > 0) {
      collect(number + 1, x, reach_squared, around);
      return collect(node.second, x, reach_squared, around);
    }
    for (std::size_t i = node.begin; i < node.end; ++i)
      if ((rows_[order_[i]].x - x).squaredNorm() <= reach_squared) around.add(of_row(rows_[order_[i]]));
  }

  const std::vector<ContactRow>& rows_;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

}  // namespace

std::vector<PressureJump> pressure_jumps(const std::vector<ContactRow>& rows, const std::vector<double>& max_pressures,
                                         const ResultOptions& options) {
  std::map<std::pair<int, int>, RowTree> faces;  // by pair and body
  for (std::size_t i = 0; i < rows.size(); ++i)
    faces.try_emplace({rows[i].pair, rows[i].body}, rows).first->second.add(static_cast<int>(i));
  for (auto& [key, face] : faces) face.build();

  std::vector<Around> around(rows.size());
  std::vector<double> outside(rows.size(), 0.0), excess(rows.size(), 0.0);  // of the range, of what is allowed, Pa
  parallel_for("cgcontact::pressure_jumps::around", rows.size(), grain_of_medium, [&](std::size_t i) {
    const ContactRow& row = rows[i];
    const double largest = max_pressures[row.pair];
    if (!row.active || !(largest > 0)) return;
    around[i] = faces.at({row.pair, row.body}).within(row.x, options.spoilt_at_edge * row.larger_cell);
    if (!around[i].closed) return;
    outside[i] = std::max(around[i].least - row.pressure_sprc, row.pressure_sprc - around[i].most);
    excess[i] = outside[i] - around[i].difference - options.largest_jump * largest;
  });

  std::vector<PressureJump> jumps;
  for (std::size_t pair = 0; pair < max_pressures.size(); ++pair) {
    double worst = 0, wrong = 0, force = 0;  // Pa, N, N
    PressureJump jump;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i].pair != static_cast<int>(pair)) continue;
      force += rows[i].weight * std::abs(rows[i].pressure_sprc);
      if (excess[i] > 0) wrong += rows[i].weight * outside[i];
      if (!(excess[i] > worst)) continue;
      worst = excess[i];
      jump = {rows[i].pair, rows[i].x, rows[i].pressure_sprc, around[i].least, around[i].most, rows[i].larger_cell};
    }
    if (!(worst > 0)) continue;
    jump.force_fraction = wrong / force;
    jumps.push_back(jump);
  }
  return jumps;
}

}  // namespace cgcontact
