#include "core/output/pictures/output_pressure_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <optional>

#include "core/base/files/text.hpp"
#include "core/drawing/clip_cells.hpp"
#include "core/drawing/contact_fit.hpp"
#include "core/drawing/curve_ends.hpp"
#include "core/drawing/face_chart.hpp"
#include "core/drawing/render.hpp"
#include "core/drawing/scene_view.hpp"
#include "core/output/pictures/output_plots.hpp"

namespace cgcontact {

namespace {

constexpr std::size_t max_maps = 12;
constexpr int map_side = 720;
constexpr double hidden_by_curve = 0.1;  ///< of the pressure across such a face, root mean squares: no curve beyond
constexpr double thin_face = 0.25;       ///< ratio of the sides below which a face is drawn as a curve
/// Distances along a curve, in the body's smallest cells and in fractions of the curve, within which rows of
/// contact.csv are one point: beside each other on the face they have pressures of their own.
constexpr double bin_in_cells = 0.5, max_bins = 400;
/// Fraction of the largest pressure below which the face is grey. On curved faces the recovered pressure where nothing
/// touches is zero to a few thousandths only.
constexpr double no_pressure = 0.005;
/// Around the zone, of its longer side; and cells at least.
constexpr double zone_margin = 0.25, zone_margin_cells = 2;
/// A zone that takes so much of the face in both directions is no reason to leave out the rest.
constexpr double nearly_all = 0.6;

std::array<double, 3> pressure_colour(double value) {
  return value > no_pressure ? palette_colour(value) : std::array<double, 3>{0.9, 0.9, 0.9};
}

/// Drawn face of one pair.
struct Face {
  std::size_t pair;
  int body;
  FaceTriangles shape;
  std::vector<int> index;  ///< of the triangles in the contact surface
};

/// m, of the smallest cells of a body.
double smallest_cell(const Results& results, int body) {
  const CutCells& cells = *results.bodies[body].cut_cells;
  return cells.grid.cell_size_of(cells.num_levels() - 1);
}

/// Face of the pair's body with the smaller cells; empty if no triangle is there.
Face face_of_pair(const Results& results, const ContactSurface& surface, std::size_t pair) {
  Face face{pair, -1, {}, {}};
  const auto cell_size = [&](int body) { return smallest_cell(results, body); };
  for (std::size_t i = 0; i < surface.size(); ++i)
    if (surface.pair[i] == static_cast<int>(pair) &&
        (face.body < 0 || cell_size(surface.body[i]) < cell_size(face.body)))
      face.body = surface.body[i];
  face.shape.position = &surface.position;
  for (std::size_t i = 0; i < surface.size(); ++i)
    if (surface.pair[i] == static_cast<int>(pair) && surface.body[i] == face.body &&
        (surface.active[i] != 0 || !results.pairs[pair].bonded)) {
      face.index.push_back(static_cast<int>(i));
      face.shape.triangles.push_back(surface.triangles[i]);
    }
  return face;
}

Vec3 centroid(const FaceTriangles& shape, const std::array<int, 3>& t) {
  return ((*shape.position)[t[0]] + (*shape.position)[t[1]] + (*shape.position)[t[2]]) / 3;
}

/// Corners of the face on paper, m.
struct Paper {
  double low[2], high[2];
  double extent(int k) const { return high[k] - low[k]; }
  double largest() const { return std::max(extent(0), extent(1)); }
};

Paper bounds(const FaceTriangles& shape, const FaceChart& chart) {
  Paper paper;
  std::fill(paper.low, paper.low + 2, std::numeric_limits<double>::max());
  std::fill(paper.high, paper.high + 2, -std::numeric_limits<double>::max());
  for (const auto& t : shape.triangles)
    for (int p : t) {
      const Vec3 x = chart.position((*shape.position)[p], centroid(shape, t));
      for (int k = 0; k < 2; ++k) {
        paper.low[k] = std::min(paper.low[k], x[k]);
        paper.high[k] = std::max(paper.high[k], x[k]);
      }
    }
  return paper;
}

/// The triangles of the face that carry pressure; all if none does.
FaceTriangles zone_of(const ContactSurface& surface, const Face& face, double largest_pressure) {
  FaceTriangles zone{face.shape.position, {}};
  for (std::size_t i = 0; i < face.index.size(); ++i)
    if (surface.triangle_values[face.index[i]][ContactSurface::pressure_sprc] > zone_end * largest_pressure)
      zone.triangles.push_back(face.shape.triangles[i]);
  return zone.triangles.empty() ? face.shape : zone;
}

/// The zone with a margin, or the whole face where that is not much more.
Paper zoomed(const Paper& zone, const Paper& whole, double cell_size) {
  const double margin = std::max(zone_margin * zone.largest(), zone_margin_cells * cell_size);
  Paper paper = zone;
  bool all = true;
  for (int k = 0; k < 2; ++k) {
    paper.low[k] = std::max(zone.low[k] - margin, whole.low[k]);
    paper.high[k] = std::min(zone.high[k] + margin, whole.high[k]);
    all &= paper.extent(k) > nearly_all * whole.extent(k);
  }
  return all ? whole : paper;
}

DisplayUnit unit_of(const Paper& paper) {
  double largest = 0;
  for (int k = 0; k < 2; ++k) largest = std::max({largest, -paper.low[k], paper.high[k]});
  return length_unit(largest * (1 + 1e-9));
}

/// Range of the colours of a face in contact, from zero, Pa.
double highest(const PairFigures& pair) {
  return std::isfinite(pair.max_pressure) && pair.max_pressure > 0 ? pair.max_pressure : 1;
}

/// Range of the drawn values, Pa: the pressure from zero; of bonded faces the normal traction, of both signs.
struct DrawnRange {
  double low = 0, high = 1;
};

DrawnRange range_of(const Results& results, std::size_t pair) {
  if (!results.pairs[pair].bonded) return {0, highest(results.pairs[pair])};
  DrawnRange range{0, 0};
  for (const ContactRow& row : results.contact_rows) {
    if (row.pair != static_cast<int>(pair) || !row.active || !std::isfinite(row.pressure_sprc)) continue;
    range.low = std::min(range.low, row.pressure_sprc);
    range.high = std::max(range.high, row.pressure_sprc);
  }
  return range.low < range.high ? range : DrawnRange();
}

std::string quantity(const Results& results, std::size_t pair) {
  return results.pairs[pair].bonded
             ? "normal traction (SPR-C)"
             : fmt::format("contact pressure ({})", name_of_pressure(results.pairs[pair].pressure_on_face));
}

/// Fragment of a triangle of the face: corners on paper (m), on the grid, pressure over the largest one.
using Fragment = std::array<RasterVertex, 3>;

/// The pressure of the contact rows at the corners of the triangles; those in which the contact zone ends are divided,
/// because the pressure falls like a square root there, or jumps where the other face ends.
class Fragments {
 public:
  /// Collects the triangles that reach into the paper.
  Fragments(const Results& results, const ContactSurface& surface, const Face& face, const FaceChart& chart,
            const Paper& paper)
      : body_(results.bodies[face.body]),
        range_(range_of(results, face.pair)),
        bonded_(results.pairs[face.pair].bonded),
        chart_(chart),
        fit_(results, face.body) {
    for (int i : face.index) {
      const auto& t = surface.triangles[i];
      const Vec3 x[3] = {surface.position[t[0]], surface.position[t[1]], surface.position[t[2]]};
      cell_ = surface.cell[i];
      near_ = (x[0] + x[1] + x[2]) / 3;
      if (!reaches(paper, {chart_.position(x[0], near_), chart_.position(x[1], near_), chart_.position(x[2], near_)}))
        continue;
      Corner corners[3];
      for (int v = 0; v < 3; ++v) corners[v] = corner(x[v]);
      divide(corners[0], corners[1], corners[2], max_divisions);
    }
  }

