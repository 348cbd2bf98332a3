/// Command line of the program.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/program/plot_options.hpp"
#include "core/program/study_options.hpp"
#include "core/scene_file/templates/scene_template.hpp"

namespace cgcontact {

/// Options that are not given are taken from these variables of the environment; one that is empty counts as not set.
constexpr const char* out_variable = "CGCONTACT_OUT";
constexpr const char* threads_variable = "CGCONTACT_THREADS";
constexpr const char* set_variable = "CGCONTACT_SET";  ///< KEY=VALUE;KEY=VALUE;..., before those of --set

struct CommandLine {
  enum Command { run, check, study, init, compare, plot };
  Command command = run;
  std::string scene;                                                  ///< file
  std::string out;                                                    ///< output directory; empty: as the scene says
  int threads = 0;                                                    ///< 0: as the backend and OMP_NUM_THREADS say
  std::string threads_given_by = "--threads";                         ///< or the variable of the environment
  std::vector<std::string> overrides;                                 ///< "key=value"
  std::vector<std::pair<std::string, std::string>> from_environment;  ///< variable, value: texts that were used
  std::string memory_limit;  ///< as for parse_memory (core/base/process/memory.hpp); empty: what there is
  StudyOptions study_options;
  std::string first_result, second_result;  ///< compare: output directories
  InitOptions init_options;
  PlotOptions plot_options;
  bool settings = false;  ///< check: print them too
  bool quiet = false;     ///< run: print nothing but warnings and errors
  bool json = false;      ///< run: print the report instead of the summary

  /// Adds the name of the variable to an error message on a value from the environment.
  std::string with_variables(const std::string& message) const;
};

/// Parses the arguments (argv[0] is the program). Returns nothing if the program is to end with `exit_code` right away:
/// 0 after --help and --version (printed to standard output), 1 after a mistake (one message on standard error).
std::optional<CommandLine> parse_command_line(int argc, const char* const* argv, int& exit_code);

}  // namespace cgcontact
