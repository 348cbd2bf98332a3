#include "core/output/output.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <optional>
#include <utility>

#include "core/base/files/text.hpp"
#include "core/base/process/parallel.hpp"
#include "core/base/process/ranks.hpp"
#include "core/base/process/resources.hpp"
#include "core/drawing/drawn_body.hpp"
#include "core/drawing/extremes.hpp"
#include "core/output/check/output_check.hpp"
#include "core/output/fields/output_csv.hpp"
#include "core/output/fields/output_frd.hpp"
#include "core/output/fields/output_vtk.hpp"
#include "core/output/fields/output_vtu.hpp"
#include "core/output/output_steps.hpp"
#include "core/output/pictures/output_grid.hpp"
#include "core/output/pictures/output_picture.hpp"
#include "core/output/pictures/output_plots.hpp"
#include "core/output/pictures/output_pressure_map.hpp"
#include "core/output/pictures/output_probes.hpp"
#include "core/output/pictures/output_sections.hpp"
#include "core/output/report/output_page.hpp"
#include "core/output/view/output_view.hpp"
#include "core/program/interruption.hpp"
#include "core/program/scratch_folder.hpp"

namespace cgcontact {

namespace {

namespace fs = std::filesystem;

fs::path absolute_directory(const std::string& directory) {
  fs::path path = fs::weakly_canonical(fs::absolute(directory)).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();  // a trailing slash
  if (!path.has_filename())
    throw InputError(fmt::format("cannot write results to {}: it is the root of the file system", directory));
  return path;
}

/// Files of this program in an existing result directory; throws if it is something else.
std::vector<std::string> old_files(const fs::path& directory) {
  if (!fs::exists(directory)) {
    if (fs::is_symlink(directory))
      throw InputError(fmt::format("cannot write results to {}: it is a link to {}, which does not exist",
                                   directory.string(), fs::read_symlink(directory).string()));
    return {};
  }
  if (!fs::is_directory(directory))
    throw InputError(fmt::format("cannot write results to {}: it is not a directory", directory.string()));
  if (fs::is_empty(directory)) return {};
  const fs::path report = directory / "report.json";
  if (!fs::is_regular_file(report))
    throw InputError(fmt::format("will not replace {}: it is not empty and holds no report.json of an earlier run",
                                 directory.string()));
  return files_of_report(report.string());
}

/// A directory that cannot be renamed.
bool is_mount_point(const fs::path& path) {
  struct statx info {};
  return statx(AT_FDCWD, path.c_str(), 0, STATX_TYPE, &info) == 0 && (info.stx_attributes & STATX_ATTR_MOUNT_ROOT);
}

const char* const temporary_mark = ".tmp-";  ///< the number of the process follows
const char* const aside_mark = ".old";       ///< an earlier result for the moment in which it is replaced

/// Beside the target, so that one can be renamed to the other.
std::string temporary_prefix(const fs::path& target) { return "." + target.filename().string() + temporary_mark; }
fs::path temporary_name(const fs::path& target) {
  return target.parent_path() / (temporary_prefix(target) + std::to_string(getpid()));
}

/// Moves what is not in `ours` to another directory, unless something of that name is there.
void keep_foreign_files(const fs::path& from, const std::vector<std::string>& ours, const fs::path& to) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(from, error)) {
    const std::string name = entry.path().filename().string();
    if (std::find(ours.begin(), ours.end(), name) != ours.end() || fs::exists(to / name)) continue;
    fs::rename(entry.path(), to / name, error);
  }
}

/// A directory that a run holds with a lock as long as it lives, also on another machine in front of the same disk.
class DirectoryLock {
 public:
  explicit DirectoryLock(const fs::path& path) : file_(open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    held_ = file_ >= 0 && flock(file_, LOCK_EX | LOCK_NB) == 0;
  }
  ~DirectoryLock() {
    if (file_ >= 0) close(file_);
  }
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;
  bool held() const { return held_; }

