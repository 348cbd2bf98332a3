#include "contact/study/face_pressure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "core/base/files/text.hpp"
#include "core/base/numbers/decompositions.hpp"
#include "core/output/fields/output_csv.hpp"

namespace cgcontact {

namespace {

constexpr std::size_t min_points = 3;  ///< for a fit
/// Beside the end of a contact zone all within a cell would smooth it away. Beyond the farthest one the weight ends by
/// so much.
constexpr std::size_t max_points = 6;
constexpr double margin = 1.25;
constexpr double open_below = 1e-9;  ///< of the largest pressure: SPR-C leaves 1e-10 of it outside

int body_index(const Scene& scene, const std::string& name) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    if (scene.bodies[b].name == name) return static_cast<int>(b);
  return -1;
}

}  // namespace

std::vector<ContactRow> read_contact_rows(const std::string& file, const Scene& scene) {
  const auto refuse = [&] { throw InputError(fmt::format("{} is not a contact.csv of this scene", file)); };
  std::istringstream text(read_text(file));
  std::vector<ContactRow> rows;
  std::string line;
  std::getline(text, line);
  const std::vector<std::string> names = csv_fields(line);
  const auto column = [&](const char* name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) refuse();
    return static_cast<std::size_t>(found - names.begin());
  };
  const std::size_t body = column("body"), x = column("x"), y = column("y"), z = column("z"), weight = column("weight"),
                    raw = column("pressure_raw"), spr = column("pressure_spr"), sprc = column("pressure_sprc");
  while (std::getline(text, line)) {
    const std::vector<std::string> fields = csv_fields(line);
    if (fields.size() != names.size()) refuse();
    ContactRow row;
    row.body = body_index(scene, fields[body]);
    if (row.body < 0) refuse();
    const auto number = [&](std::size_t k) { return std::strtod(fields[k].c_str(), nullptr); };
    row.x = Vec3(number(x), number(y), number(z));
    row.weight = number(weight);
    row.pressure_raw = number(raw);
    row.pressure_spr = number(spr);
    row.pressure_sprc = number(sprc);
    rows.push_back(row);
  }
  return rows;
}

SampledPressure::SampledPressure(std::vector<ContactRow> rows, double reach) : rows_(std::move(rows)), reach_(reach) {
  double largest = 0;
  for (const ContactRow& row : rows_) largest = std::max(largest, std::abs(row.pressure_sprc));
  open_ = open_below * largest;
  for (int r = 0; r < static_cast<int>(rows_.size()); ++r) buckets_[bucket(rows_[r].body, rows_[r].x)].push_back(r);
}

SampledPressure::Bucket SampledPressure::bucket(int body, const Vec3& x) const {
  Bucket key{body, 0, 0, 0};
  for (int k = 0; k < 3; ++k) key[k + 1] = static_cast<long long>(std::floor(x[k] / reach_));
  return key;
}

std::vector<SampledPressure::Neighbour> SampledPressure::neighbours(int body, const Vec3& x) const {
  std::vector<Neighbour> found;
  const Bucket centre = bucket(body, x);
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      for (int k = -1; k <= 1; ++k) {
        const auto cube = buckets_.find({centre[0], centre[1] + i, centre[2] + j, centre[3] + k});
        if (cube == buckets_.end()) continue;
        for (const int r : cube->second) {
          const double distance = (rows_[r].x - x).norm();
          if (distance < reach_) found.push_back({distance, r});
        }
      }
  std::sort(found.begin(), found.end());
  return found;
}

double SampledPressure::nearest(int body, const Vec3& x) const {
  double distance = std::numeric_limits<double>::max(), pressure = 0;
  for (const ContactRow& row : rows_) {
    const double d = (row.x - x).squaredNorm();
    if (row.body != body || d >= distance) continue;
    distance = d;
    pressure = row.pressure_sprc;
  }
  return pressure;
}

SampledPressure::Linear SampledPressure::fit(const std::vector<Neighbour>& points, int power) const {
  const double radius = std::max(margin * points.back().first, 1e-9 * reach_);  // points may coincide
  const auto weight = [&](const Neighbour& point) { return std::pow(1 - point.first / radius, 2); };
  const auto value = [&](const Neighbour& point) { return std::pow(rows_[point.second].pressure_sprc, power); };
  // Mean, and the gradient about it.
  double sum = 0;
  Linear linear;
  for (const Neighbour& point : points) {
    const double w = std::pow(weight(point), 2);
    sum += w;
    linear.mean += w * value(point);
    linear.middle += w * rows_[point.second].x;
  }
  linear.mean /= sum;
  linear.middle /= sum;
  Eigen::MatrixXd matrix(points.size(), 3);
  Eigen::VectorXd values(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    matrix.row(k) = weight(points[k]) / radius * (rows_[points[k].second].x - linear.middle);
    values[k] = weight(points[k]) * (value(points[k]) - linear.mean);
  }
  // Smallest gradient: the points of a flat face say nothing about the direction across it.
  linear.gradient = least_squares(matrix, values, 1e-3) / radius;
  return linear;
}

double SampledPressure::operator()(int body, const Vec3& x) const {
  std::vector<Neighbour> points = neighbours(body, x);
  if (points.size() < min_points) return nearest(body, x);
  const auto is_open = [&](const Neighbour& point) { return std::abs(rows_[point.second].pressure_sprc) <= open_; };
  const auto open = std::find_if(points.begin(), points.end(), is_open);
  const auto closed = std::find_if_not(points.begin(), points.end(), is_open);
  if (open != points.end() && closed != points.end()) {
    const Vec3 &inside = rows_[closed->second].x, &outside = rows_[open->second].x;
    std::vector<Neighbour> zone = neighbours(body, inside);
    zone.erase(std::remove_if(zone.begin(), zone.end(), is_open), zone.end());
    const Linear square = fit(zone, 2);
    if (square(outside) < square(inside) / 2) return std::sqrt(std::max(0.0, square(x)));
  }
  points.resize(std::min(points.size(), max_points));
  return fit(points, 1)(x);
}

}  // namespace cgcontact
