/// Fuzz target: any bytes as a scene file. Either it is refused with an InputError, or it is a scene whose expressions
/// can be evaluated and whose bodies (those of few cells) can be placed on their grids.
/// A line "#set KEY=VALUE" stands for the option --set KEY=VALUE.
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/errors/errors.hpp"
#include "core/cells/cut_cells.hpp"
#include "core/scene_file/read_scene.hpp"

namespace {

using namespace cgcontact;

constexpr double max_cells = 60;
constexpr std::size_t max_surfaces = 16;

std::vector<std::string> overrides_in(const std::string& text) {
  const std::string mark = "\n#set ";
  std::vector<std::string> overrides;
  for (std::size_t k = text.find(mark); k != std::string::npos; k = text.find(mark, k + 1)) {
    const std::size_t begin = k + mark.size();
    overrides.push_back(text.substr(begin, text.find('\n', begin) - begin));
  }
  return overrides;
}

/// The body on a grid of its own: bounding box, no offset, no rotation.
void place_on_grid(const BodySpec& body) {
  Vec3 min, max;
  if (!body.solid.bounding_box(min, max) || body.solid.surfaces().size() > max_surfaces) return;
  const Vec3 cells = (max - min) / body.cell_size;
  if (!((cells + Vec3::Constant(3)).prod() < max_cells)) return;
  Grid grid;
  grid.cell_size = body.cell_size;
  grid.origin = min - Vec3::Constant(0.5 * body.cell_size);
  for (int k = 0; k < 3; ++k) grid.num_cells[k] = static_cast<int>(cells[k]) + 2;
  make_cut_cells(body.solid.transformed(Mat3::Identity(), -grid.origin / grid.cell_size, 1 / grid.cell_size), grid);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    const Scene scene = parse_scene(text, "no_such_folder/fuzzed.toml", overrides_in(text));
    for (const LoadSpec& load : scene.loads) load.pressure(Vec3(0.1, 0.2, 0.3));
    if (scene.reference_of_force) scene.reference_at(1e3);
    for (const BodySpec& body : scene.bodies) place_on_grid(body);
  } catch (const InputError&) {
  }
  return 0;
}
