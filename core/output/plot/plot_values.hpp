/// Values of one field on what is drawn: of every corner, their extremes, the range of the colours.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/output/plot/plot_fields.hpp"
#include "core/output/plot/plot_shape.hpp"

namespace cgcontact {

/// Value with its place; body -1: there is none.
struct PlotExtreme {
  double value = 0;
  Vec3 at = Vec3::Zero(), drawn = Vec3::Zero();  ///< m: undeformed, the point or the middle of a cell; as drawn
  int body = -1;
};

struct PlotValues {
  std::vector<std::vector<double>> of_points;  ///< of the points of the bodies that are shown
  std::vector<std::vector<double>> of_cells;   ///< of the cells of the bodies, for a field in cells
  /// Extremes in the section, or in the whole bodies whose surfaces are drawn; near a contact zone only there.
  PlotExtreme largest, smallest;
  double low = 0, high = 1;  ///< ends of the colours

  double at(std::size_t body, const BoundaryTriangle& triangle, int corner) const {
    return of_cells[body].empty() ? of_points[body][triangle.points[corner]] : of_cells[body][triangle.cell];
  }
};

/// Without `ends` the colours of a section go from its smallest to its largest value; those of surfaces leave out half
/// a per cent of the corners at an end, and begin at 0 where the field has no negative values. Throws InputError if the
/// dimension of the ends is not that of the field, or if nothing has a value.
PlotValues values_to_plot(const PlotField& field, const PlotResult& result, const PlotShape& shape,
                          const VtkArrays& file, const std::optional<PlotOptions::Ends>& ends);

}  // namespace cgcontact
