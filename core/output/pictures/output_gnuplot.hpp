/// Common base of all pictures: running gnuplot, colours, units.
#pragma once

#include <array>
#include <mutex>
#include <string>
#include <vector>

#include "core/output/pictures/png_layers.hpp"
#include "core/program/interruption.hpp"

namespace cgcontact {

/// PNG that a script draws on a transparent page.
struct LayeredPicture {
  std::string name;
  std::vector<PixelLayer> layers;  ///< below what is drawn
};

/// Pictures of one result directory: each run of gnuplot starts as soon as its data are written and goes on beside the
/// program. Scripts and data lie in the folder `plots` of the directory. Several threads may start runs and warn.
class GnuplotRuns {
 public:
  explicit GnuplotRuns(const std::string& directory);
  ~GnuplotRuns();
  GnuplotRuns(const GnuplotRuns&) = delete;
  GnuplotRuns& operator=(const GnuplotRuns&) = delete;

  const std::string& directory() const { return directory_; }
  /// Writes `script` as `name`.gp and starts gnuplot on it; `pictures` (in the directory) must exist in the end.
  void start(const std::string& name, const std::string& script, const std::vector<std::string>& pictures);
  /// The same for pictures with pixels below, whose files lie in the folder.
  void start_layered(const std::string& name, const std::string& script, std::vector<LayeredPicture> pictures);
  void warn(const std::string& warning);
  /// Waits for all runs. Failures are warnings, in the order of the names; their scripts and data stay.
  const std::vector<std::string>& finish();

 private:
  struct Run {
    std::string name;
    std::vector<LayeredPicture> pictures;
    int child;                ///< 0: it has ended
    bool ended_well = false;  ///< once it has ended
  };
  void kill_all();
  /// Makes sure of the pictures of a run that has ended.
  void complete(const Run& run);

  const std::string directory_;
  std::mutex mutex_;  ///< of what follows
  std::vector<Run> runs_;
  std::vector<std::string> warnings_;
  const CleanUp clean_up_;
};

/// Returns the colour of a value in [0,1], from blue to red; channels in [0,1].
std::array<double, 3> palette_colour(double value);
/// Returns the same as a gnuplot command.
std::string gnuplot_palette();

/// Looks of the mirror images of pressure curves, and of the planes of symmetry that end curves.
constexpr const char *mirrored_colour = "#f0b49c", *plane_colour = "#909090", *plane_dashes = "(8,3,2,3)";

/// Quotes a text for gnuplot in single quotes: in double quotes it would run commands in backquotes. Nothing in it is
/// interpreted if the terminal is set to noenhanced.
std::string gnuplot_text(const std::string& text);

/// Returns the text for a PNG: squares instead of letters that its font may not have.
std::string drawable_text(const std::string& text);

/// Letters of a name in a legend, so that a plot keeps its width.
constexpr int longest_entry = 24;

/// Returns the height in pixels of a font in the terminal pngcairo; in svg points are pixels.
constexpr double png_pixels(double points) { return points * 4 / 3; }

/// Estimates the width in pixels of a text in a font of that height.
double gnuplot_width(const std::string& text, double pixels);

/// Heading for "set title" in lines that fit `width` pixels in a font of that height; longer than four lines it ends in
/// dots.
struct GnuplotTitle {
  std::string text;  ///< in quotes
  int lines = 1;
};
GnuplotTitle gnuplot_title(const std::string& text, int width, double pixels);

}  // namespace cgcontact
