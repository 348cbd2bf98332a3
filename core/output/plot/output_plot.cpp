#include "core/output/plot/output_plot.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/base/errors/errors.hpp"
#include "core/base/files/text.hpp"
#include "core/output/plot/picture_file.hpp"
#include "core/output/plot/plot_picture.hpp"
#include "core/output/report/read_report.hpp"

namespace cgcontact {

namespace {

std::string extreme_line(const char* which, const PlotExtreme& extreme, const PlotField& field,
                         const PlotResult& result) {
  constexpr int digits = 6;
  const DisplayUnit unit = field.display(std::abs(extreme.value));
  return fmt::format("{}: {} {} in {} at {}\n", which, short_number(extreme.value * unit.factor, digits), unit.name,
                     printable(result.known.bodies[extreme.body].name), position_text(extreme.at, digits));
}

}  // namespace

std::string plot_result(const PlotOptions& options) {
  const PictureFile out(options.out, options.directory);
  const auto step = static_cast<std::size_t>(options.step);
  const Json report = read_report(options.directory);  // before its files: a directory without it is no result
  const VtkArrays file(result_file(options.directory, step));
  const PlotField field = plot_field(options.field, file);
  const PlotResult result = read_plot_result(options.directory, report, step, file);
  const PlotShape shape = shape_to_plot(result, options);
  const PlotValues values = values_to_plot(field, result, shape, file, options.range);
  out.draw([&](GnuplotRuns& runs, const std::string& name) {
    draw_plot(result, options, field, shape, values, name, runs);
  });
  return fmt::format("{} drawn in {}\n", field.name, printable(options.out)) +
         extreme_line("largest", values.largest, field, result) +
         extreme_line("smallest", values.smallest, field, result);
}

}  // namespace cgcontact