  const std::vector<Fragment>& all() const { return fragments_; }

  /// Draws the line where the pressure passes a fraction of the largest one on the side towards the viewer, for
  /// gnuplot.
  std::string contour(double fraction, const DisplayUnit& unit) const {
    std::string lines;
    for (const Fragment& fragment : fragments_) {
      const Vec3 side = fragment[1].position - fragment[0].position,
                 other = fragment[2].position - fragment[0].position;
      if (side[0] * other[1] - side[1] * other[0] <= 0) continue;
      int found = 0;
      for (int v = 0; v < 3; ++v) {
        const RasterVertex &a = fragment[v], &b = fragment[(v + 1) % 3];
        if ((a.value > fraction) == (b.value > fraction)) continue;
        const Vec3 x = a.position + (fraction - a.value) / (b.value - a.value) * (b.position - a.position);
        fmt::format_to(std::back_inserter(lines), "{:.7g} {:.7g}\n", x[0] * unit.factor, x[1] * unit.factor);
        ++found;
      }
      if (found > 0) lines += "\n";
    }
    return lines;
  }

 private:
  static constexpr int max_divisions = 3;
  struct Corner {
    Vec3 x;
    double value;
  };

  static bool reaches(const Paper& paper, const std::array<Vec3, 3>& corners) {
    for (int k = 0; k < 2; ++k) {
      const auto [low, high] = std::minmax({corners[0][k], corners[1][k], corners[2][k]});
      const double slack = 0.05 * paper.largest();
      if (high < paper.low[k] - slack || low > paper.high[k] + slack) return false;
    }
    return true;
  }

