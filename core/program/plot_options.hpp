/// Options of `cgcontact plot`: what is drawn of a result, read from the command line.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/expressions/unit_check.hpp"

namespace cgcontact {

struct PlotOptions {
  /// Plane across a coordinate axis.
  struct Plane {
    int axis = 0;
    double value = 0;  ///< m
    std::string text;  ///< as it was given
  };
  /// Ends of the bar of colours, whose dimension is that of the field.
  struct Ends {
    std::array<Quantity, 2> values;  ///< low, high
    std::string text;                ///< as it was given
  };
  std::string directory;            ///< output directory of a run
  std::string field = "von_mises";  ///< name
  std::optional<Plane> section;     ///< none: the surfaces
  std::optional<Ends> range;        ///< none: from the values
  bool zoom = false;                ///< only what is near a contact zone
  std::string pair;                 ///< whose zone; empty: of the pair with the largest force
  int step = 0;                     ///< from 1; 0: the last one
  std::vector<std::string> bodies;  ///< names; empty: all
  std::optional<double> deformed;   ///< factor of the displacements
  std::string out = "plot.png";
};

/// Parses "z=5mm". All functions below throw InputError with the value and what is allowed.
PlotOptions::Plane parse_plane(const std::string& text);

/// Parses "0:300 MPa"; a number without a unit has that of the other one.
PlotOptions::Ends parse_ends(const std::string& text);

/// Parses "contact" and "contact:PAIR"; returns the pair, or "".
std::string parse_zoom(const std::string& text);

/// Parses the number of a step, from 1.
int parse_plot_step(const std::string& text);

/// Parses a factor of displacements, zero or more.
double parse_deformed(const std::string& text);

}  // namespace cgcontact
