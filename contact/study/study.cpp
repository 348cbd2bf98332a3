#include "contact/study/study.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>
#include <optional>

#include "contact/results/reference/pressure_error.hpp"
#include "contact/study/face_pressure.hpp"
#include "contact/study/study_plan.hpp"
#include "core/base/files/text.hpp"
#include "core/base/numbers/rounding.hpp"
#include "core/base/process/resources.hpp"
#include "core/output/study/output_study.hpp"
#include "core/program/child_process.hpp"
#include "core/program/progress.hpp"

namespace cgcontact {

namespace {

namespace fs = std::filesystem;

/// Describes a failure by how the process ended and its last words.
std::string describe_failure(const ChildOutcome& outcome, const std::string& log) {
  if (outcome.error != 0) return fmt::format("could not be started: {}", std::strerror(outcome.error));
  const std::string mark = "cgcontact: ";
  std::string message, text = read_text(log);
  for (std::size_t begin = 0, end; begin < text.size(); begin = end + 1) {
    end = std::min(text.find('\n', begin), text.size());
    if (text.compare(begin, mark.size(), mark) == 0)
      message = text.substr(begin + mark.size(), end - begin - mark.size());
  }
  if (outcome.signal != 0) return fmt::format("ended by signal {} ({})", outcome.signal, strsignal(outcome.signal));
  return message.empty() ? fmt::format("ended with exit code {}", outcome.exit_code) : message;
}

/// Temporary directories of what was stopped or crashed.
void remove_leftovers(const fs::path& folder) {
  std::vector<fs::path> leftovers;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name[0] == '.' && name.find(".tmp-") != std::string::npos) leftovers.push_back(entry.path());
  }
  for (const fs::path& path : leftovers) fs::remove_all(path);
}

class StudyRunner {
 public:
  explicit StudyRunner(const CommandLine& line);
  int run();

 private:
  void check_programs();
  void warm_start_from(const std::map<std::string, StudyRow>& earlier, std::size_t row);
  void run_row(std::size_t row, Progress& progress);
  bool run_once(StudyRow& row, const std::string& directory);
  void read_results(StudyRow& row, const fs::path& directory, double wall_s);
  void compare_with_finest();
  void write(Progress& progress);
  fs::path folder(const StudyRow& row) const { return fs::path(directory_) / "runs" / row.directory; }

  const StudyOptions& options_;
  std::string directory_;
  ChildRunner children_;
  StudyPlan plan_;
  Study& study_;
  std::vector<std::string> warned_;
};

StudyRunner::StudyRunner(const CommandLine& line)
    : options_(line.study_options), directory_(line.out), plan_(plan_study(line)), study_(plan_.study) {
  if (directory_.empty()) directory_ = "out/" + fs::path(line.scene).stem().string() + "-study";
}

/// Other builds must be this program.
void StudyRunner::check_programs() {
  const std::string log = (fs::temp_directory_path() / fmt::format("cgcontact-version-{}", getpid())).string();
  for (const StudyOptions::Backend& backend : options_.backends) {
    const ChildOutcome outcome = children_.run(backend.program, {"--version"}, log);
    const bool ours = outcome.exit_code == 0 && read_text(log).rfind("cgcontact ", 0) == 0;
    fs::remove(log);
    if (!ours)
      throw InputError(fmt::format("--backend: \"{}\" is not a program that can be run (allowed: a build of cgcontact)",
                                   backend.program));
  }
}

void StudyRunner::warm_start_from(const std::map<std::string, StudyRow>& earlier, std::size_t r) {
  StudyRow& row = study_.rows[r];
  const auto found = earlier.find(row.fingerprint);
  if (found == earlier.end()) return;
  const bool complete = fs::exists(folder(row) / "report.json");
  if (!complete && (study_.own_reference || options_.keep)) return;  // its files are needed
  row.status = found->second.status;
  row.message = found->second.message;
  row.wall_s = found->second.wall_s;
  row.report = found->second.report;
  row.figures = found->second.figures;
  if (row.figures.smallest_cell) row.cell_size = *row.figures.smallest_cell;
  row.errors = row.figures.pressure_errors;
}

/// Takes the results of a run over, if they are the fastest so far.
void StudyRunner::read_results(StudyRow& row, const fs::path& directory, double wall_s) {
  const std::string file = (directory / "report.json").string(), report = read_text(file);
  const RunFigures figures = read_figures(report, file);
  if (row.has_figures() && figures.total_time_s() >= row.figures.total_time_s()) return;
  row.report = report;
  row.figures = figures;
  row.wall_s = wall_s;
  if (figures.smallest_cell) row.cell_size = *figures.smallest_cell;
  row.errors = figures.pressure_errors;
  row.status = figures.converged ? StudyRow::Status::solved : StudyRow::Status::not_converged;
  row.message = figures.converged ? fmt::format("{}", fmt::join(figures.warnings, "; ")) : figures.diagnosis;
}

