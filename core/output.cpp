#include "core/output.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "core/output_csv.hpp"
#include "core/output_fields.hpp"
#include "core/output_page.hpp"
#include "core/output_picture.hpp"
#include "core/output_plots.hpp"
#include "core/output_pressure_map.hpp"
#include "core/output_text.hpp"
#include "core/output_vtk.hpp"
#include "core/parallel.hpp"
#include "core/resources.hpp"

namespace cgcontact {

namespace {

namespace fs = std::filesystem;

fs::path absolute_directory(const std::string& directory) {
  fs::path path = fs::weakly_canonical(fs::absolute(directory)).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();  // a trailing slash
  if (!path.has_filename()) throw InputError(fmt::format("cannot write results to {}", directory));
  return path;
}

/// Files of this program in an existing result directory; throws if it is something else.
std::vector<std::string> old_files(const fs::path& directory) {
  if (!fs::exists(directory)) return {};
  if (!fs::is_directory(directory))
    throw InputError(fmt::format("cannot write results to {}: it is not a directory", directory.string()));
  if (fs::is_empty(directory)) return {};
  const fs::path report = directory / "report.json";
  if (!fs::exists(report))
    throw InputError(fmt::format("will not replace {}: it is not empty and holds no report.json of an earlier run",
                                 directory.string()));
  return files_of_report(report.string());
}

/// A directory that cannot be renamed.
bool is_mount_point(const fs::path& path) {
  struct statx info {};
  return statx(AT_FDCWD, path.c_str(), 0, STATX_TYPE, &info) == 0 && (info.stx_attributes & STATX_ATTR_MOUNT_ROOT);
}

/// Beside the target, so that one can be renamed to the other.
fs::path temporary_name(const fs::path& target) {
  return target.parent_path() / fmt::format(".{}.tmp-{}", target.filename().string(), getpid());
}

/// The directory everything is written to first; removed with its contents unless it has been moved away.
class TemporaryDirectory {
 public:
  explicit TemporaryDirectory(const fs::path& target) : path_(temporary_name(target)) {
    std::error_code error;
    fs::create_directories(target.parent_path(), error);
    fs::remove_all(path_, error);
    error.clear();
    fs::create_directory(path_, error);
    if (error) throw InputError(fmt::format("cannot write results to {}: {}", target.string(), error.message()));
  }
  ~TemporaryDirectory() {
    std::error_code error;
    fs::remove_all(path_, error);
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  const fs::path& path() const { return path_; }
  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

/// Exchanges two directories in one step where the file system can, else in two.
void exchange(const fs::path& a, const fs::path& b) {
  if (renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0) return;
  const fs::path aside = a.string() + ".old";
  if (std::rename(b.c_str(), aside.c_str()) != 0)
    throw InputError(fmt::format("cannot replace {}: {}", b.string(), std::strerror(errno)));
  if (std::rename(a.c_str(), b.c_str()) != 0) {
    const int reason = errno;
    if (std::rename(aside.c_str(), b.c_str()) != 0)
      throw InputError(fmt::format("cannot replace {}: the old result is now {}", b.string(), aside.string()));
    throw InputError(fmt::format("cannot replace {}: {}", b.string(), std::strerror(reason)));
  }
  std::rename(aside.c_str(), a.c_str());
}

/// Puts the new result in the place of the old one; files that are not in `old` move to the new directory.
void replace(const fs::path& written, const fs::path& target, const std::vector<std::string>& old) {
  if (!fs::exists(target)) {
    if (std::rename(written.c_str(), target.c_str()) != 0)
      throw InputError(fmt::format("cannot write results to {}: {}", target.string(), std::strerror(errno)));
    return;
  }
  exchange(written, target);
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(written, error)) {
    const std::string name = entry.path().filename().string();
    if (std::find(old.begin(), old.end(), name) != old.end() || fs::exists(target / name)) continue;
    fs::rename(entry.path(), target / name, error);
  }
}

std::vector<DrawnBody> draw_bodies(const Results& results) {
  std::vector<DrawnBody> drawn(results.bodies.size());
  parallel_for(drawn.size(), 1, [&](std::size_t b) { drawn[b] = draw_body(results.bodies[b]); });
  return drawn;
}

std::vector<BodyExtremes> extremes_of(const std::vector<DrawnBody>& bodies) {
  std::vector<BodyExtremes> extremes;
  for (const DrawnBody& body : bodies) {
    BodyExtremes most;
    for (const Vec3& u : body.displacement) most.displacement = std::max(most.displacement, u.norm());
    for (const Sym3& s : body.stress) most.von_mises = std::max(most.von_mises, von_mises(s));
    extremes.push_back(most);
  }
  return extremes;
}

/// All files but the two reports. The pictures are begun first: gnuplot draws while the other files are written.
PageParts write_files(const Results& results, const Scene& scene, const TemporaryDirectory& temporary) {
  PageParts parts;
  parts.directory = temporary.path().string();
  GnuplotRuns runs(parts.directory);
  if (scene.output.plots) write_plots(results, scene, runs);
  if (scene.output.csv && !results.contact_rows.empty()) write_contact_csv(results, temporary.file("contact.csv"));
  if (scene.output.csv && !results.steps.empty()) write_steps_csv(results, temporary.file("steps.csv"));
  if (scene.output.vtk || scene.output.plots) {
    const std::vector<DrawnBody> drawn = draw_bodies(results);
    const ContactSurface surface = make_contact_surface(results, drawn);
    parts.extremes = extremes_of(drawn);
    const auto draw = [&] {
      write_picture(results, drawn, runs);
      parts.pressure_maps = write_pressure_maps(results, surface, runs);
    };
    const auto write_fields = [&] {
      write_vtk(results, drawn, temporary.file("result.vtkhdf"));
      if (surface.size() > 0) write_vtk_contact(surface, temporary.file("contact.vtkhdf"));
    };
    parallel_for(2, 1, [&](std::size_t task) {
      if (task == 0 && scene.output.plots) draw();
      if (task == 1 && scene.output.vtk) write_fields();
    });
  }
  parts.warnings = runs.finish();
  std::error_code error;
  if (parts.warnings.empty()) fs::remove_all(temporary.path() / "plots", error);
  return parts;
}

}  // namespace

void check_output_directory(const std::string& directory) try {
  const fs::path target = absolute_directory(directory);
  const char* const advice = "the directory is replaced as a whole; name one inside it";
  std::error_code error;
  if (fs::equivalent(target, fs::current_path(error), error))
    throw InputError(fmt::format("cannot write results to {}: it is the working directory ({})", directory, advice));
  if (is_mount_point(target))
    throw InputError(fmt::format("cannot write results to {}: it is a mount point ({})", directory, advice));
  old_files(target);
  fs::path existing = target.parent_path();
  while (!fs::exists(existing, error) && existing.has_relative_path()) existing = existing.parent_path();
  const fs::path probe = temporary_name(existing / target.filename());
  if (mkdir(probe.c_str(), 0777) != 0)
    throw InputError(fmt::format("cannot write results to {}: no directory can be made in {}: {}", target.string(),
                                 existing.string(), std::strerror(errno)));
  rmdir(probe.c_str());
} catch (const fs::filesystem_error& error) {
  throw InputError(fmt::format("cannot write results to {}: {}", directory, error.code().message()));
}

std::vector<std::string> write_results(Results& results, const Scene& scene, const std::string& directory) {
  const fs::path target = absolute_directory(directory);
  const auto start = std::chrono::steady_clock::now();
  try {
    const std::vector<std::string> old = old_files(target);
    const TemporaryDirectory temporary(target);
    PageParts parts = write_files(results, scene, temporary);
    std::vector<std::string>& files = parts.files;
    files.emplace_back("report.json");
    if (scene.output.report) files.emplace_back("report.html");
    for (const fs::directory_entry& entry : fs::directory_iterator(temporary.path()))
      files.push_back(entry.path().filename().string());
    std::sort(files.begin(), files.end());
    results.times_s.emplace_back("output",
                                 std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    results.peak_memory_bytes = std::max(results.peak_memory_bytes, peak_memory_bytes());
    if (scene.output.report) write_text(temporary.file("report.html"), page(results, parts));
    write_report(results, files, parts.warnings, temporary.file("report.json"));
    replace(temporary.path(), target, old);
    return parts.warnings;
  } catch (const fs::filesystem_error& error) {
    throw InputError(fmt::format("cannot write results to {}: {}", target.string(), error.code().message()));
  }
}

}  // namespace cgcontact