  Corner corner(const Vec3& x) {
    const auto values = fit_.at(x, body_.cut_cells->h(cell_));
    const double pressure = values && std::isfinite(values->pressure) ? values->pressure : 0;
    return {x, (pressure - range_.low) / (range_.high - range_.low)};
  }

  void divide(const Corner& a, const Corner& b, const Corner& c, int divisions) {
    const int pressed = (a.value > zone_end) + (b.value > zone_end) + (c.value > zone_end);
    if (!bonded_ && divisions > 0 && pressed > 0 && pressed < 3) {
      const Corner ab = corner((a.x + b.x) / 2), bc = corner((b.x + c.x) / 2), ca = corner((c.x + a.x) / 2);
      divide(a, ab, ca, divisions - 1);
      divide(ab, b, bc, divisions - 1);
      divide(ca, bc, c, divisions - 1);
      divide(ab, bc, ca, divisions - 1);
      return;
    }
    const double cells_per_unit = 1 / body_.cut_cells->size(cell_);
    const auto vertex = [&](const Corner& p) {
      return RasterVertex{chart_.position(p.x, near_), cells_per_unit * body_.cut_cells->grid.to_grid(p.x), p.value};
    };
    fragments_.push_back(chart_.mirrored() ? Fragment{vertex(a), vertex(c), vertex(b)}
                                           : Fragment{vertex(a), vertex(b), vertex(c)});
  }

