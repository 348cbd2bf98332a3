#include "core/scene_file/templates/scene_template.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>

#include "core/base/errors/errors.hpp"
#include "core/base/errors/suggest.hpp"
#include "core/base/files/new_file.hpp"
#include "core/base/files/text.hpp"
#include "core/cad/cad_model.hpp"
#include "core/scene_file/sections/scene_mesh.hpp"
#include "core/scene_file/templates/cad_template.hpp"
#include "core/scene_file/templates/part_outline.hpp"
#include "core/triangles/triangle_reader.hpp"

namespace cgcontact {

namespace {

namespace fs = std::filesystem;

constexpr const char* example = R"toml(# A spherical cap is pressed onto a block. It runs as it is:
#
#   cgcontact check {0}               what the scene contains
#   cgcontact run {0}                 solve; results in out/{1}
#   cgcontact run {0} --set n=24      the same on finer cells
#   cgcontact study {0} --vary n=9,12,18,24
#
# Lengths in m, pressures in Pa. Every key is in docs/scene.md of cgcontact.

title = "Sphere on a block"

[parameters]     # numbers for use below, as text: "2*R"
n = 18           # cells of the block per side
R = 0.1          # radius of the sphere, m
L = 0.03         # side of both bodies, m; a quarter of them is modelled
d = 0.6e-3       # the cap is moved down by this, m
E = 210e9        # Young's modulus, Pa
nu = 0.3         # Poisson's ratio

# Each body has cells of its own, which need not fit the body. Finer cells cost more time and memory.
[[body]]
name = "block"
shape = {{name = "base", box = {{min = [0, 0, "-L"], max = ["L", "L", 0]}}}}
material = {{E = "E", nu = "nu"}}
cell_size = "L/n"
grid = {{offset = [0.4, 0.7, 0.2]}}   # the grid begins a part of a cell before the body; may be left out

# The part of a ball within a box; the box reaches below the ball, so that its own lower face is no part of the cap.
[[body]]
name = "cap"
shape = {{intersection = [
  {{name = "ball", sphere = {{center = [0, 0, "R"], radius = "R"}}}},
  {{name = "cut", box = {{min = [0, 0, -0.01], max = ["L", "L", "L"]}}}},
]}}
material = {{E = "E", nu = "nu"}}
cell_size = "L/(1.2*n)"
grid = {{offset = [0.5, 0.3, 0.9]}}

# Faces are "body.shape.face". symmetry: no displacement along the normal.
[[support]]
face = "block.base.x-"
symmetry = true

[[support]]
face = "block.base.y-"
symmetry = true

[[support]]
face = "block.base.z-"
displacement = {{z = 0}}              # components that are not given are free

[[support]]
face = "cap.cut.x-"
symmetry = true

[[support]]
face = "cap.cut.y-"
symmetry = true

[[support]]
face = "cap.cut.z+"
displacement = {{z = "-d"}}

# Loads are given the same way: face, and pressure = 1e6 or traction = [0, 0, -1e6] (Pa).

[[contact]]
faces = ["block.base.z+", "cap.ball.surface"]

[output]
path = {{from = [0, 0, 0], to = [0.012, 0, 0]}}   # where pressure.svg shows the pressure

# What is known of the solution, for the figures of the true error; may be left out. Here: Hertz at the computed force.
[reference]
pressure = "p0*sqrt(max(0, 1-(x^2+y^2)/a^2))"

[reference.parameters]
F = "4*contact_force"            # N; the model is a quarter
Es = "E/(2*(1-nu^2))"            # Pa
a = "(3*F*R/(4*Es))^(1/3)"       # radius of the contact circle, m
p0 = "3*F/(2*pi*a^2)"            # pressure in its centre, Pa
)toml";

constexpr const char* part_scene = R"toml(# {note}
#
# A plate is pressed onto the top (z+) of the part, which stands on its bottom (z-). {state}
#
#   cgcontact check {file}       what the scene contains
#   cgcontact run {file}         solve; results in out/{stem}
#   cgcontact run {file} --set {finer}
#
# but it knows nothing of your problem: go through the lines marked TODO. Lengths in m, pressures in Pa. Every key is in
# docs/scene.md of cgcontact.

title = {title}

{accuracy}[parameters]
{h}push = {push:.6g}     # TODO how far the plate moves down, m

[[body]]
name = "part"
material = {{E = 210e9, nu = 0.3}}   # TODO Young's modulus (Pa) and Poisson's ratio; this is steel
{part_cells}faces = [                          # TODO parts of the surface that supports, loads and contact refer to, here by place and direction
  {{name = "bottom", {bottom}}},
  {{name = "top", {top}}},
]

[body.shape]
name = "surface"
{turn}{shape}
[[body]]
name = "plate"
shape = {{name = "block", box = {{min = [{p0:.9g}, {p1:.9g}, {z:.9g}], max = [{q0:.9g}, {q1:.9g}, {q2:.9g}]}}}}   # TODO what touches the part
material = {{E = 210e9, nu = 0.3}}   # TODO
{plate_cells}grid = {{offset = [0.3, 0.6, 0.2]}}   # cells need not fit the body: the grid begins a part of a cell before it

[[support]]                        # TODO what holds the part
face = "part.bottom"
displacement = {{x = 0, y = 0, z = 0}}   # components that are not given are free; or: symmetry = true

[[support]]                        # TODO what moves the plate
face = "plate.block.z+"
displacement = {{x = 0, y = 0, z = "-push"}}

# A load instead of a prescribed motion, or beside it (N/m^2, against the normal); the plate's support then loses its z.
# [[load]]
# face = "plate.block.z+"
# pressure = 1e6

[[contact]]                        # TODO which faces may touch
faces = ["part.top", "plate.block.z-"]
)toml";

