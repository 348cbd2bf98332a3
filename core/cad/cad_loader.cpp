/// Outside of the module with OpenCASCADE its functions are those of the module, loaded at the first call. Those that
/// look at what comes from a file are called in child processes.
#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <functional>

#include "core/base/child_work.hpp"
#include "core/base/errors.hpp"
#include "core/base/memory.hpp"
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

std::atomic<bool> is_loaded{false};

const CadKernel& kernel() {
  static const CadKernel& loaded = load();
  is_loaded = true;
  return loaded;
}

// OpenCASCADE reads, checks or divides a hundred faces or more in a second of the processor; ten times as long is no
// end. Beside others it may take longer, but a small file on which it hangs is given up within a minute all the same.
constexpr double least_cpu_seconds = 15, cpu_seconds_per_face = 0.1;
constexpr double least_seconds = 45, seconds_per_face = 0.25;
constexpr double least_bytes = 4e9, memory_per_face = 1e6;
constexpr double bytes_per_face = 2500;  // of a STEP file

ChildLimits limits_of(double faces) {
  return {least_seconds + seconds_per_face * faces, least_cpu_seconds + cpu_seconds_per_face * faces,
          std::min(least_bytes + memory_per_face * faces, memory_budget().bytes)};
}

/// Loads the module here, not in the child.
std::vector<char> guarded(const std::string& task, const ChildLimits& limits,
                          const std::function<void(Packing&)>& work) {
  kernel();
  return in_child(task, limits, work);
}

/// A figure of a model, or several.
template <class Measure>
auto measured(const Measure& measure, const CadModel& model) {
  auto result = decltype(measure()){};
  const std::vector<char> bytes = guarded("OpenCASCADE cannot measure a solid", limits_of(model.faces().size()),
                                          [&](Packing& packing) { packing.put(measure()); });
  Unpacking(bytes).take(result);
  return result;
}

}  // namespace

bool cad_is_loaded() { return is_loaded; }

double CadModel::volume() const {
  return measured([&] { return kernel().volume(*this); }, *this);
}
double CadModel::area() const {
  return measured([&] { return kernel().area(*this); }, *this);
}
std::pair<Vec3, Vec3> CadModel::box() const {
  using Corners = Eigen::Matrix<double, 3, 2>;
  const auto corners = [&] {
    const auto [low, high] = kernel().box(*this);
    return Corners((Corners() << low, high).finished());
  };
  const Corners box = measured(corners, *this);
  return {box.col(0), box.col(1)};
}
std::vector<double> CadModel::distances(const std::vector<int>& faces, const Vec3& x) const {
  return measured([&] { return kernel().distances(*this, faces, x); }, *this);
}
CurvedTriangles CadModel::triangles(double deflection) const {
  const std::vector<char> bytes =
      guarded("OpenCASCADE cannot divide the solid into triangles", limits_of(faces_.size()),
              [&](Packing& packing) { kernel().pack_triangles(*this, deflection, packing); });
  return kernel().unpack_triangles(*this, bytes);
}
CadModel CadModel::combine(Operation operation, const CadModel& a, const Similarity& place_a, const CadModel& b,
                           const Similarity& place_b) {
  const std::vector<char> bytes = guarded(
      "OpenCASCADE cannot combine the solids", limits_of(a.faces_.size() + b.faces_.size()), [&](Packing& packing) {
        kernel().pack_solids({{"", kernel().combine(operation, a, place_a, b, place_b), "", ""}}, packing);
      });
  return kernel().unpack_solids(bytes).front().model;
}
CadModel CadModel::inner_side(const Surface& surface, const Vec3& centre, double radius) {
  return kernel().inner_side(surface, centre, radius);
}
CadModel CadModel::revolved(const std::vector<ProfileEdge>& profile, const ProfileFrame& frame) {
  return kernel().revolved(profile, frame);
}
std::vector<CadSolid> read_cad(const std::string& file, const CadReading& reading) {
  if (cad_format(file) == CadFormat::unknown)
    throw InputError(file + ": is not the name of a CAD file (allowed: .step, .stp, .iges, .igs, .brep)");
  std::error_code missing;
  if (std::filesystem::exists(file, missing) && !std::filesystem::is_regular_file(file, missing))
    throw InputError(file + ": is not a file but a folder or device");
  if (!std::ifstream(file)) throw InputError(file + ": cannot be opened");
  const auto size = static_cast<double>(std::filesystem::file_size(file, missing));
  const std::vector<char> bytes =
      guarded(file + ": OpenCASCADE cannot read it", limits_of(missing ? 0 : size / bytes_per_face),
              [&](Packing& packing) { kernel().pack_solids(kernel().read(file, reading), packing); });
  return kernel().unpack_solids(bytes);
}

}  // namespace cgcontact