  const BodyFields& body_;
  const DrawnRange range_;
  const bool bonded_;
  const FaceChart& chart_;
  ContactFit fit_;
  int cell_ = 0;
  Vec3 near_;
  std::vector<Fragment> fragments_;
};

GnuplotTitle title_of(const Results& results, const Face& face, int width) {
  const std::string what = results.pairs[face.pair].bonded ? "Bonded: " : "Contact pressure: ";
  return gnuplot_title(what + results.pairs[face.pair].name, width, png_pixels(15));
}

/// Script of the map of a face, NAME.png, and where its pixels lie.
std::pair<std::string, LayeredPicture> map_script(const Results& results, const ContactSurface& surface,
                                                  const Face& face, const FaceChart& chart, const Paper& paper,
                                                  const std::string& name, const std::string& folder) {
  const double margin = 0.02 * paper.largest();
  Camera camera;
  camera.right = Vec3::UnitX();
  camera.up = Vec3::UnitY();
  camera.eye = Vec3::UnitZ();
  camera.pixels_per_metre = map_side / (paper.largest() + 2 * margin);
  std::array<int, 2> size;
  for (int k = 0; k < 2; ++k) {
    camera.low[k] = paper.low[k] - margin;
    size[k] = static_cast<int>(std::ceil((paper.extent(k) + 2 * margin) * camera.pixels_per_metre));
  }
  const Fragments fragments(results, surface, face, chart, paper);
  const auto triangle = [&](std::size_t k) { return RasterTriangle{fragments.all()[k], 0}; };
  write_text(folder + "/" + name + ".rgb",
             render(size, camera, results.pairs[face.pair].bonded ? palette_colour : pressure_colour, 0,
                    fragments.all().size(), triangle)
                 .pixels);
  const DisplayUnit length = unit_of(paper);
  const std::string lines = results.pairs[face.pair].bonded ? "" : fragments.contour(zone_end, length);
  if (!lines.empty()) write_text(folder + "/" + name + ".dat", lines);

  const DrawnRange range = range_of(results, face.pair);
  const DisplayUnit stress = stress_unit(std::max(-range.low, range.high));
  const int left = 110, right = 180, bottom = 125;
  const double width = size[0] + left + right;
  const GnuplotTitle title =
      title_of(results, face, static_cast<int>(width) - (right - left) - 20);  // centred over the map
  const int top = 40 + 20 * title.lines;
  const double height = size[1] + bottom + top;
  std::string script =
      fmt::format("set terminal pngcairo size {},{} noenhanced font 'sans-serif,14' transparent\n", width, height);
  script += fmt::format("set output '../{}.png'\nset title {}\n", name, title.text);
  script += fmt::format(
      "set lmargin at screen {}\nset rmargin at screen {}\nset bmargin at screen {}\nset tmargin at screen {}\n",
      left / width, (left + size[0]) / width, bottom / height, (bottom + size[1]) / height);
  script += size[0] < 300 ? "set xtics rotate by -60\n" : "set xtics norotate\n";
  script += fmt::format("set key at screen {},{} right bottom horizontal Left reverse samplen 2.6\n",
                        (left + size[0]) / width, 12 / height);
  script += fmt::format("set cbrange [{}:{}]\nset cblabel '{} [{}]'\n", range.low * stress.factor,
                        range.high * stress.factor, quantity(results, face.pair), stress.name);
  script += fmt::format("set colorbox user origin screen {},{} size screen {},{}\n", (left + size[0] + 25) / width,
                        bottom / height, 24 / width, size[1] / height);
  const double step = length.factor / camera.pixels_per_metre;
  const double x = camera.low[0] * length.factor, y = camera.low[1] * length.factor;
  script += fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\n", x, x + size[0] * step, y, y + size[1] * step);
  script += fmt::format("set xlabel '{} [{}]'\nset ylabel '{} [{}]'\n", chart.right_name(), length.name,
                        chart.up_name(), length.name);
  script += "plot '+' using 1:(NaN):1 with points palette notitle";
  if (!lines.empty())
    script += fmt::format(", \\\n  '{}.dat' with lines lc rgb 'black' lw 2 title 'edge of the contact zone'", name);
  return {script + "\n", {name + ".png", {{folder + "/" + name + ".rgb", size[0], size[1], 1.0 * left, 1.0 * bottom}}}};
}

/// How a face is drawn: a map, or a curve along an axis of the chart.
struct FaceLayout {
  FaceChart chart;
  Paper paper;                   ///< that is shown
  std::optional<int> axis;       ///< of the curve (0: right, 1: up); none: a map
  bool section = false;          ///< nothing varies across the curve
  std::optional<SceneBox> part;  ///< of space that the curve is drawn of; none: all
  bool all = true;               ///< the whole face is shown
  double hidden = 0;             ///< by a curve of means, see hidden_by_means()
  std::array<Vec3, 2> tips{};    ///< m, where the face begins and ends along the curve
  bool holds(const Vec3& x) const {
    return !part || ((x - part->low).minCoeff() >= 0 && (part->high - x).minCoeff() >= 0);
  }
};

/// Points of the face that are the first and the last along an axis of the chart.
std::array<Vec3, 2> tips_of(const FaceTriangles& shape, const FaceChart& chart, int axis) {
  std::array<Vec3, 2> tips{Vec3::Zero(), Vec3::Zero()};
  double low = std::numeric_limits<double>::max(), high = -low;
  for (const auto& t : shape.triangles)
    for (int p : t) {
      const Vec3& x = (*shape.position)[p];
      const double s = chart.position(x, centroid(shape, t))[axis];
      if (s < low) tips[0] = x;
      if (s > high) tips[1] = x;
      low = std::min(low, s);
      high = std::max(high, s);
    }
  return tips;
}

/// The face of a section (plane strain, revolution) around the zone. across: nothing varies along it.
FaceLayout layout_of_section(const FaceTriangles& face, const FaceTriangles& zone, const Vec3& across,
                             double cell_size) {
  SceneBox box;
  for (const auto& t : zone.triangles)
    for (int p : t) box.add((*zone.position)[p]);
  const Vec3 along = box.extent() - across.cwiseAbs().cwiseProduct(box.extent());
  const double margin = std::max(zone_margin * along.norm(), zone_margin_cells * cell_size);
  box.low.array() -= margin;
  box.high.array() += margin;
  FaceTriangles part{face.position, {}};
  for (const auto& t : face.triangles) {
    SceneBox triangle;
    for (int p : t) triangle.add((*face.position)[p]);
    if ((triangle.high - box.low).minCoeff() >= 0 && (box.high - triangle.low).minCoeff() >= 0)
      part.triangles.push_back(t);
  }
  const FaceChart chart(part);
  FaceLayout layout{chart, bounds(part, chart), chart.axis_across(across), true, box, true, 0, {}};
  layout.paper.low[1 - *layout.axis] = layout.paper.high[1 - *layout.axis] = 0;
  layout.all = part.triangles.size() == face.triangles.size();
  layout.tips = tips_of(part, chart, *layout.axis);
  return layout;
}

bool is_thin(const FaceTriangles& face) {
  const Paper whole = bounds(face, FaceChart(face));
  return std::min(whole.extent(0), whole.extent(1)) < thin_face * whole.largest();
}

/// `curve`: of means across the face, else a map.
FaceLayout layout_of_face(const FaceTriangles& face, const FaceTriangles& zone, double cell_size, bool curve) {
  const FaceChart chart(face);
  const Paper whole = bounds(face, chart);
  FaceLayout layout{curve ? chart : FaceChart(zone), whole, std::nullopt, false, std::nullopt, true, 0, {}};
  const Paper all = bounds(face, layout.chart);
  layout.paper = zoomed(bounds(zone, layout.chart), all, cell_size);
  layout.all = layout.paper.largest() >= 0.99 * all.largest();
  if (!curve) return layout;
  layout.axis = layout.paper.extent(0) >= layout.paper.extent(1) ? 0 : 1;
  layout.tips = tips_of(face, chart, *layout.axis);
  return layout;
}

/// Sums over the rows in a bin of a curve.
struct Bin {
  double coordinate = 0, pressure = 0, square = 0, closed = 0, weight = 0;
  bool is_closed() const { return 2 * closed > weight; }
};

/// Means across a curve of one body, m and Pa.
struct MeanCurve {
  int body;
  std::vector<CurvePoint> points;
  std::vector<double> borders;  ///< of closed points, m
};

/// m, of the bins of a body's curve: small ones where rows beside each other have one pressure.
double bin_width(const Results& results, int body, const FaceLayout& layout) {
  const double least = layout.paper.extent(*layout.axis) / max_bins;
  return layout.section ? least : std::max(bin_in_cells * smallest_cell(results, body), least);
}

/// The bins of a body's curve, by number.
std::map<long long, Bin> bins_of(const Results& results, const Face& face, const FaceLayout& layout, int body) {
  const double width = bin_width(results, body, layout);
  std::map<long long, Bin> bins;
  for (const ContactRow& row : results.contact_rows) {
    if (row.body != body || row.pair != static_cast<int>(face.pair) || !layout.holds(row.x)) continue;
    if (!std::isfinite(row.distance)) continue;  // beyond the end of the other face
    const double s = layout.chart.position(row.x)[*layout.axis];
    Bin& bin = bins[std::llround(s / width)];
    bin.coordinate += row.weight * s;
    bin.pressure += row.weight * row.pressure_sprc;
    bin.square += row.weight * row.pressure_sprc * row.pressure_sprc;
    bin.closed += row.active ? row.weight : 0;
    bin.weight += row.weight;
  }
  return bins;
}

/// Returns the root mean square over the face of what a curve of means hides, relative to that of the pressure.
double hidden_by_means(const Results& results, const Face& face, const FaceLayout& layout) {
  double hidden = 0, whole = 0;
  for (const auto& [number, bin] : bins_of(results, face, layout, face.body)) {
    if (!(bin.weight > 0)) continue;
    hidden += bin.square - bin.pressure * bin.pressure / bin.weight;
    whole += bin.square;
  }
  return whole > 0 ? std::sqrt(std::max(0.0, hidden / whole)) : 0;
}

std::vector<MeanCurve> mean_curves(const Results& results, const Face& face, const FaceLayout& layout) {
  std::vector<MeanCurve> curves;
  for (int b = 0; b < static_cast<int>(results.bodies.size()); ++b) {
    MeanCurve curve{b, {}, {}};
    const Bin* previous = nullptr;
    const std::map<long long, Bin> bins = bins_of(results, face, layout, b);
    for (const auto& [number, bin] : bins) {
      if (!(bin.weight > 0)) continue;
      curve.points.push_back({bin.coordinate / bin.weight, bin.pressure / bin.weight});
      if (previous && previous->is_closed() != bin.is_closed())
        curve.borders.push_back((previous->coordinate / previous->weight + bin.coordinate / bin.weight) / 2);
      previous = &bin;
    }
    if (previous) curves.push_back(std::move(curve));
  }
  return curves;
}

/// Finds the ends of the face at which planes of symmetry cut the zone: behind them one more bin would lie.
std::vector<CurveEnd> ends_of_face(const Results& results, const Face& face, const FaceLayout& layout,
                                   const std::vector<MeanCurve>& curves) {
  std::vector<CurveEnd> ends;
  const auto curve =
      std::find_if(curves.begin(), curves.end(), [&](const MeanCurve& c) { return c.body == face.body; });
  if (curve == curves.end()) return ends;
  const double step = bin_width(results, face.body, layout), largest = highest(results.pairs[face.pair]);
  for (const int tip : {0, 1}) {
    const double pressure = (tip == 0 ? curve->points.front() : curve->points.back())[1];
    const Vec3& x = layout.tips[tip];
    const double forward = tip == 0 ? -step : step;
    const CurveTip at{layout.chart.position(x)[*layout.axis], x, forward * layout.chart.direction(*layout.axis, x),
                      forward};
    if (!(pressure > zone_end * largest)) continue;
    if (const auto end = end_at_plane(at, results.pairs[face.pair].zone.planes)) ends.push_back(*end);
  }
  return ends;
}

/// Range of a curve's axis, mirror images included.
std::array<double, 2> range_of(const Paper& paper, int axis, const std::vector<CurveEnd>& ends) {
  std::array<double, 2> range{paper.low[axis], paper.high[axis]};
  for (const CurveEnd& end : ends)
    for (const double s : {paper.low[axis], paper.high[axis]})
      if (end.across) range = {std::min(range[0], end.mirrored(s)), std::max(range[1], end.mirrored(s))};
  return range;
}

/// Coordinate and pressure, one block per body; then their mirror images, end by end.
std::string curve_data(const std::vector<MeanCurve>& curves, const std::vector<CurveEnd>& ends,
                       const DisplayUnit& length, const DisplayUnit& stress) {
  std::string data;
  const auto add = [&](const std::vector<CurvePoint>& points) {
    for (const auto& [s, pressure] : points)
      fmt::format_to(std::back_inserter(data), "{} {}\n", s * length.factor, pressure * stress.factor);
    data += "\n\n";
  };
  for (const MeanCurve& curve : curves) add(curve.points);
  for (const CurveEnd& end : ends)
    for (const MeanCurve& curve : curves) add(mirror_image(curve.points, end));
  return data;
}

/// Arguments of gnuplot's command plot.
std::string curve_plots(const Results& results, const std::vector<MeanCurve>& curves, const std::vector<CurveEnd>& ends,
                        double largest_length, const std::string& name) {
  std::string script;
  for (std::size_t k = 0; k < curves.size(); ++k)
    script += fmt::format("{}'{}.dat' index {} with lines lc rgb '#d2501e' lw {} dt {} title {}", k ? ", \\\n  " : "",
                          name, k, k ? 1.6 : 2.4, k ? "(6,4)" : "1",
                          gnuplot_text(shortened_name(results.bodies[curves[k].body].name, longest_entry)));
  for (std::size_t e = 0; e < ends.size(); ++e) {
    const std::string plane = name_of(ends[e].plane, largest_length);
    for (std::size_t k = 0; k < curves.size() && ends[e].across; ++k)
      script += fmt::format(", \\\n  '{}.dat' index {} with lines lc rgb '{}' lw {} dt {} {}", name,
                            (e + 1) * curves.size() + k, mirrored_colour, k ? 1.6 : 2.4, k ? "(6,4)" : "1",
                            k ? "notitle" : "title " + gnuplot_text("mirrored at " + plane));
    if (!ends[e].across)
      script += fmt::format(", \\\n  NaN with lines lc rgb '{}' dt {} title {}", plane_colour, plane_dashes,
                            gnuplot_text("ends at symmetry, " + plane));
  }
  return script;
}

/// Curve along a face of which nothing or only a mean is shown across.
std::string curve_script(const Results& results, const Face& face, const FaceLayout& layout, const std::string& name,
                         const std::string& folder) {
  const int axis = *layout.axis;
  const FaceChart& chart = layout.chart;
  const DrawnRange range = range_of(results, face.pair);
  const std::vector<MeanCurve> curves = mean_curves(results, face, layout);
  const std::vector<CurveEnd> ends = ends_of_face(results, face, layout, curves);
  const std::array<double, 2> shown = range_of(layout.paper, axis, ends);
  const DisplayUnit length = unit_of(layout.paper), stress = stress_unit(std::max(-range.low, range.high));
  write_text(folder + "/" + name + ".dat", curve_data(curves, ends, length, stress));
  std::string script = "set terminal pngcairo size 900,520 noenhanced font 'sans-serif,14' background 'white'\n";
  script += fmt::format("set output '../{}.png'\nset title {}\nset grid lc rgb '#e4e4e4' lw 1 dt 1\n", name,
                        title_of(results, face, 800).text);
  script +=
      "set xtics norotate\nset key outside top right horizontal Left reverse samplen 2.6\nunset colorbox\nset lmargin "
      "-1\nset rmargin "
      "-1\nset bmargin -1\nset tmargin -1\n";
  script +=
      fmt::format("set xlabel '{} [{}]'\nset ylabel '{} [{}]'\n", axis == 0 ? chart.right_name() : chart.up_name(),
                  length.name, quantity(results, face.pair), stress.name);
  script += fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\n", shown[0] * length.factor, shown[1] * length.factor,
                        1.08 * range.low * stress.factor, 1.08 * range.high * stress.factor);
  const auto line = [&](double s, const char* style) {
    script += fmt::format("set arrow from {0}, graph 0 to {0}, graph 1 nohead lc rgb {1}\n", s * length.factor, style);
  };
  bool has_borders = false;
  for (const MeanCurve& curve : curves)
    for (const double s : curve.borders)
      if (curve.body == face.body) {
        line(s, "'#606060' dt (6,4)");
        has_borders = true;
      }
  for (const CurveEnd& end : ends) line(end.s, fmt::format("'{}' dt {}", plane_colour, plane_dashes).c_str());
  script += "plot " + curve_plots(results, curves, ends, layout.paper.largest(), name);
  if (has_borders) script += ", \\\n  NaN with lines lc rgb '#606060' dt (6,4) title 'border of the closed points'";
  return script + "\nunset arrow\nunset grid\n";
}

/// A curve of means where the face is much longer than wide and the means hide little, else a map.
FaceLayout layout_of_face(const Results& results, const Face& face, const FaceTriangles& zone, double cell_size) {
  if (is_thin(face.shape)) {
    FaceLayout curve = layout_of_face(face.shape, zone, cell_size, true);
    curve.hidden = hidden_by_means(results, face, curve);
    if (curve.hidden < hidden_by_curve) return curve;
  }
  return layout_of_face(face.shape, zone, cell_size, false);
}

std::string caption_of(const Results& results, const Face& face, const FaceLayout& layout) {
  const std::string& body = results.bodies[face.body].name;
  std::string caption =
      layout.section ? std::string("Pressure along the contact face, across which nothing varies")
      : layout.axis  ? fmt::format(
                           "Pressure along the contact face, mean over its narrow side, across which it varies by "
                            "{} (root mean square)",
                           percent_number(layout.hidden) + " %")
      : results.pairs[face.pair].bonded
          ? fmt::format("Normal traction on the bonded face of {} with its cells, pressure positive", body)
          : fmt::format("Contact face of {} with its cells; grey: no pressure (below 0.5 % of the largest)", body);
  if (layout.chart.unrolled()) caption += "; the cylindrical face is unrolled";
  if (!layout.all) caption += "; only the surroundings of the contact zone are shown";
  return caption + ".";
}

}  // namespace

