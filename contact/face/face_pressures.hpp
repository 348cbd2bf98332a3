/// The contact pressure of a solved scene as problems on its faces, one for each zone (recovery/face/face_zone.hpp).
#pragma once

#include <optional>

#include "contact/face/face_chart.hpp"
#include "recovery/face/face_zone.hpp"

namespace cgcontact {

/// Cosine between the normals of faces that look the same way.
constexpr double same_side = 0.5;

/// A pressure and what it may be off, Pa.
struct PressureOnFace {
  double pressure = 0, error = 0;
};

/// A zone whose pressure was solved for.
struct SolvedZone {
  int pair = 0, primary = 0;
  FaceChart chart;
  double h = 0;             ///< m
  std::vector<char> known;  ///< patches that are part of the faces
  /// Cosines between the normals of the primary face and of the chart at each patch: pressures are per area of the
  /// chart.
  std::vector<double> cosine;
  FacePressure pressure;

  /// At a point on the face of a body; none: the zone does not reach there.
  std::optional<PressureOnFace> at(int body, const Vec3& x, const Vec3& normal) const;
};

struct FacePressures {
  std::vector<SolvedZone> zones;
  /// Zones of each pair that have no such problem: faces that turn about no single axis, or no open face around.
  std::vector<int> left_out;

  std::optional<PressureOnFace> at(int pair, int body, const Vec3& x, const Vec3& normal) const;
};

}  // namespace cgcontact
