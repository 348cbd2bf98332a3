/// Contact pressure of one zone from the forces that its groups transmit: inside the cells the bodies are half-spaces,
/// outside the finite element solution is right (docs/theory.md, "The pressure on the face").
#pragma once

#include "core/settings/face_options.hpp"
#include "kernels/mesh/views.hpp"
#include "recovery/face/face_grid.hpp"
#include "recovery/face/face_problem.hpp"

namespace cgcontact {

/// A contact group, or what is seen of it in the zone.
struct FaceGroup {
  double area = 0;        ///< m^2; in plane strain m, per thickness
  double force = 0;       ///< N; in plane strain N/m
  double gap_change = 0;  ///< m, mean over its points: by which the deformation opens the gap
  double away = 0;        ///< m, from the nearest closed group; 0: it is closed
};

/// Fraction of a patch that belongs to a group; those of a patch add up to 1.
struct FaceShare {
  int patch, group;
  double fraction;
};

struct FaceZone {
  FaceGrid grid;
  double h = 1;                   ///< m, the larger cells of both bodies at the zone
  double modulus = 1;             ///< E* of both, Pa
  std::vector<char> inside;       ///< patches on both faces
  std::vector<FaceShare> shares;  ///< shares of groups in those patches
  std::vector<char> may_press;    ///< patches beside closed groups
  std::vector<double> distance;   ///< m, of the undeformed faces at each patch
  std::vector<FaceGroup> groups;
};

/// Result of the problem of a zone: the square of the pressure, which is smooth where a zone ends.
struct FacePressure {
  FaceGrid grid;
  std::vector<double> square;  ///< Pa^2, at the patches; negative outside of the zone
  /// Pa, at the patches: change of the pressure with what no solution shows: how short the far field's details are (15
  /// % shorter), how much stiffness the cells lack (half as much), and, where the faces turn within a cell, what varies
  /// within one.
  std::vector<double> error;
  FaceSolution solution;  ///< on the finest patches
  /// Returns the pressure, Pa, bilinear in the square; zero outside.
  double at(const FacePosition& x) const;
  /// Returns the square, Pa^2, bilinear; negative outside.
  double square_at(const FacePosition& x) const;
};

FacePressure solve_face_zone(const ExecSpace& exec, const FaceZone& zone, const FaceOptions& options);

}  // namespace cgcontact