constexpr const char* mesh_shape = R"toml(
# TODO name the faces you need: remove the "#" before a line and give the face a better name. It is then
# "part.surface.face1" in supports, loads and contact. (Triangles in none of them make up the face "rest".)
# These are the smooth parts of the surface, largest first; edges of more than 30 degrees divide them.
[body.shape.mesh]
file = {surface}
unit = "{unit}"
{repair}faces = [
{faces}]
)toml";

/// Multiples of a power of ten that is small against `size`.
std::string rounded_vector(const Vec3& v, double size) {
  const double digits = std::ceil(4 - std::log10(size));
  const auto rounded = [&](double x) { return std::round(x * std::pow(10, digits)) / std::pow(10, digits) + 0.0; };
  return fmt::format("[{:.12g}, {:.12g}, {:.12g}]", rounded(v[0]), rounded(v[1]), rounded(v[2]));
}

/// Position and motion of the plate; cells of part and plate, zero: [accuracy] chooses them.
struct PlateLayout {
  double cell_size = 0, plate_cell = 0, push = 0;
  Vec3 plate_min, plate_max;
  bool is_narrow = false;  ///< the plate would have to come down too far for a contact zone of some cells
  bool is_long = false;    ///< the contact zone is much longer than wide
};

/// Fraction of the part's height by which flat ends are compressed; largest one by which the plate comes down on
/// others.
constexpr double flat_strain = 1e-3, max_strain = 0.01;

/// Returns a cell size: enough cells through thin regions, not too many in all.
double cell_size_for(const PartOutline& part, double cells) {
  const Vec3 extent = part.max - part.min;
  const double longest = extent.maxCoeff(), shortest = extent.minCoeff();
  constexpr double cells_through = 4, max_cells = 30000;
  double h = std::min(longest / cells, shortest / cells_through);
  const double affordable = std::cbrt(part.volume / (max_cells * std::pow(cells / 20.0, 3)));
  h = std::min(std::max(h, affordable), shortest / 1.2);
  // Sheets: rather less than a cell through the thickness than too many cells.
  return two_digits(std::max(h, std::sqrt(part.area / 2 / (2 * max_cells))));
}

/// Positions the plate over the top of the part; `least`: half of its width, thickness (m).
void position_plate(const PartOutline& part, double min_half, double min_thickness, PlateLayout& layout) {
  const PartEnd& top = part.top;
  const Vec3 extent = part.max - part.min, center = (top.min + top.max) / 2;
  const double narrowest = std::min(extent[0], extent[1]);
  Vec3 half = (top.max - top.min) / 2;
  for (int k = 0; k < 2; ++k) half[k] = std::max({1.1 * half[k], 0.2 * narrowest, min_half});
  const double thickness = std::max(min_thickness, std::min(0.6 * std::min(half[0], half[1]), extent[2]));
  layout.plate_min = {center[0] - half[0], center[1] - half[1], part.max[2]};
  layout.plate_max = {center[0] + half[0], center[1] + half[1], part.max[2] + thickness};
}

