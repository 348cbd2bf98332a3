/// Fuzz target: any bytes as a STEP file. Either it is refused with an InputError, or it holds solids that can be
/// measured and divided into triangles. OpenCASCADE may crash on it, or find no end, in a child process only.
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/base/errors.hpp"
#include "core/cad/cad_model.hpp"

namespace {

using namespace cgcontact;

constexpr double deflection = 0.01;  // of the solid's diagonal

/// A file of this process, gone when it ends.
struct InputFile {
  const std::string name =
      (std::filesystem::temp_directory_path() / ("fuzzed_" + std::to_string(getpid()) + ".step")).string();
  ~InputFile() { std::remove(name.c_str()); }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const InputFile file;
  std::ofstream(file.name, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    for (const CadSolid& solid : read_cad(file.name, {})) {
      const auto [low, high] = solid.model.box();
      solid.model.triangles(deflection * (high - low).norm());
    }
  } catch (const InputError&) {
  }
  return 0;
}
