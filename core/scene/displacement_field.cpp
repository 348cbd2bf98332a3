#include "core/scene/displacement_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include "core/base/errors/errors.hpp"
#include "core/base/errors/suggest.hpp"
#include "core/base/files/hdf_file.hpp"
#include "core/base/files/json.hpp"
#include "core/base/files/text.hpp"
#include "core/triangles/triangle_surface.hpp"

namespace cgcontact {

namespace {

namespace fs = std::filesystem;

constexpr int box_corners = 8, tetrahedron_corners = 4;
/// Which end of the axes of a box a corner lies at, and the corners that its edges from the first one lead to.
constexpr int end_of_corner[box_corners][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                               {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
constexpr int end_of_edge[3] = {1, 3, 4};

/// A body as report.json has it.
struct ReportedBody {
  int number = -1;
  double cell_size = 0;  ///< m
  std::string kind;      ///< as kind_of
};

const char* const in_space = "in three dimensions";
std::string in_plane_strain(const std::string& axis) { return "in plane strain across " + axis; }
std::string of_revolution(const std::string& axis) { return "as a body of revolution about " + axis; }

/// How a body is computed.
std::string kind_of(const BodySpec& body) {
  if (body.axisymmetric()) return of_revolution(coordinate_names()[body.axis_of_revolution()]);
  return body.plane_strain ? in_plane_strain(name_of(*body.plane_strain)) : in_space;
}

std::string kind_of(const Json& body) {
  if (body.contains("axisymmetric")) return of_revolution(body["axisymmetric"].get<std::string>());
  return body.contains("plane_strain") ? in_plane_strain(body["plane_strain"].get<std::string>()) : in_space;
}

/// The body of a name in the report of a run that converged.
ReportedBody reported_body(const std::string& report, const std::string& name) try {
  const Json json = Json::parse(read_text(report));
  if (json.at("program") != "cgcontact") throw InputError(report + " is not a report of cgcontact");
  if (!json.at("converged").get<bool>()) throw InputError("this result did not converge");
  std::vector<std::string> names;
  for (const Json& body : json.at("bodies")) {
    const int number = static_cast<int>(names.size());
    names.push_back(body.at("name").get<std::string>());
    if (names.back() == name) return {number, body.at("cell_size").get<double>(), kind_of(body)};
  }
  throw InputError(
      fmt::format("this result has no body \"{}\"{}: it has {}", name, did_you_mean(name, names), join(names)));
} catch (const Json::exception& error) {
  throw InputError(fmt::format("{} is not a report of cgcontact ({})", report, error.what()));
}

/// The arrays of a VTKHDF file.
class Arrays {
 public:
  explicit Arrays(const std::string& file) : file_(file) {
    for (const std::string group : {"/VTKHDF", "/VTKHDF/PointData", "/VTKHDF/CellData"})
      for (const HdfReader::Array& array : file_.arrays(group)) arrays_[array.path] = array;
  }

  std::size_t num_rows(const std::string& name) const { return array(name).rows; }

  /// Returns rows of the array, one behind the other.
  template <class T>
  std::vector<T> read(const std::string& name, std::size_t first, std::size_t count) const {
    const HdfReader::Array& found = array(name);
    if (found.bytes != sizeof(T)) throw InputError(fmt::format("its {} are {}", name, found.type));
    const std::string bytes = file_.read(found, first, count);
    std::vector<T> values(bytes.size() / sizeof(T));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }

  /// Returns rows of an array of vectors.
  template <class T>
  std::vector<Vec3> read_vectors(const std::string& name, std::size_t first, std::size_t count) const {
    const std::vector<T> values = read<T>(name, first, count);
    if (values.size() != 3 * count) throw InputError(fmt::format("its {} are no vectors", name));
    std::vector<Vec3> vectors(count);
    for (std::size_t i = 0; i < count; ++i) vectors[i] = Vec3(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
    return vectors;
  }

 private:
  const HdfReader::Array& array(const std::string& name) const {
    const auto found = arrays_.find("/VTKHDF/" + name);
    if (found == arrays_.end()) throw InputError("it has no " + name);
    return found->second;
  }

  HdfReader file_;
  std::map<std::string, HdfReader::Array> arrays_;
};

}  // namespace

DisplacementField::DisplacementField(const std::string& directory, const BodySpec& body)
    : across_(body.plane_strain ? static_cast<int>(*body.plane_strain) : -1) {
  const fs::path folder = directory, report = folder / "report.json", cells = folder / "result.vtkhdf";
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw InputError("there is no directory " + folder.string());
  if (!fs::is_regular_file(report, error))
    throw InputError(folder.string() + " is no result of a run: it holds no report.json");
  const ReportedBody reported = reported_body(report.string(), body.name);
  if (const std::string kind = kind_of(body); reported.kind != kind)
    throw InputError(fmt::format("body \"{}\" is computed {} there and {} here", body.name, reported.kind, kind));
  if (!fs::is_regular_file(cells, error))
    throw InputError("this result has no displacements: it holds no result.vtkhdf (output.vtk = false)");
  cell_size_ = reported.cell_size;
  try {
    read_cells(cells.string(), reported.number);
  } catch (const std::runtime_error& failed) {
    throw InputError(fmt::format("{} cannot be read: {}", cells.string(), failed.what()));
  }
  make_tree();
}

/// Reads points and cells of a body, which follow those of the bodies before it.
void DisplacementField::read_cells(const std::string& file, int body) {
  const Arrays arrays(file);
  const std::vector<int> body_of_cell = arrays.read<int>("CellData/body", 0, arrays.num_rows("CellData/body"));
  const auto [begin, end] = std::equal_range(body_of_cell.begin(), body_of_cell.end(), body);
  if (begin == end) throw InputError("it has no cells of the body");
  const std::vector<long long> offsets = arrays.read<long long>(
      "Offsets", static_cast<std::size_t>(begin - body_of_cell.begin()), static_cast<std::size_t>(end - begin) + 1);
  for (const long long offset : offsets) first_corner_.push_back(static_cast<int>(offset - offsets.front()));
  for (int cell = 0; cell + 1 < static_cast<int>(offsets.size()); ++cell)
    if (const int n = num_corners(cell); n != box_corners && n != tetrahedron_corners)
      throw InputError(fmt::format("it has a cell of {} points", n));
  const std::vector<long long> corners = arrays.read<long long>("Connectivity", static_cast<std::size_t>(offsets[0]),
                                                                static_cast<std::size_t>(first_corner_.back()));
  const auto [first, last] = std::minmax_element(corners.begin(), corners.end());
  for (const long long corner : corners) corners_.push_back(static_cast<int>(corner - *first));
  const auto first_point = static_cast<std::size_t>(*first), num_points = static_cast<std::size_t>(*last - *first) + 1;
  points_ = arrays.read_vectors<double>("Points", first_point, num_points);
  displacements_ = arrays.read_vectors<float>("PointData/displacement", first_point, num_points);
}

/// A triangle with two corners of the box around a cell stands for the cell: it has the same box.
void DisplacementField::make_tree() {
  std::vector<Vec3> ends;
  std::vector<Triangle> boxes;
  for (int cell = 0; cell + 1 < static_cast<int>(first_corner_.size()); ++cell) {
    Vec3 low = corner(cell, 0), high = low;
    for (int k = 1; k < num_corners(cell); ++k) {
      low = low.cwiseMin(corner(cell, k));
      high = high.cwiseMax(corner(cell, k));
    }
    const int n = static_cast<int>(ends.size());
    ends.insert(ends.end(), {low, high});
    boxes.push_back({n, n + 1, n + 1});
  }
  tree_ = TriangleTree(ends, boxes);
}

DisplacementField::Value DisplacementField::at(Vec3 x) const {
  if (across_ >= 0) x[across_] = 0.5 * (tree_.min()[across_] + tree_.max()[across_]);
  Value value{Vec3::Zero(), 0};
  double least = std::numeric_limits<double>::infinity();  // squared distance
  tree_.visit_nearest(
      x, -1, [&] { return least; },
      [&](int cell) {
        if (least == 0) return;
        const bool is_box = num_corners(cell) == box_corners;
        const Place place = is_box ? nearest_in_box(cell, x) : nearest_in_tetrahedron(cell, x);
        const double distance = (place.x - x).squaredNorm();
        if (!(distance < least)) return;
        least = distance;
        value.displacement.setZero();
        for (int k = 0; k < num_corners(cell); ++k)
          value.displacement += place.shares[k] * displacements_[corners_[first_corner_[cell] + k]];
      });
  value.distance = std::sqrt(least);
  return value;
}

/// The edges of a box are at right angles: the nearest place is found edge by edge.
DisplacementField::Place DisplacementField::nearest_in_box(int cell, const Vec3& x) const {
  const Vec3& origin = corner(cell, 0);
  Place place{origin, {}};
  double way[3];  // fraction of the edge
  for (int d = 0; d < 3; ++d) {
    const Vec3 edge = corner(cell, end_of_edge[d]) - origin;
    const double wanted = edge.dot(x - origin) / edge.squaredNorm();
    way[d] = std::clamp(wanted, 0.0, 1.0);
    place.x += way[d] * edge;
  }
  for (int k = 0; k < box_corners; ++k) {
    place.shares[k] = 1;
    for (int d = 0; d < 3; ++d) place.shares[k] *= end_of_corner[k][d] ? way[d] : 1 - way[d];
  }
  return place;
}

DisplacementField::Place DisplacementField::nearest_in_tetrahedron(int cell, const Vec3& x) const {
  Place place{x, shares_in_tetrahedron(cell, x)};
  const auto negative = [](double share) { return share < 0; };
  if (std::none_of(place.shares.begin(), place.shares.end(), negative)) return place;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& face : {Index3{1, 2, 3}, Index3{0, 2, 3}, Index3{0, 1, 3}, Index3{0, 1, 2}}) {
    int feature = 0;
    const Vec3 point =
        nearest_on_triangle(x, corner(cell, face[0]), corner(cell, face[1]), corner(cell, face[2]), feature);
    const double distance = (point - x).squaredNorm();
    if (!(distance < least)) continue;
    least = distance;
    place.x = point;
  }
  place.shares = shares_in_tetrahedron(cell, place.x);
  double sum = 0;
  for (double& share : place.shares) sum += share = std::max(share, 0.0);  // on a face, but for rounding
  for (double& share : place.shares) share /= sum;
  return place;
}

/// Returns the parts of the volume opposite of the corners, negative where x is outside.
std::array<double, 8> DisplacementField::shares_in_tetrahedron(int cell, const Vec3& x) const {
  const Vec3& origin = corner(cell, 0);
  const Vec3 a = corner(cell, 1) - origin, b = corner(cell, 2) - origin, c = corner(cell, 3) - origin, p = x - origin;
  const double volume = a.dot(b.cross(c));
  std::array<double, 8> shares{};
  shares[1] = p.dot(b.cross(c)) / volume;
  shares[2] = a.dot(p.cross(c)) / volume;
  shares[3] = a.dot(b.cross(p)) / volume;
  shares[0] = 1 - shares[1] - shares[2] - shares[3];
  return shares;
}

}  // namespace cgcontact
