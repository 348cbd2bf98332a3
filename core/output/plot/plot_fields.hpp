/// Fields of a result that can be drawn, by their names, and their values.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/base/files/text.hpp"
#include "core/output/plot/plot_result.hpp"
#include "core/scene/scalar_field.hpp"

namespace cgcontact {

/// Scalar of displacement and recovered stress at points, of the raw stress in cells, or an array of cells.
struct PlotField {
  std::string name;
  std::optional<ScalarField> scalar;  ///< none: the values of the array
  std::string array;                  ///< of cells; empty: at points
  std::string unit;                   ///< in SI: "m", "Pa", "sqrt(J)", "sqrt(J/m^3)"

  bool in_cells() const { return !array.empty(); }
  bool can_be_negative() const;
  /// Returns the unit to write values up to this one in.
  DisplayUnit display(double largest) const;
};

/// Lists those that the file has; "raw_" stands before those of the stress without recovery.
std::vector<PlotField> plot_fields(const VtkArrays& file);
/// Throws InputError that lists the names there are.
PlotField plot_field(const std::string& name, const VtkArrays& file);

/// Returns the values of a field in the cells of each body; nothing for a field at points.
std::vector<std::vector<double>> values_in_cells(const PlotField& field, const PlotResult& result,
                                                 const VtkArrays& file);
/// Returns the values at the points of a drawn body.
std::vector<double> values_at_points(const PlotField& field, const DrawnBody& body);

}  // namespace cgcontact
