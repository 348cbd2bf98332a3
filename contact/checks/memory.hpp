/// Forecast of a run's memory: before anything large is made, and again when the cells are known.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "contact/model/model.hpp"

namespace cgcontact {

/// Numbers of one body that the memory of a run depends on.
struct BodySize {
  double nodes = 0, cut_cells = 0;
  double facets = 0;  ///< of its surface
  bool plane_strain = false;
};

/// Estimates the size without making the body's cells: from its cells on a coarser grid, or on a less coarse one that
/// takes longer.
BodySize estimate_size(const BodySpec& body, bool finer = false);
BodySize size_of(const CutCells& cut_cells);

/// Numbers of points that are known once the cells are.
struct PointNumbers {
  double contact = 0, support = 0;  ///< of all pairs; of all supports
  double rows = 0;                  ///< of contact.csv: boundary points of the faces of the pairs
};

/// Other numbers that it depends on.
struct MemoryExtras {
  std::optional<PointNumbers> points;  ///< unknown: as many as most scenes have on that number of cut cells
  bool pictures = true;
  bool pictures_of_steps = false;
  bool fields_beside_pictures = false;  ///< VTK files are made at once: on several threads
  bool cad = false;                     ///< OpenCASCADE is loaded
};

/// Returns them before the cells are made.
MemoryExtras memory_extras(const Scene& scene);

/// Returns the expected peak memory of a run in bytes: a measured model.
double expected_memory(const std::vector<BodySize>& bodies, const MemoryExtras& extras);

/// Returns the expected memory. Throws InputError if it is more than there is (memory_budget), and names the cell sizes
/// that would fit.
double check_memory(const Scene& scene, const std::vector<BodySize>& bodies, const MemoryExtras& extras);

/// Checks before any cells are made, by estimated sizes: what is too large by far is refused at once, what is too large
/// by little within a second or two.
void check_memory_early(const Scene& scene, bool near_limit_too);

/// Says how much of the memory that there is a run is expected to take, if the user has set a limit or the system's is
/// near; else empty.
std::string forecast_text(double expected);

}  // namespace cgcontact
