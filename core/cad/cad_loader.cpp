/// OpenCASCADE's functions outside of its module, which is loaded at the first call. Those that look at a file are
/// called in child processes.
#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <functional>

#include "core/base/errors/errors.hpp"
#include "core/base/process/child_work.hpp"
#include "core/base/process/memory.hpp"
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

// Time limits: OpenCASCADE reads, checks or divides a hundred faces or more in a second of the processor; ten times as
// long is a hang, found within a minute for a small file.
constexpr double min_cpu_seconds = 15, cpu_seconds_per_face = 0.1;
constexpr double min_seconds = 45, seconds_per_face = 0.25;
constexpr double min_bytes = 4e9, memory_per_face = 1e6;
constexpr double bytes_per_face = 2500;  // of a STEP file

ChildLimits limits_of(double faces) {
  return {min_seconds + seconds_per_face * faces, min_cpu_seconds + cpu_seconds_per_face * faces,
          std::min(min_bytes + memory_per_face * faces, memory_budget().bytes)};
}

/// Loads the module here, not in the child.
std::vector<char> guarded(const std::string& task, const ChildLimits& limits,
                          const std::function<void(Packing&)>& work) {
  kernel();
  return in_child(task, limits, work);
}

/// Figure of a model, or several.
template <class Measure>
auto measured(const Measure& measure, const CadModel& model) {
  auto result = decltype(measure()){};
  const std::vector<char> bytes = guarded("OpenCASCADE cannot measure a solid", limits_of(model.faces().size()),
                                          [&](Packing& packing) { packing.put(measure()); });
  Unpacking(bytes).take(result);
  return result;
}

/// mm: ends of edges that are nearer to each other are one; to the axis: on it.
constexpr double same_end = 1e-5;

/// Adds the segments of the axis inside of the body: between its first and second end there, its third and fourth one,
/// ...
void add_axis(std::vector<CadModel::SectionEdge>& edges) {
  std::vector<double> ends;
  for (const CadModel::SectionEdge& edge : edges)
    for (const Vec2& x : {edge.from, edge.to})
      if (std::abs(x[0]) < same_end) ends.push_back(x[1]);
  std::sort(ends.begin(), ends.end());
  for (std::size_t k = 0; k + 1 < ends.size(); k += 2)
    edges.push_back({Vec2(0, ends[k]), Vec2(0, ends[k + 1]), Vec2::Zero(), 0, -1});
}

/// Drops edges that come twice, where the seam of a face lies in the half-plane.
void leave_out_copies(std::vector<CadModel::SectionEdge>& edges) {
  const auto near = [](const Vec2& a, const Vec2& b) { return (a - b).norm() <= same_end; };
  const auto is_copy = [&](const CadModel::SectionEdge& a, const CadModel::SectionEdge& b) {
    return near(a.through, b.through) &&
           ((near(a.from, b.from) && near(a.to, b.to)) || (near(a.from, b.to) && near(a.to, b.from)));
  };
  std::vector<CadModel::SectionEdge> once;
  for (const CadModel::SectionEdge& edge : edges)
    if (!near(edge.from, edge.to) &&
        std::none_of(once.begin(), once.end(), [&](const auto& other) { return is_copy(edge, other); }))
      once.push_back(edge);
  edges = std::move(once);
}

/// Edges in turn, in lines that end where they begin.
std::vector<std::vector<CadModel::SectionEdge>> closed_lines(std::vector<CadModel::SectionEdge> edges) {
  leave_out_copies(edges);
  add_axis(edges);
  std::vector<std::vector<CadModel::SectionEdge>> lines;
  while (!edges.empty()) {
    std::vector<CadModel::SectionEdge> line{edges.back()};
    edges.pop_back();
    while ((line.back().to - line.front().from).norm() > same_end) {
      const Vec2 end = line.back().to;
      const auto next = std::find_if(edges.begin(), edges.end(), [&](const CadModel::SectionEdge& edge) {
        return std::min((edge.from - end).norm(), (edge.to - end).norm()) <= same_end;
      });
      if (next == edges.end()) throw InputError(std::string("OpenCASCADE's section of the solid is not closed"));
      if ((next->from - end).norm() > same_end) std::swap(next->from, next->to);
      next->from = end;
      line.push_back(*next);
      edges.erase(next);
    }
    line.back().to = line.front().from;
    lines.push_back(std::move(line));
  }
  return lines;
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
CadModel CadModel::combine(Operation operation, const CadModel& a, const Similarity& placement_a, const CadModel& b,
                           const Similarity& placement_b) {
  const std::vector<char> bytes = guarded(
      "OpenCASCADE cannot combine the solids", limits_of(a.faces_.size() + b.faces_.size()), [&](Packing& packing) {
        kernel().pack_solids({{"", kernel().combine(operation, a, placement_a, b, placement_b), "", ""}}, packing);
      });
  return kernel().unpack_solids(bytes).front().model;
}
CadModel CadModel::inner_side(const Surface& surface, const Vec3& centre, double radius) {
  return kernel().inner_side(surface, centre, radius);
}
CadModel CadModel::revolved(const std::vector<ProfileEdge>& profile, const ProfileFrame& frame) {
  return kernel().revolved(profile, frame);
}
std::vector<std::vector<CadModel::SectionEdge>> CadModel::section(const ProfileFrame& frame) const {
  const std::vector<char> bytes =
      guarded("OpenCASCADE cannot cut the solid", limits_of(faces_.size()), [&](Packing& packing) {
        const std::vector<SectionEdge> edges = kernel().section(*this, frame);
        packing.put(edges.size());
        for (const auto& [from, to, through, is_arc, face] : edges) {
          packing.put(std::array<double, 6>{from[0], from[1], to[0], to[1], through[0], through[1]});
          packing.put(std::array<int, 2>{is_arc, face});
        }
      });
  Unpacking all(bytes);
  std::size_t size = 0;
  all.take(size);
  std::vector<SectionEdge> edges(size);
  for (SectionEdge& edge : edges) {
    std::array<double, 6> x{};
    std::array<int, 2> marks{};
    all.take(x);
    all.take(marks);
    edge = {Vec2(x[0], x[1]), Vec2(x[2], x[3]), Vec2(x[4], x[5]), marks[0], marks[1]};
  }
  return closed_lines(std::move(edges));
}
std::vector<CadSolid> read_cad(const std::string& file, const CadReading& reading) {
  if (cad_format(file) == CadFormat::unknown)
    throw InputError(file + ": is not the name of a CAD file (allowed: .step, .stp, .iges, .igs, .brep, .brp)");
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
