/// Settings of runs that refine their grids until a figure is as accurate as asked for. What each means stands in
/// settings().
#pragma once

#include <string>
#include <vector>

#include "core/settings/settings.hpp"

namespace cgcontact {

/// Target for the stress of one body.
struct BodyTarget {
  std::string body;
  double error = 0;  ///< relative to the energy norm of its own stress
};

/// Target of a displacement (of the face "body.face", the probe or, "largest", of all) or of the pressure of a pair.
struct NamedTarget {
  enum class Kind { displacement, pressure };
  Kind kind = Kind::displacement;
  std::string name;
  double error = 0;  ///< relative

  /// "displacement of beam.tip"
  std::string text() const { return (kind == Kind::pressure ? "pressure of " : "displacement of ") + name; }
};

struct AccuracyOptions {
  Target pressure, force, shear, stress;
  std::vector<BodyTarget> stress_of_body;  ///< instead of `stress`
  std::vector<NamedTarget> named;          ///< pairs have their own target instead of `pressure`

  // Limits of a run.
  double max_unknowns = 5e6, max_time = 1e6;
  int max_levels = 20, max_solves = 10;

  // Constants of the method (docs/adaptivity.md).

  /// First grid without cell_size: cells over the mean thickness (twice the volume over the surface; a third of a
  /// cube's side), and their largest number in a body.
  double first_cells_through = 2.7, max_first_cells = 40000;
  /// Growth of the cells with the distance from the contact zone.
  double grading = 0.25;
  /// Fraction of half a zone's width by which its cells go on beyond its closed points.
  double beyond_zone = 0.15;
  /// Cells over half the width of a zone on the first grid that resolves it.
  double middle_cells = 4;
  /// Refinement where nothing but the group of a zone is known.
  double narrowing = 24;
  /// Fraction of the target that the next grid aims at, and the power of the size that errors are taken to fall with.
  double aim = 0.75, rate = 1.1;
  /// Factor on the estimate of one solution: true errors are below the product in 95 % of runs.
  double safety = 1.2;
  /// Cells across a zone at which that estimate is half of what it should be.
  double doubtful_width = 5;
  /// Size changes at least and at most by these factors from one solve to the next.
  double min_change = 1.4, max_change = 8;
  /// Fraction of the target of the pressure that the force's error may take.
  double force_fraction = 0.7;
  /// Fraction of what the targets allow that the next grid aims at for the energy norm.
  double energy_aim = 0.9;
  /// Growth of cells with the distance from those that the energy norm's error asks for.
  double energy_grading = 0.5;
  /// Fraction of a cell: faces of an open pair this near may touch between the points where the gap is known.
  double near_gap = 0.05;

  bool any() const { return pressure || force || shear || stress || !stress_of_body.empty() || !named.empty(); }
  /// Returns the number among `named`; -1: the pair has none of its own.
  int named_pressure(const std::string& pair) const;
  /// Returns the target of a pair; none: its pressure is not asked for.
  Target pressure_of(const std::string& pair) const;
  std::vector<Setting> settings();
  void check() const;
  std::string print() const;

 private:
  /// Targets of `stress` and `displacement` as TOML: a number, or a table of names; "": none.
  std::string stress_text() const;
  std::string displacement_text() const;
};

}  // namespace cgcontact