/// Runs into `directory`; true if there are results.
bool StudyRunner::run_once(StudyRow& row, const std::string& directory) {
  std::vector<std::string> arguments(row.command.begin() + 1, row.command.end());
  arguments.insert(arguments.end(), {"--out", directory});
  const std::string log = directory + ".log";
  const ChildOutcome outcome = children_.run(row.command[0], arguments, log);
  if (children_.stop_signal() != 0) return false;
  std::string failure;
  if (outcome.exit_code == 0 || outcome.exit_code == 2) {
    try {
      read_results(row, directory, outcome.wall_s);
      fs::remove(log);
      return true;
    } catch (const InputError& error) {
      failure = error.what();
    }
  } else {
    failure = describe_failure(outcome, log);
  }
  row.status = StudyRow::Status::failed;
  row.message = failure;
  row.report.clear();
  row.figures = {};
  row.errors.clear();
  row.wall_s = outcome.wall_s;
  return false;
}

void StudyRunner::run_row(std::size_t r, Progress& progress) {
  StudyRow row = study_.rows[r];
  const fs::path target = folder(row), again = target.string() + ".again";
  fs::remove_all(target);
  for (int k = 0; k < options_.repeat; ++k) {
    const fs::path& run_folder = k == 0 ? target : again;
    const std::string fastest = row.report;
    const bool results = run_once(row, run_folder.string());
    if (k > 0 && results && row.report != fastest) {
      fs::remove_all(target);
      fs::rename(again, target);
    }
    fs::remove_all(again);
    if (!results) break;
  }
  remove_leftovers(target.parent_path());
  if (children_.stop_signal() != 0) return;
  study_.rows[r] = row;
  if (row.status != StudyRow::Status::solved)
    progress.message(
        fmt::format("{}, {} = {} {}: {}", row.variant, study_.key, row.size, status_name(row.status), row.message));
}

/// Without a reference in the scene, the finest run is the reference of all coarser ones.
void StudyRunner::compare_with_finest() {
  const StudyRow* const finest = study_.own_reference ? finest_row(study_) : nullptr;
  if (!finest) return;
  const Scene& scene = plan_.scenes[finest - study_.rows.data()];
  study_.reference = fmt::format("the pressure of the study's own finest run ({}, {} = {}, {} unknowns)",
                                 finest->variant, study_.key, finest->size, finest->figures.unknowns);
  const auto points = [&](const StudyRow& row) {
    const fs::path file = folder(row) / "contact.csv";  // there is none if the bodies are far apart
    return fs::exists(file) ? read_contact_rows(file.string(), scene) : std::vector<ContactRow>();
  };
  const ReferenceSpec reference = scene.reference_at(finest->figures.force.value_or(0));
  const SampledPressure pressure(points(*finest), finest->cell_size);
  for (StudyRow& row : study_.rows) {
    const bool coarser = row.has_figures() && row.cell_size > finest->cell_size * (1 + rounding);
    row.errors.clear();
    const std::vector<ContactRow> rows = coarser ? points(row) : std::vector<ContactRow>();
    if (!rows.empty())
      row.errors = pressure_errors(
          rows, [&](const ContactRow& point) { return pressure(point.body, point.x); }, reference.zones);
    if (reference.force) continue;
    row.force_reference = coarser ? finest->figures.force : std::nullopt;
  }
}

void StudyRunner::write(Progress& progress) {
  compare_with_finest();
  for (const std::string& warning : write_study(study_, directory_)) {
    if (std::find(warned_.begin(), warned_.end(), warning) != warned_.end()) continue;
    progress.warning(warning);
    warned_.push_back(warning);
  }
}

int StudyRunner::run() try {
  check_study_directory(directory_);
  check_programs();
  fs::create_directories(fs::path(directory_) / "runs");
  remove_leftovers(directory_);
  remove_leftovers(fs::path(directory_) / "runs");
  Progress progress;
  if (options_.resume) {
    const auto earlier = earlier_rows(directory_);
    for (std::size_t r = 0; r < study_.rows.size(); ++r) warm_start_from(earlier, r);
  }
  if (!fs::exists(fs::path(directory_) / "study.json")) write(progress);  // the directory is ours from now on
  // All variants of one size before the next size: a study that is stopped has something to compare.
  for (std::size_t s = 0, number = 0; s < options_.sizes.size(); ++s)
    for (std::size_t v = 0; v < study_.variants.size(); ++v) {
      const std::size_t r = v * options_.sizes.size() + s;
      const StudyRow& row = study_.rows[r];
      ++number;
      if (row.status != StudyRow::Status::not_run || children_.stop_signal() != 0) continue;
      progress.begin_phase(
          fmt::format("run {} of {}: {}, {} = {}", number, study_.rows.size(), row.variant, study_.key, row.size));
      run_row(r, progress);
      if (children_.stop_signal() == 0) write(progress);
    }
  const int stopped = children_.stop_signal();
  if (stopped == 0) write(progress);
  progress.finish();
  if (stopped == 0 && !options_.keep) fs::remove_all(fs::path(directory_) / "runs");
  fmt::print("{}", study_summary(study_, directory_));
  if (stopped != 0) {
    fmt::print(stderr, "cgcontact: stopped by signal {} ({}); study --resume goes on from here\n", stopped,
               strsignal(stopped));
    return 128 + stopped;
  }
  const bool all_solved = std::all_of(study_.rows.begin(), study_.rows.end(),
                                      [](const StudyRow& row) { return row.status == StudyRow::Status::solved; });
  return all_solved ? 0 : 2;
} catch (const fs::filesystem_error& error) {
  throw InputError(fmt::format("cannot write the study to {}: {}", directory_, error.code().message()));
}

}  // namespace

int run_study(const CommandLine& line) {
  undo_openmp_binding();
  return StudyRunner(line).run();
}

}  // namespace cgcontact