PlateLayout lay_out_cells(const PartOutline& part, double cells) {
  constexpr double plate_cells_through = 4, max_plate_cells_across = 60;
  PlateLayout layout;
  const double h = layout.cell_size = cell_size_for(part, cells);
  position_plate(part, 3 * h, 0, layout);
  const Vec3 size = layout.plate_max - layout.plate_min;
  layout.plate_cell = std::max(0.8 * h, std::max(size[0], size[1]) / max_plate_cells_across);
  position_plate(part, 3 * h, plate_cells_through * layout.plate_cell, layout);

  // Others than flat ones: so far that the planes would cut out some six cells across; a contact zone is 0.7 of that.
  const double height = part.max[2] - part.min[2], most = std::max(max_strain * height, 0.6 * h);
  const auto is_wide = [&](double, const PartCut& cut) { return cut.half_width() >= 1.42 * h; };
  const double push = part.top.flat ? flat_strain * height : part.push_until(is_wide, most);
  layout.push = two_digits(push);
  layout.is_narrow = !part.top.flat && push == most;
  return layout;
}

/// Lays out a scene with [accuracy]: nothing depends on cells. The push is the largest of which the contact zone is
/// rather smaller than the part and its strain moderate. is_narrow: a tip or edge, which has no such push.
PlateLayout lay_out(const PartOutline& part) {
  // Half widths of the cut over the part's shortest side; ways down over half widths: of a ball 0.15 is a contact
  // radius of a tenth of its own and a pressure of E/30. Facets are steep at once, so that 0.15 does not count below
  // `least`.
  constexpr double least = 0.04, most = 0.1, steep = 0.15, too_steep = 0.3;
  constexpr double min_fraction = 1e-4;        // of the most that the plate may come down
  constexpr double long_compactness = 0.0125;  // area over the rim squared: some 17 times as long as wide
  PlateLayout layout;
  position_plate(part, 0, 0, layout);
  const Vec3 extent = part.max - part.min;
  const double side = extent.minCoeff(), max_push = max_strain * extent[2];
  const auto is_enough = [&](double push, const PartCut& cut) {
    const double half_width = cut.half_width();
    return half_width >= most * side || push >= too_steep * half_width ||
           (half_width >= least * side && push >= steep * half_width);
  };
  const double push = part.top.flat ? flat_strain * extent[2] : part.push_until(is_enough, max_push);
  const PartCut cut = part.cut_at(push);
  layout.is_narrow = push < min_fraction * max_push;
  layout.is_long = !part.top.flat && cut.area < long_compactness * cut.rim * cut.rim;
  layout.push = two_digits(push);
  return layout;
}

/// Returns selectors of the outermost tenth of the part, of its outward side where it has one.
std::string end_selector(const PartOutline& part, const PartEnd& end, double sign) {
  const Vec3 extent = part.max - part.min;
  Vec3 min = part.min - 0.01 * extent, max = part.max + 0.01 * extent;
  (sign > 0 ? min : max)[2] = sign > 0 ? part.max[2] - 0.1 * extent[2] : part.min[2] + 0.1 * extent[2];
  std::string text = fmt::format("box = {{min = {}, max = {}}}", rounded_vector(min, extent.maxCoeff()),
                                 rounded_vector(max, extent.maxCoeff()));
  if (end.faces_outwards) text += fmt::format(", normal = {{axis = [0, 0, {}], angle = 30}}", sign);
  return text;
}

std::string face_lines(const PartOutline& part) {
  constexpr std::size_t max_lines = 20;
  const double size = (part.max - part.min).maxCoeff();
  std::string text;
  for (std::size_t k = 0; k < std::min(part.regions.size(), max_lines); ++k) {
    const SmoothRegion& face = part.regions[k];
    const std::string shape = face.normal.isZero()
                                  ? "closed"
                                  : fmt::format("{}, normal{} {}", face.flat ? "flat" : "curved",
                                                face.flat ? "" : " on average", rounded_vector(face.normal, 1));
    text += fmt::format("#  {{name = \"face{}\", smooth = {{seed = {}, angle = 30}}}},   # {:.4g} m^2, {}\n", k + 1,
                        rounded_vector(face.seed, size), face.area, shape);
  }
  if (part.regions.size() > max_lines)
    text += fmt::format("#  ... and {} smaller ones\n", part.regions.size() - max_lines);
  return text;
}

