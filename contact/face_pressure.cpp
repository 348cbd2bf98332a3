#include "contact/face_pressure.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <cmath>
#include <limits>
#include <sstream>

#include "core/output_text.hpp"

namespace cgcontact {

namespace {

constexpr std::size_t num_columns = 13;
constexpr int fewest_points = 4;  ///< for a fit

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
  // Rows of the fit: weight * (1, (point - x) / reach), weight * pressure.
  std::vector<std::pair<Eigen::Vector4d, double>> fit;
  const Bucket centre = bucket(body, x);
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      for (int k = -1; k <= 1; ++k) {
        const auto found = buckets_.find({centre[0], centre[1] + i, centre[2] + j, centre[3] + k});
        if (found == buckets_.end()) continue;
        for (const int r : found->second) {
          const Vec3 d = (rows_[r].x - x) / reach_;
          const double weight = std::pow(1 - d.norm(), 2);
          if (d.norm() < 1)
            fit.emplace_back(weight * Eigen::Vector4d(1, d[0], d[1], d[2]), weight * rows_[r].pressure_sprc);
        }
      }
  if (static_cast<int>(fit.size()) < fewest_points) return nearest(body, x);
  Eigen::MatrixX4d matrix(fit.size(), 4);
  Eigen::VectorXd values(fit.size());
  for (std::size_t r = 0; r < fit.size(); ++r) {
    matrix.row(r) = fit[r].first;
    values[r] = fit[r].second;
  }
  // Smallest solution: the points of a flat face say nothing about the direction across it.
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixX4d> decomposition;
  decomposition.setThreshold(1e-3);
  decomposition.compute(matrix);
  return Eigen::Vector4d(decomposition.solve(values))[0];
}

}  // namespace cgcontact
