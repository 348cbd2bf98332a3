/// Fuzz target: any bytes as a STEP file. Either it is refused with an InputError, or it holds solids that can be
/// measured, divided into triangles and placed on a grid. OpenCASCADE may crash on it, or find no end, in a child
/// process only.
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/base/errors/errors.hpp"
#include "core/bodies/cad_body.hpp"
#include "core/cad/cad_model.hpp"
#include "core/cells/cut_cells.hpp"

namespace {

using namespace cgcontact;

constexpr double deflection = 0.01;  // of the solid's diagonal
constexpr double mm = 1e-3;
constexpr std::size_t max_triangles = 2000;

/// A file of this process, gone when it ends.
struct InputFile {
  const std::string name =
      (std::filesystem::temp_directory_path() / ("fuzzed_" + std::to_string(getpid()) + ".step")).string();
  ~InputFile() { std::remove(name.c_str()); }
};

/// On a grid of few cells.
void place_on_grid(const CadModel& model) {
  const auto [low, high] = model.box();
  const double size = mm * (high - low).maxCoeff() / 2.1;
  if (!(size > 0) || mm * low.cwiseAbs().maxCoeff() > 1e8 * size) return;
  Grid grid;
  grid.cell_size = size;
  grid.origin = mm * low - Vec3::Constant(0.45 * size);
  grid.num_cells = {3, 3, 3};
  const Solid solid(std::make_shared<CadBody>(model, mm, size));
  make_cut_cells(solid.transformed(Mat3::Identity(), -grid.origin / size, 1 / size), grid);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const InputFile file;
  std::ofstream(file.name, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    for (const CadSolid& solid : read_cad(file.name, {})) {
      const auto [low, high] = solid.model.box();
      if (solid.model.triangles(deflection * (high - low).norm()).triangles.size() > max_triangles) continue;
      place_on_grid(solid.model);
    }
  } catch (const InputError&) {
  }
  return 0;
}
