/// result.vtkhdf and contact.vtkhdf: unstructured grids in VTKHDF 1.0, which VTK 9.1 and ParaView 5.11 open.
/// steps.vtkhdf: one in VTKHDF 2.0, with time, for VTK 9.3 and ParaView 5.12.
#pragma once

#include <string>
#include <vector>

#include "core/base/files/hdf_file.hpp"
#include "core/drawing/drawn_body.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

/// Writes all bodies as clipped cells. Cell arrays: body, cell, stress_raw (at the centroid), estimated_error (energy
/// norm over the active cell, sqrt(J)), estimated_error_density (the same per square root of volume). Point arrays:
/// displacement, stress_recovered, von_mises. Stress components: XX, YY, ZZ, XY, YZ, XZ.
void write_vtk(const Results& results, const std::vector<DrawnBody>& bodies, const std::string& file_name);

/// All bodies with their fields step by step, on the disk: grid and cell arrays (body, cell) once, the point arrays
/// displacement, stress_recovered, von_mises for each. Its time is the number of the step, from 1.
class VtkSteps {
 public:
  VtkSteps(const std::vector<DrawnBody>& bodies, const std::string& file_name);
  /// Adds the same bodies with the fields of the next step.
  void add(const std::vector<DrawnBody>& bodies);
  /// Reads displacement and stress of a step (from 0) that has been added; as long as this lives.
  void read(std::size_t step, std::vector<DrawnBody>& bodies);
  /// Ends the file, once, after the last step.
  void finish();

 private:
  PointValues read_rows(std::size_t first, std::size_t n);

  HdfFile file_;
  std::size_t num_points_ = 0, num_steps_ = 0;
};

/// Writes the triangles of the contact faces. Cell arrays: body, pair, status (1 closed, 0 open), gap, pressure_raw,
/// pressure_spr, pressure_sprc, pressure_error; the last five as point arrays "..._smooth" too, and displacement.
void write_vtk_contact(const ContactSurface& surface, bool friction, const std::string& file_name);

/// Writes the bodies of a scene without results. Cell arrays: body, cell, cut (1: a boundary passes), volume_fraction.
void write_vtk_cells(const std::vector<DrawnBody>& bodies, const std::vector<const CutCells*>& cut_cells,
                     const std::string& file_name);

/// Integers on the triangles of the bodies' boundaries; `names` becomes the attribute of that name, if not empty.
struct BoundaryArray {
  std::string name, names;
  std::vector<int> values;  ///< the triangles of the first body, then of the second one ...
};
void write_vtk_boundary(const std::vector<DrawnBody>& bodies, const std::vector<BoundaryArray>& arrays,
                        const std::string& file_name);

}  // namespace cgcontact