/// "" or the line of the shape that turns it.
std::string rotation_line(const Mat3& turn) {
  const Eigen::AngleAxisd rotation(turn);
  if (turn.isIdentity()) return "";
  const Vec3& axis = rotation.axis();
  return fmt::format(
      "rotate = {{axis = [{:.15g}, {:.15g}, {:.15g}], angle = {:.15g}}}   # its largest flat part is its top\n",
      axis[0], axis[1], axis[2], rotation.angle() / radians_per_degree);
}

constexpr const char* runs = "It runs as it is:";

/// Lines of a scene on its accuracy, and the setting that makes it finer.
struct AccuracyLines {
  std::string accuracy, h, part_cells, plate_cells, finer;
};

AccuracyLines lines_for_cells(const PlateLayout& layout, const PartOutline& part) {
  AccuracyLines lines;
  const double longest = (part.max - part.min).maxCoeff();
  lines.h = fmt::format(
      "h = {:.6g}           # cell size of the part, m: {} cells along its longest side. Smaller is more accurate and "
      "costs more\n",
      layout.cell_size, std::lround(longest / layout.cell_size));
  lines.part_cells = "cell_size = \"h\"\n";
  lines.plate_cells = fmt::format("cell_size = \"{:.3g}*h\"\n", layout.plate_cell / layout.cell_size);
  lines.finer = fmt::format("h={:.3g}", layout.cell_size / 1.5);
  return lines;
}

/// A first run ends in about a minute at most.
AccuracyLines lines_for_accuracy(const PartOutline& part) {
  const char* const target = part.top.flat ? "force" : "pressure";
  AccuracyLines lines;
  lines.accuracy = "[accuracy]            # cells follow from it: no body has a cell_size\n";
  lines.accuracy += part.top.flat ? "force = \"5 %\"         # estimated error of the contact force that is asked for; "
                                    "the pressure of a flat face is infinite at its rim\n"
                                  : "pressure = \"5 %\"      # estimated error of the contact pressure that is asked "
                                    "for; less costs more\n";
  lines.accuracy +=
      "max_unknowns = 4e5    # limits of a first look; without them the run goes on until the accuracy is reached\n"
      "max_time = 60         # s\n\n";
  lines.finer = fmt::format("accuracy.{}=2%", target);
  return lines;
}

/// Part as text: its file, how it looks, the lines that say its shape.
struct Part {
  std::string file, shape;
  PartOutline outline;
};

/// A name of a file as the scene has it: from the folder of the scene.
std::string seen_from(const std::string& scene, const std::string& file) {
  if (fs::path(file).is_absolute()) return file;
  return fs::absolute(file).lexically_proximate(fs::absolute(scene).parent_path()).string();
}

Part part_of_surface(const InitOptions& options, const std::string& scene) {
  check_file_names({options.surface, scene});
  Part part{options.surface, "", outline_part(options.surface, mesh_units().at(options.unit), options.repair)};
  part.shape = fmt::format(mesh_shape, fmt::arg("surface", toml_string(seen_from(scene, options.surface))),
                           fmt::arg("unit", options.unit), fmt::arg("repair", options.repair ? "repair = true\n" : ""),
                           fmt::arg("faces", face_lines(part.outline)));
  return part;
}

