/// The contact pressure of a solved scene as problems on its faces, one for each zone (recovery/face/face_zone.hpp).
#pragma once

#include <optional>

#include "contact/face/zone_chart.hpp"
#include "core/base/numbers/point_buckets.hpp"
#include "recovery/face/face_zone.hpp"
#include "recovery/patch/known_pressures.hpp"

namespace cgcontact {

/// A pressure and what it may be off, Pa.
struct PressureOnFace {
  double pressure = 0, error = 0;
  bool operator<(const PressureOnFace& other) const { return pressure < other.pressure; }
};

/// A zone whose pressure was solved for.
struct SolvedZone {
  int pair = 0, primary = 0;
  ZoneChart chart;
  double h = 0;             ///< m
  std::vector<char> known;  ///< patches on both faces
  /// Cosines between the normals of the primary face and of the chart at each patch: pressures are per area of the
  /// chart.
  std::vector<double> cosine;
  std::vector<double> height;  ///< of the primary face above the chart at each patch, m
  FacePressure pressure;
  std::vector<ZoneEdgeSegment> edge;  ///< points along it

  /// Returns the pressure at a point on the face of a body; none: the zone does not reach there.
  std::optional<PressureOnFace> at(int body, const Vec3& x, const Vec3& normal) const;
  /// Returns the square of the pressure there, Pa^2; negative outside of the zone.
  std::optional<double> square_at(int body, const Vec3& x, const Vec3& normal) const;

 private:
  struct ChartPoint {
    FacePosition position;
    int patch;
    double cosine;  ///< between the normals of the body's face and of the chart
  };
  std::optional<ChartPoint> chart_point(int body, const Vec3& x, const Vec3& normal) const;
};

/// Returns points along the edge of a zone whose pressure is known; global axes.
std::vector<ZoneEdgeSegment> edge_of_zone(const SolvedZone& zone);

class FacePressures : public KnownPressures {
 public:
  void add(SolvedZone zone);

  std::vector<SolvedZone> zones;
  /// Zones of each pair that have no such problem: faces that turn about no single axis, or no open face around.
  std::vector<int> left_out;

  std::optional<PressureOnFace> at(int pair, int body, const Vec3& x, const Vec3& normal) const;
  std::optional<double> square(int pair, int body, const Vec3& x, const Vec3& n) const override;
  bool has_zone(int pair) const override;
  bool edge_near(int pair, const Vec3& x, ZoneEdgeSegment& segment) const override;

 private:
  std::vector<PointBuckets> edges_;  ///< of each zone, its edge
};

}  // namespace cgcontact
