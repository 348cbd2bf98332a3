/// Program: reads the command line, begins, checks, runs or studies a scene, writes the results. Exit codes: 0 solved,
/// 1 bad input, 2 did not converge (results written and marked), 128 + number of the signal (130, 143, 129) stopped by
/// SIGINT, SIGTERM, SIGHUP.
#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <optional>

#include "contact/adaptive_run.hpp"
#include "contact/check.hpp"
#include "contact/checks/memory.hpp"
#include "contact/nested_run.hpp"
#include "contact/results/figures/postprocess.hpp"
#include "contact/simulation.hpp"
#include "contact/study/study.hpp"
#include "core/base/errors/errors.hpp"
#include "core/base/errors/mistakes.hpp"
#include "core/base/files/text.hpp"
#include "core/base/process/memory.hpp"
#include "core/base/process/parallel.hpp"
#include "core/base/process/ranks.hpp"
#include "core/base/process/resources.hpp"
#include "core/base/process/standard_descriptors.hpp"
#include "core/decks/deck_scene.hpp"
#include "core/output/output.hpp"
#include "core/output/output_compare.hpp"
#include "core/output/plot/output_plot.hpp"
#include "core/output/report/output_summary.hpp"
#include "core/program/cli.hpp"
#include "core/program/interruption.hpp"
#include "core/program/progress.hpp"
#include "core/results/warning_order.hpp"
#include "core/scene_file/read_scene.hpp"
#include "kernels/solver/linear_solver.hpp"

