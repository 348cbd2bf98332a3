#include "core/output/plot/plot_fields.hpp"

#include <fmt/format.h>

#include "core/base/errors/errors.hpp"
#include "core/base/errors/suggest.hpp"

namespace cgcontact {

bool PlotField::can_be_negative() const {
  if (!scalar) return false;
  return *scalar != ScalarField::displacement && *scalar != ScalarField::von_mises && *scalar != ScalarField::tresca;
}

DisplayUnit PlotField::display(double largest) const {
  return unit == "m" ? length_unit(largest) : unit == "Pa" ? stress_unit(largest) : DisplayUnit{1, unit};
}

std::vector<PlotField> plot_fields(const VtkArrays& file) {
  std::vector<PlotField> fields;
  const auto add = [&](const char* array, bool lengths, const std::string& prefix, const std::string& of_cells) {
    if (!file.has(array)) return;
    for (std::size_t k = 0; k < static_cast<std::size_t>(ScalarField::pressure); ++k) {
      const auto scalar = static_cast<ScalarField>(k);
      if (is_length(scalar) == lengths)
        fields.push_back({prefix + name_of(scalar), scalar, of_cells, lengths ? "m" : "Pa"});
    }
  };
  add("PointData/displacement", true, "", "");
  add("PointData/stress_recovered", false, "", "");
  add("CellData/stress_raw", false, "raw_", "CellData/stress_raw");
  const auto add_error = [&](const char* name, const char* unit) {
    const std::string array = std::string("CellData/") + name;
    if (file.has(array)) fields.push_back({name, std::nullopt, array, unit});
  };
  add_error("estimated_error", "sqrt(J)");
  add_error("estimated_error_density", "sqrt(J/m^3)");
  return fields;
}

PlotField plot_field(const std::string& name, const VtkArrays& file) {
  const std::vector<PlotField> fields = plot_fields(file);
  std::vector<std::string> names;
  for (const PlotField& field : fields) {
    if (field.name == name) return field;
    names.push_back(field.name);
  }
  throw InputError(fmt::format("--field {}: {} has no such field{} (allowed: {})", name, file.file(),
                               did_you_mean(name, names), join(names)));
}

std::vector<std::vector<double>> values_in_cells(const PlotField& field, const PlotResult& result,
                                                 const VtkArrays& file) {
  std::vector<std::vector<double>> values(result.bodies.size());
  if (!field.in_cells()) return values;
  for (std::size_t b = 0; b < values.size(); ++b) {
    const std::size_t n = result.bodies[b].mesh.num_polyhedra();
    if (!field.scalar) {
      values[b] = file.numbers(field.array, 1, result.first_cell[b], n);
      continue;
    }
    const std::vector<double> stress = file.numbers(field.array, 6, result.first_cell[b], n);
    for (std::size_t i = 0; i < n; ++i)
      values[b].push_back(value_of(*field.scalar, Vec3::Zero(), Eigen::Map<const Sym3>(&stress[6 * i])));
  }
  return values;
}

std::vector<double> values_at_points(const PlotField& field, const DrawnBody& body) {
  std::vector<double> values(field.in_cells() ? 0 : body.position.size());
  const bool length = field.scalar && is_length(*field.scalar);
  for (std::size_t p = 0; p < values.size(); ++p)
    values[p] = value_of(*field.scalar, length ? body.displacement[p] : Vec3(Vec3::Zero()),
                         length ? Sym3(Sym3::Zero()) : body.stress[p]);
  return values;
}

}  // namespace cgcontact