/// Writes a scene around a part with this many cells along its longest side (none: with [accuracy]), and remarks.
/// `state`: whether it runs.
std::string scene_of_part(const Part& given, std::optional<double> cells, const std::string& file,
                          const std::string& state, std::string& told) {
  const PartOutline& part = given.outline;
  const PlateLayout layout = cells ? lay_out_cells(part, *cells) : lay_out(part);
  const AccuracyLines lines = cells ? lines_for_cells(layout, part) : lines_for_accuracy(part);
  const Vec3 extent = part.max - part.min;
  told = part.note + "\n";
  if (!part.doubt.empty()) told += fmt::format("warning: {}: {}\n", given.file, part.doubt);
  if (!part.turn.isIdentity())
    told += "the part ends in a tip or a sharp edge at its top (z+): it is turned (rotate)\n";
  if (layout.is_narrow)
    told +=
        "warning: the part ends in a tip or a sharp edge at its top (z+): its contact zone is smaller than the cells, "
        "so that the force is rough or zero: smaller cells (--cells), or press on another face\n";
  if (extent.minCoeff() < layout.cell_size)
    told +=
        fmt::format("warning: the part is {:.3g} m thin, less than a cell: its bending is rough\n", extent.minCoeff());
  told += fmt::format("{}; the part has {} smooth face{}\n",
                      cells ? fmt::format("cells of {:.3g} m", layout.cell_size)
                            : fmt::format("{} to 5 %", part.top.flat ? "force" : "pressure"),
                      part.regions.size(), part.regions.size() == 1 ? "" : "s");
  return fmt::format(
      part_scene, fmt::arg("note", part.note), fmt::arg("state", state), fmt::arg("file", comment_word(file)),
      fmt::arg("turn", rotation_line(part.turn)), fmt::arg("shape", given.shape),
      fmt::arg("stem", comment_word(fs::path(file).stem().string())), fmt::arg("finer", lines.finer),
      fmt::arg("title", toml_string(fs::path(given.file).stem().string() + " under a plate")),
      fmt::arg("accuracy", lines.accuracy), fmt::arg("h", lines.h), fmt::arg("part_cells", lines.part_cells),
      fmt::arg("plate_cells", lines.plate_cells), fmt::arg("push", layout.push),
      fmt::arg("bottom", end_selector(part, part.bottom, -1)), fmt::arg("top", end_selector(part, part.top, 1)),
      fmt::arg("p0", layout.plate_min[0]), fmt::arg("p1", layout.plate_min[1]), fmt::arg("z", layout.plate_min[2]),
      fmt::arg("q0", layout.plate_max[0]), fmt::arg("q1", layout.plate_max[1]), fmt::arg("q2", layout.plate_max[2]));
}

/// With [accuracy], or, if that does not pass `find_fault` or cells are asked for, with cells of the first of several
/// sizes that passes.
std::string passing_scene(const Part& given, std::optional<int> asked_cells, const std::string& file,
                          const FindFault& find_fault, std::string& told) {
  const PartOutline& part = given.outline;
  const auto fault_of = [&](const std::string& text) { return find_fault ? find_fault(text, file) : ""; };
  std::string first_fault, refused;
  if (!asked_cells) {
    const PlateLayout layout = lay_out(part);
    if (layout.is_long)
      refused = "cells of one size: the contact zone is long, small cells all along it cost too much\n";
    if (!layout.is_long && !layout.is_narrow) {
      const std::string text = scene_of_part(given, std::nullopt, file, runs, told);
      first_fault = fault_of(text);
      if (first_fault.empty()) return text;
      refused = fmt::format("cells of one size: the scene with [accuracy] does not pass check: {}\n", first_fault);
    }
  }
  const double cells = asked_cells.value_or(default_init_cells);
  for (const double factor : {1.0, 0.7, 1.4, 0.5, 2.0}) {
    const std::string text = scene_of_part(given, cells * factor, file, runs, told);
    const std::string fault = fault_of(text);
    if (fault.empty()) {
      told += refused;
      return text;
    }
    if (first_fault.empty()) first_fault = fault;
  }
  const std::string text = scene_of_part(given, cells, file, "It does not run yet (see `check`):", told);
  told += fmt::format("warning: the scene does not pass check yet: {}\n", first_fault);
  return text;
}

/// Writes the scene of a CAD file: a single solid lies under a plate as a surface does; several are as they are. Tries
/// whether they run.
std::string cad_scene(const InitOptions& options, const std::string& file, const FindFault& find_fault,
                      std::string& told) {
  check_file_names({options.cad, file});
  const CadTemplate cad(options, seen_from(file, options.cad));
  if (const auto single = cad.single()) {
    const std::string text =
        passing_scene({options.cad, single->shape, single->outline}, options.cells, file, find_fault, told);
    told += cad.remarks();
    return text;
  }
  const std::string text = cad.scene(file, "It passes check as it is.", told);
  const std::string fault = find_fault ? find_fault(text, file) : "";
  if (fault.empty()) return text;
  told = fmt::format("warning: the scene does not pass check yet: {}\n", fault);
  return cad.scene(file, "It does not pass check yet.", told);
}

