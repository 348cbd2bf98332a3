/// A finished result as it is read from its files: bodies that can be drawn, and what the views of the pictures need of
/// the contact.
#pragma once

#include <string>
#include <vector>

#include "core/base/files/json.hpp"
#include "core/drawing/drawn_body.hpp"
#include "core/output/plot/vtk_arrays.hpp"
#include "core/results/results.hpp"

namespace cgcontact {

struct PlotResult {
  PlotResult() = default;
  PlotResult(PlotResult&&) = default;
  PlotResult(const PlotResult&) = delete;  // `known` refers to the grids

  std::string directory;
  std::vector<DrawnBody> bodies;        ///< all cells are polyhedra of their meshes, none is interior; with boundaries
  std::vector<std::size_t> first_cell;  ///< rows of the file before the cells of each body
  /// Title, and names of bodies and pairs; contact rows as far as contact.vtkhdf has them: a row for each triangle.
  Results known;
  std::vector<CutCells> grids;          ///< of the bodies: sizes of cells, and whether they are quadtrees
  std::size_t step = 0, num_steps = 1;  ///< step: from 1; 0: the last one
};

/// Returns the name of result.vtkhdf in the directory, for a step from 1 on of steps.vtkhdf; throws InputError if it is
/// not there.
std::string result_file(const std::string& directory, std::size_t step);

/// Reads bodies with displacement and recovered stress, and the contact where there is a contact.vtkhdf; `report`: of
/// the directory. Throws InputError that names the file if one is missing or damaged.
PlotResult read_plot_result(const std::string& directory, const Json& report, std::size_t step, const VtkArrays& file);

/// Returns the bodies in a file of so many. Points that no cell has, on the boundaries of CAD bodies and surfaces, are
/// those of the body before them. Throws InputError where sizes and numbers do not fit together.
std::vector<DrawnBody> read_drawn_bodies(const VtkArrays& file, std::size_t num_bodies, std::size_t step,
                                         std::vector<std::size_t>& first_cell);

}  // namespace cgcontact