std::vector<std::size_t> pairs_to_draw(const Results& results) {
  std::vector<std::size_t> pairs(results.pairs.size());
  std::iota(pairs.begin(), pairs.end(), std::size_t{0});
  const auto force = [&](std::size_t k) {
    const double f = told_force(results.pairs[k]);
    return std::isfinite(f) ? f : 0;
  };
  std::stable_sort(pairs.begin(), pairs.end(), [&](std::size_t a, std::size_t b) { return force(a) > force(b); });
  pairs.resize(std::min(pairs.size(), max_maps));
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::vector<PressureMap> write_pressure_maps(const Results& results, const ContactSurface& surface, GnuplotRuns& runs) {
  std::vector<PressureMap> maps;
  std::vector<LayeredPicture> pictures;
  std::string script = "set encoding utf8\nset border 3 lc rgb '#404040'\nset tics nomirror out\n" + gnuplot_palette();
  for (std::size_t pair : pairs_to_draw(results)) {
    const Face face = face_of_pair(results, surface, pair);
    if (face.body < 0 || !results.bodies[face.body].stress_recovered) continue;
    const double cell_size = smallest_cell(results, face.body);
    const FaceTriangles zone =
        results.pairs[pair].bonded ? face.shape : zone_of(surface, face, highest(results.pairs[pair]));
    const Paper whole = bounds(face.shape, FaceChart(face.shape));
    if (!(whole.largest() > 0) || !std::isfinite(whole.largest())) continue;
    const Grid& grid = results.bodies[face.body].cut_cells->grid;
    const FaceLayout layout = grid.plane_strain >= 0
                                  ? layout_of_section(face.shape, zone, grid.rotation.col(grid.plane_strain), cell_size)
                                  : layout_of_face(results, face, zone, cell_size);
    const std::string name = pair == 0 ? "pressure_map" : fmt::format("pressure_map_{}", pair + 1);
    const std::string folder = runs.directory() + "/plots";
    if (layout.axis) {
      script += curve_script(results, face, layout, name, folder);
      pictures.push_back({name + ".png", {}});
    } else {
      auto [map, picture] = map_script(results, surface, face, layout.chart, layout.paper, name, folder);
      script += map;
      pictures.push_back(std::move(picture));
    }
    maps.push_back({pair, pictures.back().name, caption_of(results, face, layout)});
  }
  if (!maps.empty()) runs.start_layered("pressure_map", script, std::move(pictures));
  return maps;
}

}  // namespace cgcontact
