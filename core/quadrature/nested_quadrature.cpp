#include "core/quadrature/nested_quadrature.hpp"

#include "core/quadrature/gauss_rules.hpp"
#include "core/quadrature/nested_breakpoints.hpp"
#include "core/quadrature/outer_map.hpp"
#include "core/quadrature/region_slice.hpp"

namespace cgcontact {

void integrate_nested(const Region& region, const RegionRule& rule, std::vector<RegionPoint>& points) {
  static thread_local Slicer slicer;
  static thread_local std::vector<Interval> intervals;
  slicer.reset(region);
  find_intervals(slicer, intervals);
  const GaussRule& outer = gauss_rule(rule.nodes_t);
  const GaussRule& inner = gauss_rule(rule.nodes_s);
  for (const Interval& interval : intervals) {
    const OuterMap map(interval);
    for (int i = 0; i < rule.nodes_t; ++i) {
      double t = 0, slope = 0;
      map(outer.node[i], t, slope);
      for (const Segment& segment : slicer.slice(t)) {
        const double length = segment.end - segment.begin;
        for (int j = 0; j < rule.nodes_s; ++j)
          points.push_back({segment.begin + length * inner.node[j], t,
                            slope * outer.weight[i] * length * inner.weight[j], segment.value, segment.mask});
      }
    }
  }
}

}  // namespace cgcontact