 private:
  int file_;
  bool held_;
};

/// Removes what killed runs (process gone, lock free) have left beside the target. An earlier result that was being
/// replaced returns; files of the user in one go there.
void remove_remains(const fs::path& target) {
  const std::string prefix = temporary_prefix(target);
  std::error_code error;
  std::vector<fs::path> remains;
  for (const fs::directory_entry& entry : fs::directory_iterator(target.parent_path(), error))
    if (entry.path().filename().string().rfind(prefix, 0) == 0) remains.push_back(entry.path());
  for (const fs::path& path : remains) {
    const std::string rest = path.filename().string().substr(prefix.size());
    char* end = nullptr;
    const long process = std::strtol(rest.c_str(), &end, 10);
    const bool aside = std::string(end) == aside_mark;
    const bool ours = !*end || aside || std::string(end) == ScratchFolder::removed_mark;
    if (process <= 0 || !ours || kill(static_cast<pid_t>(process), 0) == 0 || errno != ESRCH) continue;
    const DirectoryLock lock(path);
    if (!lock.held()) continue;
    const bool complete = fs::exists(path / "report.json", error);
    if (aside && complete && !fs::exists(target, error)) {
      fs::rename(path, target, error);
      continue;
    }
    if (complete && fs::is_directory(target, error))
      keep_foreign_files(path, files_of_report((path / "report.json").string()), target);
    fs::remove_all(path, error);
  }
}

/// The directory everything is written to first; removed with its contents unless it has been moved away.
class TemporaryDirectory {
 public:
  explicit TemporaryDirectory(const fs::path& target) try : folder_(temporary_name(target)), lock_(folder_.path()) {
  } catch (const fs::filesystem_error& error) {
    throw InputError(fmt::format("cannot write results to {}: {}", target.string(), error.code().message()));
  }

  const fs::path& path() const { return folder_.path(); }
  std::string file(const std::string& name) const { return (path() / name).string(); }

 private:
  const ScratchFolder folder_;
  const DirectoryLock lock_;
};

