#include "contact/results/pressure_jumps.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "core/base/parallel.hpp"
#include "core/base/point_buckets.hpp"

namespace cgcontact {
namespace {

/// Rows per chunk of the parallel loop.
constexpr std::size_t grain = 128;

/// Values of the finite element stress, of plain SPR and of the transmitted pressure around a row.
struct Around {
  double least = 1e300, most = -1e300;
  double difference = 0;  ///< largest between the first two
  bool closed = true;     ///< all of it

  void add(const ContactRow& row) {
    least = std::min({least, row.pressure_raw, row.pressure_spr});
    most = std::max({most, row.pressure_raw, row.pressure_spr});
    if (std::isfinite(row.pressure_transmitted)) {
      least = std::min(least, row.pressure_transmitted);
      most = std::max(most, row.pressure_transmitted);
    }
    difference = std::max(difference, std::abs(row.pressure_raw - row.pressure_spr));
    closed = closed && row.active;
  }
};

}  // namespace

std::vector<PressureJump> pressure_jumps(const std::vector<ContactRow>& rows, const std::vector<double>& max_pressures,
                                         const ResultOptions& options) {
  using Key = std::tuple<int, int, double>;  // pair, body, reach: few sizes of cells
  std::map<Key, PointBuckets> buckets;
  const auto key_of = [&](const ContactRow& row) {
    return Key(row.pair, row.body, options.spoilt_at_edge * row.larger_cell);
  };
  for (const ContactRow& row : rows)
    if (row.active) buckets.try_emplace(key_of(row), PointBuckets(std::get<2>(key_of(row))));
  for (auto& [key, of_key] : buckets)
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (rows[i].pair == std::get<0>(key) && rows[i].body == std::get<1>(key))
        of_key.add(rows[i].x, static_cast<int>(i));

  std::vector<Around> around(rows.size());
  std::vector<double> excess(rows.size(), 0.0);  // beyond what is allowed, Pa
  parallel_for("cgcontact::pressure_jumps::around", rows.size(), grain, [&](std::size_t i) {
    const ContactRow& row = rows[i];
    const double largest = max_pressures[row.pair];
    if (!row.active || !(largest > 0)) return;
    const Key key = key_of(row);
    const double reach = std::get<2>(key);
    buckets.at(key).each_near(row.x, [&](int j) {
      if ((rows[j].x - row.x).squaredNorm() <= reach * reach) around[i].add(rows[j]);
    });
    if (!around[i].closed) return;
    const double outside = std::max(around[i].least - row.pressure_sprc, row.pressure_sprc - around[i].most);
    excess[i] = outside - around[i].difference - options.largest_jump * largest;
  });

  std::vector<PressureJump> jumps;
  for (std::size_t pair = 0; pair < max_pressures.size(); ++pair) {
    double worst = 0;
    PressureJump jump;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i].pair != static_cast<int>(pair) || !(excess[i] > worst)) continue;
      worst = excess[i];
      jump = {rows[i].pair, rows[i].x, rows[i].pressure_sprc, around[i].least, around[i].most, rows[i].larger_cell};
    }
    if (worst > 0) jumps.push_back(jump);
  }
  return jumps;
}

}  // namespace cgcontact