void check_cad_options(const InitOptions& options) {
  if (!options.surface.empty())
    throw InputError(
        "--cad and --stl exclude each other (allowed: one of them; several parts are several bodies, to be added by "
        "hand)");
  const CadFormat format = cad_format(options.cad);
  if (format == CadFormat::unknown)
    throw InputError(options.cad + ": is not the name of a CAD file (allowed: .step, .stp, .iges, .igs, .brep, .brp)");
  if (format == CadFormat::brep && options.unit.empty())
    throw InputError(fmt::format("{} needs --unit: a .brep file does not say its unit (allowed: {})", options.cad,
                                 join(unit_names())));
  if (format != CadFormat::brep && !options.unit.empty())
    throw InputError(fmt::format("--unit {}: {} says its unit itself (allowed: --unit with --stl, or a .brep file)",
                                 options.unit, options.cad));
}

}  // namespace

std::string init_scene(const InitOptions& options, const FindFault& find_fault) {
  if (options.cad.empty() && cad_format(options.file) != CadFormat::unknown) {
    InitOptions by_cad = options;  // cgcontact init part.step
    by_cad.cad.swap(by_cad.file);
    return init_scene(by_cad, find_fault);
  }
  if (options.cad.empty() && options.surface.empty() && is_triangle_file(options.file)) {
    InitOptions by_surface = options;  // cgcontact init part.stl
    by_surface.surface.swap(by_surface.file);
    return init_scene(by_surface, find_fault);
  }
  const bool from_surface = !options.surface.empty(), from_cad = !options.cad.empty();
  if (from_cad) check_cad_options(options);
  if (from_surface && options.unit.empty())
    throw InputError(
        fmt::format("--stl {} needs --unit as well: the file does not say in which unit its numbers are (allowed: {})",
                    options.surface, join(unit_names())));
  if (!from_surface && !from_cad && !options.unit.empty())
    throw InputError(fmt::format("--unit {} is the unit of a surface: it needs --stl FILE", options.unit));
  std::string file = options.file;
  if (file.empty())
    file = from_surface || from_cad ? fs::path(from_cad ? options.cad : options.surface).stem().string() + ".toml"
                                    : "scene.toml";
  if (fs::path(file).extension() != ".toml")
    throw InputError(file + ": is not the name of a scene (allowed: a name that ends in .toml)");
  expect_new_file(file);
  std::string told;
  const std::string name = comment_word(file), stem = comment_word(fs::path(file).stem().string());
  const std::string text = from_cad ? cad_scene(options, file, find_fault, told)
                           : from_surface
                               ? passing_scene(part_of_surface(options, file), options.cells, file, find_fault, told)
                               : fmt::format(example, name, stem);
  write_new_file(file, text);
  told += fmt::format("wrote {}\nNext:\n", file);
  if (from_surface || from_cad) told += "  edit the lines marked TODO: material, faces, supports, motion, contact\n";
  told += fmt::format("  cgcontact check {0}\n  cgcontact run {0}\n", name);
  return told;
}

bool is_deck(const std::string& file) {
  std::string extension = fs::path(file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension == ".inp";
}

void check_file_names(const std::vector<std::string>& files) {
  for (const std::string& name : files)
    if (printable(name) != name)
      throw InputError(
          fmt::format("the name \"{}\" has a control character or is not UTF-8, which a scene cannot hold "
                      "(allowed: another name)",
                      name));
}

std::string toml_string(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (static_cast<unsigned char>(c) < 0x20)
      result += fmt::format("\\u{:04X}", c);
    else
      result += c;
  }
  return result + "\"";
}

std::string comment_word(const std::string& text) {
  std::string word = text;
  std::replace_if(
      word.begin(), word.end(), [](unsigned char c) { return c < 0x20; }, '?');
  return word.find_first_of(" '\"\\$&()*;<>?[]`{|}~!#") == std::string::npos ? word : "\"" + word + "\"";
}

std::vector<std::string> unit_names() {
  std::vector<std::string> names;
  for (const auto& entry : mesh_units()) names.push_back(entry.first);
  return names;
}

int parse_init_cells(const std::string& text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < min_init_cells || value > max_init_cells)
    throw InputError(fmt::format("\"{}\" is not a number of cells (allowed: an integer from {} to {})", text,
                                 min_init_cells, max_init_cells));
  return value;
}

std::string parse_unit(const std::string& text) {
  const std::vector<std::string> names = unit_names();
  if (std::find(names.begin(), names.end(), text) == names.end())
    throw InputError(fmt::format("\"{}\" is not a unit{} (allowed: {})", text, did_you_mean(text, names), join(names)));
  return text;
}

}  // namespace cgcontact
