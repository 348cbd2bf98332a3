/// Outside of the module with OpenCASCADE its functions are those of the module, loaded at the first call.
#include <dlfcn.h>
#include <fmt/format.h>

#include <filesystem>

#include "core/base/errors.hpp"
#include "core/cad/cad_kernel.hpp"

namespace cgcontact {

namespace {

#ifdef CGCONTACT_CAD_MODULE
/// Beside the program in the folder of a build or of an installation; then wherever libraries are looked for.
const CadKernel& load() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path own = fs::read_symlink("/proc/self/exe", error).parent_path();
  std::string why;
  for (const fs::path& file :
       {own / "core" / CGCONTACT_CAD_MODULE, own / ".." / "core" / CGCONTACT_CAD_MODULE,
        own / ".." / CGCONTACT_CAD_INSTALLED / CGCONTACT_CAD_MODULE, fs::path(CGCONTACT_CAD_MODULE)}) {
    if (file.has_parent_path() && !fs::exists(file, error)) continue;
    void* const module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!module) {
      why = dlerror();
      continue;
    }
    using Entry = const CadKernel* (*)();
    const auto entry = reinterpret_cast<Entry>(dlsym(module, cad_kernel_function));
    if (entry) return *entry();
    why = dlerror();
  }
  throw InputError("the part of the program that reads CAD files cannot be loaded: " + printable(why) +
                   " (allowed: an installation as a whole, with Debian's libocct-data-exchange-7.6)");
}
#else
const CadKernel& load() {
  throw InputError(std::string(
      "this program was built without OpenCASCADE: it reads no CAD files and knows no torus (allowed: a build with "
      "-DCGCONTACT_CAD=ON and libocct-data-exchange-dev, or a triangle surface: mesh = {...})"));
}
#endif

const CadKernel& kernel() {
  static const CadKernel& loaded = load();
  return loaded;
}

}  // namespace

double CadModel::volume() const { return kernel().volume(*this); }
double CadModel::area() const { return kernel().area(*this); }
std::pair<Vec3, Vec3> CadModel::box() const { return kernel().box(*this); }
double CadModel::distance(int face, const Vec3& x) const { return kernel().distance(*this, face, x); }
CurvedTriangles CadModel::triangles(double deflection) const { return kernel().triangles(*this, deflection); }
CadModel CadModel::combine(Operation operation, const CadModel& a, const Similarity& place_a, const CadModel& b,
                           const Similarity& place_b) {
  return kernel().combine(operation, a, place_a, b, place_b);
}
CadModel CadModel::inner_side(const Surface& surface, const Vec3& centre, double radius) {
  return kernel().inner_side(surface, centre, radius);
}
CadModel CadModel::revolved(const std::vector<ProfileEdge>& profile, const ProfileFrame& frame) {
  return kernel().revolved(profile, frame);
}
std::vector<CadSolid> read_cad(const std::string& file, const CadReading& reading) {
  return kernel().read(file, reading);
}

}  // namespace cgcontact