/// Exchanges two directories in one step where the file system can, else in two.
void exchange(const fs::path& a, const fs::path& b) {
  if (renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0) return;
  const fs::path aside = a.string() + aside_mark;
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

/// Replaces the old result by the new one; files that are not in `old` move to the new directory.
void replace(const fs::path& written, const fs::path& target, const std::vector<std::string>& old) {
  if (!fs::exists(target)) {
    if (std::rename(written.c_str(), target.c_str()) != 0)
      throw InputError(fmt::format("cannot write results to {}: {}", target.string(), std::strerror(errno)));
    return;
  }
  exchange(written, target);
  keep_foreign_files(written, old, target);
}

/// Not of results that were put together without a model (tests).
bool knows_contact_of_points(const Results& results) {
  return std::all_of(results.bodies.begin(), results.bodies.end(), [](const BodyFields& body) {
    return body.contact_of_point.size() == body.cut_cells->boundary.size();
  });
}

std::vector<CheckedBody> checked_bodies(const Results& results) {
  std::vector<CheckedBody> bodies;
  for (const BodyFields& body : results.bodies) bodies.push_back({body.cut_cells, body.contact_of_point});
  return bodies;
}

constexpr const char* steps_file = "steps.vtkhdf";

/// Needs the extremes: of the last step they are those of the results. `fields`: none if that is the only one.
void set_displacements(const StepFields* fields, Results& results) {
  for (std::size_t k = 0; fields && k < results.steps.size(); ++k)
    results.steps[k].displacement = fields->largest_displacements()[k];
  const int body = body_with_largest(results.extremes, &Extremes::displacement);
  if (!results.steps.empty() && body >= 0)
    results.steps.back().displacement = results.extremes[body].body.displacement.value;
}

/// VTU files are copies of VTKHDF files, which go if they are not wanted.
void write_fields(const Results& results, const OutputOptions& output, const std::vector<DrawnBody>& drawn,
                  const ContactSurface& surface, const fs::path& directory) {
  if (output.frd) {
    std::vector<std::string> names;
    for (const BodyFields& body : results.bodies) names.push_back(body.name);
    write_frd(drawn, surface, names, results.title, (directory / "result.frd").string());
  }
  if (!output.vtk && !output.vtu) return;
  const auto finish = [&](const char* name) {
    const fs::path file = directory / (std::string(name) + ".vtkhdf");
    if (output.vtu) write_vtu(file.string(), (directory / (std::string(name) + ".vtu")).string());
    if (!output.vtk) fs::remove(file);
  };
  write_vtk(results, drawn, (directory / "result.vtkhdf").string());
  finish("result");
  if (surface.size() == 0) return;
  write_vtk_contact(surface, has_friction(results), (directory / "contact.vtkhdf").string());
  finish("contact");
}

/// Nothing is drawn, and the ranks have found the extremes together.
bool extremes_by_ranks_alone(const Scene& scene) {
  return num_ranks() > 1 && !scene.output.fields() && !scene.output.plots && scene.steps.empty();
}

bool wants_view(const Scene& scene) { return scene.output.report && scene.output.plots && scene.output.view; }

/// Writes what is made from the drawn bodies, side by side: first what takes longest, and the picture that gnuplot
/// draws longest. Returns how the scene is looked at, if it is.
std::optional<SceneView> write_drawn(const Results& results, const Scene& scene, const std::vector<DrawnBody>& drawn,
                                     StepFields* steps, bool with_fields, GnuplotRuns& runs, PageContents& contents) {
  const ContactSurface surface = make_contact_surface(results, drawn);
  const std::vector<CheckedBody> bodies = checked_bodies(results);
  std::optional<DrawnFaces> faces;
  if (scene.output.plots && knows_contact_of_points(results)) faces = find_faces(scene, bodies, drawn);
  const bool with_view = wants_view(scene) && has_view_library();
  // Read before fields are written: HDF5 works for one thread at a time.
  std::vector<ViewStep> fields_of_steps = with_view && steps ? steps->boundary_fields() : std::vector<ViewStep>{};
  std::optional<SceneView> view;
  const auto draw_scene = [&] {
    SceneView& scene_view = view.emplace(look_at_scene(results, drawn));
    std::optional<ZoneLook> zone = look_at_main_zone(results, drawn, scene_view);
    ZoneLook* const near = zone ? &*zone : nullptr;
    if (write_picture(results, drawn, scene_view, near, runs)) contents.zone_in_scene = results.pairs[near->pair].name;
    write_grid_picture(results, scene_view, near, runs);
    if (!steps) view.reset();  // it is large
    write_sections(scene, drawn, runs);
  };
  std::vector<std::function<void()>> tasks;
  if (scene.output.plots) tasks.emplace_back(draw_scene);
  if (with_fields) tasks.emplace_back([&] { write_fields(results, scene.output, drawn, surface, contents.directory); });
  if (with_view)
    tasks.emplace_back([&] {
      contents.view =
          view_data({results, drawn, surface, faces ? &*faces : nullptr, &scene, std::move(fields_of_steps)});
    });
  if (faces) tasks.emplace_back([&] { contents.faces = draw_conditions(scene, bodies, drawn, *faces, runs); });
  if (scene.output.plots)
    tasks.emplace_back([&] { contents.pressure_maps = write_pressure_maps(results, surface, runs); });
  parallel_for("cgcontact::output::files", tasks.size(), 1, [&](std::size_t task) { tasks[task](); });
  return view;
}

/// Writes all files but the two reports; gnuplot draws while other files are written. `steps`: with all steps, or none.
/// `fields_elsewhere`: another rank writes the files of fields.
PageContents write_files(Results& results, const Scene& scene, const TemporaryDirectory& temporary, StepFields* steps,
                         bool fields_elsewhere) {
  PageContents contents;
  contents.directory = temporary.path().string();
  for (const SectionSpec& section : scene.sections)
    contents.sections.push_back({section.name, section_picture(section)});
  GnuplotRuns runs(contents.directory);
  if (scene.output.plots) write_plots(results, scene, runs);
  if (scene.output.csv && !results.contact_rows.empty()) write_contact_csv(results, temporary.file("contact.csv"));
  if (scene.output.csv && !results.path.empty()) write_pressure_csv(results, temporary.file("pressure.csv"));
  if (scene.output.csv && !results.probes.empty()) write_probes_csv(results, temporary.file("probes.csv"));
  const std::vector<DrawnBody> drawn_now =
      steps || extremes_by_ranks_alone(scene) ? std::vector<DrawnBody>{} : draw_bodies(results);
  const std::vector<DrawnBody>& drawn = steps ? steps->drawn() : drawn_now;
  if (!extremes_by_ranks_alone(scene)) results.extremes = extremes_of(results, scene, drawn);
  set_displacements(steps, results);
  if (scene.output.csv && !results.steps.empty()) write_steps_csv(results, temporary.file("steps.csv"));
  if (scene.output.plots && steps && !results.pairs.empty()) write_force_displacement_plot(results, runs);
  std::optional<SceneView> view;
  if (scene.output.fields() || scene.output.plots)
    view = write_drawn(results, scene, drawn, steps, scene.output.fields() && !fields_elsewhere, runs, contents);
  contents.view.wanted = wants_view(scene);
  if (steps && view) contents.steps = steps->draw(results.title, *view, runs);
  if (steps) steps->finish();
  contents.warnings = runs.finish();
  std::error_code error;
  if (steps && !scene.output.vtk) fs::remove(temporary.path() / steps_file, error);
  if (contents.warnings.empty()) fs::remove_all(temporary.path() / "plots", error);
  return contents;
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
  uninterrupted([&] {
    if (mkdir(probe.c_str(), 0777) != 0)
      throw InputError(fmt::format("cannot write results to {}: no directory can be made in {}: {}", target.string(),
                                   existing.string(), std::strerror(errno)));
    rmdir(probe.c_str());
  });
} catch (const fs::filesystem_error& error) {
  throw InputError(fmt::format("cannot write results to {}: {}", directory, error.code().message()));
}

struct ResultWriter::State {
  fs::path target;
  std::string directory;
  std::size_t num_steps;
  bool with_fields;
  std::optional<TemporaryDirectory> temporary;
  std::optional<StepFields> steps;
};

ResultWriter::ResultWriter(const Scene& scene, const std::string& directory)
    : state_(new State{absolute_directory(directory),
                       directory,
                       scene.steps.size(),
                       scene.output.fields() || scene.output.plots,
                       {},
                       {}}) {}
ResultWriter::~ResultWriter() = default;

void ResultWriter::add_step(std::size_t number, const Results& step) {
  on_first_rank([&] {
    if (number == 0) state_->steps.reset();  // all may come again: with friction, where a pair has to see farther
    if (!state_->steps) {
      std::optional<std::string> file;
      if (state_->with_fields) file = state_->temporary.emplace(state_->target).file(steps_file);
      state_->steps.emplace(state_->num_steps, file);
    }
    state_->steps->add(number, step);
  });
}

namespace {

/// Rank that writes the files of fields: the last, if it is on the machine of the first.
int rank_of_fields() { return of_first_rank(ranks_on_this_machine()) == num_ranks() ? num_ranks() - 1 : 0; }

void set_memory(Results& results) {
  const double own = static_cast<double>(std::max<long long>(results.peak_memory_bytes, peak_memory_bytes()));
  results.peak_memory_bytes = static_cast<long long>(largest_over_ranks(own));
  if (num_ranks() == 1) return;
  const std::vector<double> all = gather(std::vector<double>{own});
  results.rank_figures.resize(all.size());
  for (std::size_t r = 0; r < all.size(); ++r) results.rank_figures[r].peak_memory_bytes = all[r];
}

}  // namespace

/// Forgets steps of another solve than that of the results: the last one was given up or was worse. True: there were
/// some.
bool ResultWriter::forget_other_steps(const Results& results) {
  if (!state_->steps || state_->steps->are_of(results)) return false;
  state_->steps.reset();
  std::error_code error;
  fs::remove(state_->temporary->path() / steps_file, error);
  return true;
}

/// Writes the results. With several ranks the first one writes, and one more the files of fields.
std::vector<std::string> ResultWriter::write(Results& results, const Scene& scene) {
  const auto start = std::chrono::steady_clock::now();
  std::vector<std::string> old;
  PageContents contents;
  const auto explain = [&](const fs::filesystem_error& error) {
    return fmt::format("cannot write results to {}: {}", state_->target.string(), error.code().message());
  };
  on_first_rank([&] {
    try {
      remove_remains(state_->target);
      old = old_files(state_->target);
      if (!state_->temporary) state_->temporary.emplace(state_->target);
    } catch (const fs::filesystem_error& error) {
      throw InputError(explain(error));
    }
  });
  const std::string directory =
      text_of_first_rank(state_->temporary ? state_->temporary->path().string() : std::string());
  const bool apart = scene.output.fields() && rank_of_fields() > 0;
  if (extremes_by_ranks_alone(scene)) results.extremes = extremes_by_ranks(results, scene);
  on_all_ranks([&] {
    try {
      if (is_first_rank()) {
        const bool without_steps = forget_other_steps(results);
        StepFields* const steps = state_->steps ? &*state_->steps : nullptr;
        if (steps) steps->add(state_->num_steps - 1, results);
        contents = write_files(results, scene, *state_->temporary, steps, apart);
        if (without_steps)
          contents.warnings.push_back(
              "fields and pictures of the steps before the last one are left out: the results are those of an earlier "
              "solve than the last (steps.csv has the figures)");
      } else if (apart && this_rank() == num_ranks() - 1) {
        const std::vector<DrawnBody> drawn = draw_bodies(results);
        write_fields(results, scene.output, drawn, make_contact_surface(results, drawn), directory);
      }
    } catch (const fs::filesystem_error& error) {
      throw InputError(explain(error));
    }
  });
  set_memory(results);
  on_first_rank([&] {
    try {
      finish(results, scene, old, contents, start);
    } catch (const fs::filesystem_error& failed) {
      throw InputError(explain(failed));
    }
  });
  return contents.warnings;
}

/// Writes the reports, which know all files; then the new directory replaces the old one.
void ResultWriter::finish(Results& results, const Scene& scene, const std::vector<std::string>& old,
                          PageContents& contents, std::chrono::steady_clock::time_point start) {
  const TemporaryDirectory& temporary = *state_->temporary;
  std::vector<std::string>& files = contents.files;
  files.emplace_back("report.json");
  if (scene.output.report) files.emplace_back("report.html");
  for (const fs::directory_entry& entry : fs::directory_iterator(temporary.path()))
    files.push_back(entry.path().filename().string());
  std::sort(files.begin(), files.end());
  results.times_s.emplace_back("output",
                               std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  if (scene.output.report) {
    contents.beside = pictures_for_view(contents);
    write_text(temporary.file("report.html"), page(results, contents));
  }
  write_report(results, files, contents.warnings, temporary.file("report.json"));
  uninterrupted([&] {
    replace(temporary.path(), state_->target, old);
    set_interruption_note("the results in " + state_->directory + " are complete");
  });
}

std::vector<std::string> write_results(Results& results, const Scene& scene, const std::string& directory) {
  return ResultWriter(scene, directory).write(results, scene);
}

}  // namespace cgcontact
