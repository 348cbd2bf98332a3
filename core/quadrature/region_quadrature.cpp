#include "core/quadrature/region_quadrature.hpp"

#include "core/quadrature/nested_quadrature.hpp"
#include "core/quadrature/polygon_quadrature.hpp"

namespace cgcontact {

void integrate_region(const Region& region, const RegionRule& rule, std::vector<RegionPoint>& points) {
  bool linear = true;
  for (const RegionFunction& f : region.functions) linear = linear && !f.on_graph && f.conic.is_linear();
  if (linear)
    integrate_polygons(region, rule, points);
  else
    integrate_nested(region, rule, points);
}

}  // namespace cgcontact
