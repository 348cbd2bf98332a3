#include "core/output/fields/output_csv.hpp"

#include <fmt/format.h>

#include <iterator>

#include "core/base/files/text.hpp"

namespace cgcontact {

namespace {}  // namespace

std::vector<std::string> csv_fields(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool doubled = quoted && line.compare(i, 2, "\"\"") == 0;
    if (line[i] == '"' && !doubled)
      quoted = !quoted;
    else if (line[i] == ',' && !quoted)
      fields.emplace_back();
    else
      fields.back() += line[i];
    i += doubled;
  }
  return fields;
}

void write_contact_csv(const Results& results, const std::string& file_name) {
  std::vector<std::string> names, pairs;
  for (const BodyFields& body : results.bodies) names.push_back(csv_text(body.name));
  for (const PairFigures& pair : results.pairs) pairs.push_back(csv_text(pair.name));
  std::string text =
      "body,pair,x,y,z,nx,ny,nz,weight,gap,pressure_raw,pressure_spr,pressure_sprc,pressure_error,active";
  const bool friction = has_friction(results);
  text += friction ? ",shear_transmitted_x,shear_transmitted_y,shear_transmitted_z,shear_x,shear_y,shear_z,slip_x,slip_"
                     "y,slip_z,travelled,slips,wear\n"
                   : "\n";
  for (const ContactRow& row : results.contact_rows) {
    text += names.at(row.body) + "," + pairs.at(row.pair);
    for (const double value : {row.x[0], row.x[1], row.x[2], row.normal[0], row.normal[1], row.normal[2], row.weight,
                               row.gap, row.pressure_raw, row.pressure_spr, row.pressure_sprc, row.pressure_error})
      fmt::format_to(std::back_inserter(text), ",{:.{}g}", value, csv_digits);
    text += row.active ? ",1" : ",0";
    if (friction) {
      for (const Vec3& v : {row.shear_transmitted, row.shear_sprc, row.slip})
        for (const double value : v) fmt::format_to(std::back_inserter(text), ",{:.{}g}", value, csv_digits);
      fmt::format_to(std::back_inserter(text), ",{:.{}g},{},{:.{}g}", row.travelled, csv_digits, row.slips ? 1 : 0,
                     row.wear, csv_digits);
    }
    text += "\n";
  }
  write_text(file_name, text);
}

void write_pressure_csv(const Results& results, const std::string& file_name) {
  std::string text = "pair,body,s,x,y,z,pressure_raw,pressure_spr,pressure_sprc,pressure_reference\n";
  for (const PathSample& p : results.path) {
    text += csv_text(results.pairs.at(p.pair).name) + "," + csv_text(results.bodies.at(p.body).name);
    for (const double value : {p.s, p.x[0], p.x[1], p.x[2], p.pressure_raw, p.pressure_spr, p.pressure_sprc})
      fmt::format_to(std::back_inserter(text), ",{:.{}g}", value, csv_digits);
    text += p.has_reference ? fmt::format(",{:.{}g}\n", p.pressure_reference, csv_digits) : ",\n";
  }
  write_text(file_name, text);
}

void write_steps_csv(const Results& results, const std::string& file_name) {
  std::string text =
      "step,loads,displacements,interference,contact,force,force_x,force_y,force_z,area,max_pressure,active_points,"
      "converged,max_displacement,normal_force";
  const bool friction = has_friction(results);
  text += friction ? ",friction_capacity,torque_capacity,friction_use,friction_work\n" : "\n";
  for (std::size_t k = 0; k < results.steps.size(); ++k) {
    const StepFigures& s = results.steps[k];
    for (const PairFigures& pair : s.pairs) {
      const Vec3& f = pair.force_on_first;
      fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}", k + 1, s.step.loads,
                     s.step.displacements, s.step.interference, csv_text(pair.name), f.norm(), f[0], f[1], f[2],
                     pair.area, pair.max_pressure, pair.active_points, s.converged ? 1 : 0,
                     s.displacement ? fmt::format("{}", *s.displacement) : "", pair.zone.normal_force);
      if (friction && !pair.friction) text += ",,,,";
      if (friction && pair.friction) {
        const auto number = [](const auto& value) { return value ? fmt::format("{}", *value) : ""; };
        const auto& torque = pair.friction->torque;
        text += fmt::format(",{},{},{},{}", pair.friction->capacity, torque ? fmt::format("{}", torque->capacity) : "",
                            number(pair.friction->use), pair.friction->work);
      }
      text += "\n";
    }
  }
  write_text(file_name, text);
}

}  // namespace cgcontact