namespace {

using namespace cgcontact;

std::string output_directory(const CommandLine& options, const Scene& scene) {
  if (!options.out.empty()) return options.out;
  if (!scene.output.directory.empty()) return scene.output.directory;
  return "out/" + std::filesystem::path(scene.file).stem().string();
}

/// Empty, or what is to be said about the number of threads asked for.
std::string too_many_threads(const CommandLine& options) {
  const int wanted = options.threads;
  const std::string& given_by = options.threads_given_by;
  if (!TrilinosScope::has_openmp())
    return wanted > 1 ? fmt::format(
                            "{} {}: this program runs on 1 thread (backend {}); "
                            "\"make BACKEND=openmp\" builds one that runs on several",
                            given_by, wanted, TrilinosScope::backend())
                      : "";
  const int available = available_threads();
  return wanted > available ? fmt::format("{} {}: only {} hardware thread{} available, {} would be faster", given_by,
                                          wanted, available, available == 1 ? " is" : "s are", available)
                            : "";
}

std::string out_of_memory_text() {
  const std::string remedy = address_space_remedy();
  return "out of memory: a larger cell_size is needed (cgcontact check says how much memory a scene takes)" +
         (remedy.empty() ? "" : ", or more address space: " + remedy);
}

std::string command_text(char** argv) {
  std::string text;
  for (char** word = argv; *word; ++word) text += (word == argv ? "" : " ") + shell_word(*word);
  return text;
}

int check(const Scene& given, const CommandLine& options) {
  Progress progress(Progress::Mode::terminal_only);
  const CleanUp clear_line([&] { progress.abandon(); });
  progress.begin_phase("cut cells");
  const Scene scene = on_first_grids(given);
  Preparation preparation = discretise(scene, false);  // a scene that nearly fits is still described
  CheckFiles drawn;
  if (!options.out.empty()) {  // before the checks: the picture shows what may be wrong
    progress.begin_phase("drawing");
    drawn = draw(scene, preparation, options.out);
  }
  progress.finish();
  for (const std::string& warning : drawn.warnings) fmt::print("warning: {}\n", warning);
  if (!options.out.empty()) fmt::print("drawn in {}: {}\n", options.out, fmt::join(drawn.names, ", "));
  validate(scene, preparation);
  if (scene.accuracy.any()) fmt::print("[accuracy]: these are the first grids, which a run refines\n");
  fmt::print("{}", describe(scene, preparation));
  if (options.settings) fmt::print("{}", describe_settings(scene));
  check_first_grids(scene, preparation.bodies);
  check_memory(scene, preparation);
  return 0;
}

/// Summary or the report; where there is neither, the warnings that they hold.
void tell(const Results& results, const std::string& directory, const CommandLine& options, Progress& progress) {
  if (options.json) {
    fmt::print("{}", read_text((std::filesystem::path(directory) / "report.json").string()));
  } else if (!options.quiet) {
    fmt::print("{}", summary(results, directory));
  } else {
    if (results.verdict.state != Verdict::State::resolved || results.verdict.spring_share > 0)
      progress.warning(results.verdict.text);
    for (const std::string& warning : results.warnings) progress.warning(warning);
  }
}

int run(const Scene& scene, const CommandLine& options, char** argv) {
  const std::string directory = output_directory(options, scene);
  on_first_rank([&] { check_output_directory(directory); });
  const std::string threads_warning = too_many_threads(options);
  set_interruption_note(directory + " is as it was");
  const TrilinosScope trilinos(options.threads);
  const Progress::Mode mode = options.quiet ? Progress::Mode::warnings : Progress::Mode::automatic;
  Progress progress(is_first_rank() ? mode : Progress::Mode::silent);
  const CleanUp clear_line([&] { progress.abandon(); });
  if (!threads_warning.empty()) progress.warning(threads_warning);
  AdaptiveCallbacks callbacks;
  callbacks.phase = [&](const std::string& name) { progress.begin_phase(name); };
  callbacks.memory = [&](double expected) {
    if (const std::string text = forecast_text(expected); !text.empty()) progress.message(text);
  };
  callbacks.step = [&](const OuterStep& s) { progress.outer_iteration(s.iteration, s.active_points, s.residual); };
  callbacks.solved = [&](int number, const SolveFigures& solve) { progress.message(describe(number, solve)); };
  ResultWriter writer(scene, directory);
  callbacks.load_step = [&](std::size_t number, const Results& step) { writer.add_step(number, step); };
  const auto write = [&](Simulation& simulation, const Scene& solved) {
    Results& results = simulation.results;
    simulation.state.release_assembly_data();
    progress.begin_phase("output");
    const ProfiledRegion region("output");
    results.command = command_text(argv);
    results.backend = TrilinosScope::backend();
    results.threads = TrilinosScope::concurrency();
    fill_rank_figures(results);
    if (!threads_warning.empty()) results.warnings.push_back(threads_warning);
    decisive_first(results.warnings);
    for (const std::string& warning : writer.write(results, solved)) progress.warning(warning);
    progress.finish();
    if (is_first_rank()) tell(results, directory, options, progress);
    const bool last_converged = results.accuracy.solves.empty() || results.accuracy.solves.back().converged;
    if (results.converged && last_converged) return 0;
    if (is_first_rank())
      fmt::print(
          stderr, "cgcontact: {}\n",
          results.converged ? "accuracy not reached: " + results.accuracy.text : "not converged: " + results.diagnosis);
    return 2;
  };
  if (scene.accuracy.any()) {
    AdaptiveRun adaptive(scene);
    adaptive.run(callbacks);
    return write(adaptive.simulation(), adaptive.scene());
  }
  NestedRun nested(scene);
  nested.run(callbacks);
  return write(nested.simulation(), scene);
}

int compare(const CommandLine& options) {
  const Comparison comparison = compare_results(options.first_result, options.second_result, options.out);
  for (const std::string& warning : comparison.warnings) fmt::print(stderr, "warning: {}\n", printable(warning));
  fmt::print("{}", comparison.text);
  if (!comparison.files.empty())
    fmt::print("written in {}: {}\n", printable(options.out), fmt::join(comparison.files, ", "));
  return 0;
}

Scene read_scene_as_region(const CommandLine& options) {
  const ProfiledRegion region("scene");
  return read_scene(options.scene, options.overrides);
}

/// Returns what `check` finds wrong in a scene; "": it passes.
std::string fault_of(const std::string& text, const std::string& file) try {
  const Scene scene = on_first_grids(parse_scene(text, file));
  const Preparation preparation = prepare(scene);
  check_first_grids(scene, preparation.bodies);
  check_memory(scene, preparation);
  return "";
} catch (const InputError& error) {
  return error.what();
}

/// Reports an error in one line, or mistakes in a line for each; of several ranks one reports it for all. If it is this
/// rank's alone, the others are ended.
void report_error(const std::vector<std::string>& lines) {
  const int rank = this_rank(), ranks = num_ranks();
  const bool of_all = failed_on_all_ranks();
  if (!of_all || rank == 0)
    for (const std::string& line : lines)
      fmt::print(stderr, "cgcontact: {}{}\n", of_all ? "" : fmt::format("rank {} of {}: ", rank, ranks),
                 printable(line));
  if (!of_all) abort_all_ranks(1);
  failed_on_all_ranks();  // mpirun ends all as soon as one has ended: not before it is reported
}

/// The exit code, once all that was printed has been written.
int flushed(int exit_code) {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
    throw InputError(std::string("cannot write to standard output: ") + std::strerror(errno));
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_descriptors();
  std::signal(SIGXFSZ, SIG_IGN);  // a file too large for ulimit -f: an error that names the file
  int exit_code = 0;
  const auto [ranks, rank] = ranks_of_mpirun();
  const auto options = parse_command_line(argc, argv, exit_code);
  std::optional<TrilinosScope> of_all_ranks;
  try {
    // Others than `run` the first rank does alone; mpirun would end it if this one ended with an error.
    if (rank > 0 && (!options || options->command != CommandLine::run)) return 0;
    if (!options) return flushed(exit_code);
    if (ranks > 1 && options->command == CommandLine::study)
      throw InputError("study under mpirun: every run is a process of its own (allowed: cgcontact run under mpirun)");
    if (!options->memory_limit.empty()) setenv("CGCONTACT_MEMORY_LIMIT", options->memory_limit.c_str(), 1);
    if (options->command == CommandLine::compare) return flushed(compare(*options));
    if (options->command == CommandLine::study) return flushed(run_study(*options));
    if (options->command == CommandLine::run && TrilinosScope::has_openmp())
      restart_with_openmp_settings(options->threads, argv);
    if (ranks > 1 && options->command == CommandLine::run) of_all_ranks.emplace(options->threads);
    const KokkosScope kokkos(options->threads);
    if (options->command == CommandLine::init) {
      const InitOptions& init = options->init_options;
      fmt::print("{}", is_deck(init.file) ? init_deck(init, fault_of) : init_scene(init, fault_of));
      return flushed(0);
    }
    const InterruptionWatch watch;
    if (options->command == CommandLine::plot) {
      fmt::print("{}", plot_result(options->plot_options));
      return flushed(0);
    }
    const Scene scene = read_scene_as_region(*options);
    exit_code = options->command == CommandLine::check ? check(scene, *options) : run(scene, *options, argv);
    return flushed(exit_code);
  } catch (const InputError& error) {
    std::vector<std::string> lines = messages_of(error);
    for (std::string& line : lines) line = options ? options->with_variables(line) : line;
    report_error(lines);
  } catch (const std::exception& error) {
    report_error({is_out_of_memory(error) ? out_of_memory_text() : error.what()});
  }
  return 1;
}
