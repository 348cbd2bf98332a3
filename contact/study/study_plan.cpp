#include "contact/study/study_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <filesystem>

#include "core/base/files/text.hpp"
#include "core/scene_file/read_scene.hpp"

namespace cgcontact {

namespace {

namespace fs = std::filesystem;

/// One curve: build, preconditioner, threads; preconditioner empty and threads 0 where the study does not vary them.
struct Variant {
  std::string name, program, preconditioner;
  int threads = 0;
};

std::vector<Variant> make_variants(const StudyOptions& options, const std::string& scene_preconditioner) {
  std::vector<StudyOptions::Backend> backends = options.backends;
  if (backends.empty()) backends.push_back({"", fs::read_symlink("/proc/self/exe").string()});
  std::vector<std::string> preconditioners = options.preconditioners;
  if (preconditioners.empty()) preconditioners.emplace_back();
  std::vector<int> threads = options.threads;
  if (threads.empty()) threads.push_back(0);
  std::vector<Variant> variants;
  for (const StudyOptions::Backend& backend : backends)
    for (const std::string& preconditioner : preconditioners)
      for (const int number : threads) {
        std::vector<std::string> words;
        if (!backend.name.empty()) words.push_back(backend.name);
        if (!preconditioner.empty()) words.push_back(preconditioner);
        if (number > 0) words.push_back(fmt::format("{} thread{}", number, number == 1 ? "" : "s"));
        std::string name = scene_preconditioner;
        if (!words.empty()) name = fmt::format("{}", fmt::join(words, ", "));
        variants.push_back({name, backend.program, preconditioner, number});
      }
  return variants;
}

/// FNV-1a.
std::string hash_of(const std::string& text) {
  std::uint64_t hash = 14695981039346656037u;
  for (const unsigned char c : text) hash = (hash ^ c) * 1099511628211u;
  return fmt::format("{:016x}", hash);
}

std::string file_name(std::string text) {
  for (char& c : text)
    if (!std::isalnum(static_cast<unsigned char>(c)) && !std::strchr("._=+-", c)) c = '_';
  return text;
}

/// Reads a scene that an option of the study has changed; mistakes are blamed on that option.
Scene read_changed_scene(const std::string& file, std::vector<std::string> overrides, const std::string& key,
                         const std::string& value, const std::string& option) {
  const std::string change = key + "=" + value;
  overrides.push_back(change);
  try {
    return read_scene(file, overrides);
  } catch (const InputError& error) {
    std::string problem = error.what();
    const std::string prefix = "--set " + change + ": ";
    if (problem.rfind(prefix, 0) == 0) problem.erase(0, prefix.size());
    throw InputError(fmt::format("{}: {}", option, problem));
  }
}

/// Returns what the run replaces in the scene. Pictures, fields and intermediate steps are left out unless the user
/// asks for them.
std::vector<std::string> overrides_of(const CommandLine& line, const Variant& variant, const std::string& size,
                                      const Scene& as_it_is, bool own_reference) {
  std::vector<std::string> overrides{"output.vtk=false", "output.plots=false"};
  const auto has_own_steps = [](const auto& spec) { return !spec.steps.empty(); };
  const bool with_own_steps = std::any_of(as_it_is.loads.begin(), as_it_is.loads.end(), has_own_steps) ||
                              std::any_of(as_it_is.supports.begin(), as_it_is.supports.end(), has_own_steps);
  if (!as_it_is.steps.empty() && !with_own_steps) overrides.emplace_back("steps={factors=[1]}");
  overrides.insert(overrides.end(), line.overrides.begin(), line.overrides.end());
  if (own_reference) overrides.emplace_back("output.csv=true");
  if (!variant.preconditioner.empty()) overrides.push_back("solver.preconditioner=" + variant.preconditioner);
  if (!line.study_options.key.empty()) {
    overrides.push_back(line.study_options.key + "=" + size);
  } else {
    for (const BodySpec& body : as_it_is.bodies)
      overrides.push_back(fmt::format("body.{}.cell_size={}", body.name, body.cell_size / std::stod(size)));
  }
  return overrides;
}

/// The same for runs that give the same results.
std::string fingerprint(const StudyRow& row, const Scene& scene, int repeat) {
  const auto written = fs::last_write_time(row.command[0]).time_since_epoch().count();
  std::string identity =
      fmt::format("{}\n{}\n{}\n{}\n", fmt::join(row.command, "\n"), repeat, written, read_text(scene.file));
  for (const std::string& file : {scene.reference.pressure_file, scene.reference.stress_file})
    if (!file.empty()) identity += read_text(file);
  return hash_of(identity);
}

void plan_row(const CommandLine& line, const Variant& variant, const std::string& size, const Scene& as_it_is,
              StudyPlan& plan) {
  const std::vector<std::string> overrides = overrides_of(line, variant, size, as_it_is, plan.study.own_reference);
  const Scene scene = read_scene(line.scene, overrides);
  StudyRow row;
  row.variant = variant.name;
  row.size = size;
  row.preconditioner = name_of(scene.solver.preconditioner);
  for (const BodySpec& body : scene.bodies) row.cell_size = std::max(row.cell_size, body.cell_size);
  row.force_reference = scene.reference.force;
  row.directory = file_name(fmt::format("{}_{}={}", variant.name, plan.study.key, size));
  row.command = {variant.program, "run", line.scene};
  for (const std::string& change : overrides) row.command.insert(row.command.end(), {"--set", change});
  if (variant.threads > 0) row.command.insert(row.command.end(), {"--threads", std::to_string(variant.threads)});
  row.fingerprint = fingerprint(row, scene, plan.study.repeat);
  plan.study.rows.push_back(row);
  plan.scenes.push_back(scene);
}

}  // namespace

StudyPlan plan_study(const CommandLine& line) {
  const StudyOptions& options = line.study_options;
  const Scene as_it_is = read_scene(line.scene, line.overrides);
  for (const std::string& name : options.preconditioners)
    read_changed_scene(line.scene, line.overrides, "solver.preconditioner", name, "--preconditioner " + name);
  for (const std::string& size : options.key.empty() ? std::vector<std::string>() : options.sizes)
    read_changed_scene(line.scene, line.overrides, options.key, size, "--vary " + options.key + "=" + size);
  if (options.key.empty())
    for (const BodySpec& body : as_it_is.bodies)
      if (body.cell_size == 0)
        throw InputError(body.location, "\"" + body.name + "\"", "has no cell_size that --refine could divide",
                         "--vary accuracy.pressure=5%,2%,1%");
  StudyPlan plan;
  Study& study = plan.study;
  study.scene_file = line.scene;
  study.title = as_it_is.title;
  study.key = options.key.empty() ? "refine" : options.key;
  study.repeat = options.repeat;
  const ReferenceSpec& reference = as_it_is.reference;
  if (reference.pressure) study.reference = "the scene's expression";
  if (!reference.pressure_file.empty()) study.reference = "the scene's file " + reference.pressure_file;
  study.own_reference = !reference.pressure && reference.pressure_file.empty() && !as_it_is.contacts.empty();
  for (const Variant& variant : make_variants(options, name_of(as_it_is.solver.preconditioner))) {
    study.variants.push_back(variant.name);
    for (const std::string& size : options.sizes) plan_row(line, variant, size, as_it_is, plan);
  }
  return plan;
}

}  // namespace cgcontact
