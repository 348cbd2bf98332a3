#include "contact/face_pressure.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "core/output_text.hpp"

namespace cgcontact {

namespace {

constexpr std::size_t num_columns = 14;
constexpr std::size_t fewest_points = 3;  ///< for a fit
/// The nearest ones are used: all within a cell smooth the steep end of a contact zone away. Beyond their farthest one
/// the weight ends by so much.
constexpr std::size_t most_points = 6;
constexpr double margin = 1.25;

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

int body_index(const Scene& scene, const std::string& name) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    if (scene.bodies[b].name == name) return static_cast<int>(b);
  return -1;
}

}  // namespace

std::vector<ContactRow> read_contact_rows(const std::string& file, const Scene& scene) {
  std::istringstream text(read_text(file));
  std::vector<ContactRow> rows;
  std::string line;
  std::getline(text, line);  // names of the columns
  while (std::getline(text, line)) {
    const std::vector<std::string> fields = fields_of(line);
    ContactRow row;
    row.body = fields.size() == num_columns ? body_index(scene, fields[0]) : -1;
    if (row.body < 0) throw InputError(fmt::format("{} is not a contact.csv of this scene", file));
    const auto number = [&](int column) { return std::strtod(fields[column].c_str(), nullptr); };
    row.x = Vec3(number(1), number(2), number(3));
    row.weight = number(7);
    row.pressure_raw = number(9);
    row.pressure_spr = number(10);
    row.pressure_sprc = number(11);
    rows.push_back(row);
  }
  return rows;
}

FacePressure::FacePressure(std::vector<ContactRow> rows, double reach) : rows_(std::move(rows)), reach_(reach) {
  for (int r = 0; r < static_cast<int>(rows_.size()); ++r) buckets_[bucket(rows_[r].body, rows_[r].x)].push_back(r);
}

FacePressure::Bucket FacePressure::bucket(int body, const Vec3& x) const {
  Bucket key{body, 0, 0, 0};
  for (int k = 0; k < 3; ++k) key[k + 1] = static_cast<long long>(std::floor(x[k] / reach_));
  return key;
}

double FacePressure::nearest(int body, const Vec3& x) const {
  double distance = std::numeric_limits<double>::max(), pressure = 0;
  for (const ContactRow& row : rows_) {
    const double d = (row.x - x).squaredNorm();
    if (row.body != body || d >= distance) continue;
    distance = d;
    pressure = row.pressure_sprc;
  }
  return pressure;
}

double FacePressure::operator()(int body, const Vec3& x) const {
  std::vector<std::pair<double, int>> nearby;  // distance, row
  const Bucket centre = bucket(body, x);
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      for (int k = -1; k <= 1; ++k) {
        const auto found = buckets_.find({centre[0], centre[1] + i, centre[2] + j, centre[3] + k});
        if (found == buckets_.end()) continue;
        for (const int r : found->second) {
          const double distance = (rows_[r].x - x).norm();
          if (distance < reach_) nearby.emplace_back(distance, r);
        }
      }
  if (nearby.size() < fewest_points) return nearest(body, x);
  const std::size_t count = std::min(nearby.size(), most_points);
  std::partial_sort(nearby.begin(), nearby.begin() + static_cast<std::ptrdiff_t>(count), nearby.end());
  nearby.resize(count);
  const double radius = std::max(margin * nearby.back().first, 1e-9 * reach_);  // points may coincide
  std::vector<std::pair<int, double>> near;                                     // row, weight
  for (const auto& [distance, r] : nearby) near.emplace_back(r, std::pow(1 - distance / radius, 2));
  // Mean, and the gradient about it.
  double sum = 0, mean = 0;
  Vec3 middle = Vec3::Zero();
  for (const auto& [r, weight] : near) {
    sum += weight * weight;
    mean += weight * weight * rows_[r].pressure_sprc;
    middle += weight * weight * rows_[r].x;
  }
  mean /= sum;
  middle /= sum;
  Eigen::MatrixX3d matrix(near.size(), 3);
  Eigen::VectorXd values(near.size());
  for (std::size_t k = 0; k < near.size(); ++k) {
    const auto& [r, weight] = near[k];
    matrix.row(k) = weight / radius * (rows_[r].x - middle);
    values[k] = weight * (rows_[r].pressure_sprc - mean);
  }
  // The smallest gradient: the points of a flat face say nothing about the direction across it.
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixX3d> decomposition;
  decomposition.setThreshold(1e-3);
  decomposition.compute(matrix);
  return mean + Vec3(decomposition.solve(values)).dot(x - middle) / radius;
}

}  // namespace cgcontact
