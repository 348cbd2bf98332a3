/// The command line of the program.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/study_options.hpp"

namespace cgcontact {

struct CommandLine {
  enum Command { run, check, study };
  Command command = run;
  std::string scene;                   ///< file
  std::string out;                     ///< output directory; empty: as the scene says
  int threads = 0;                     ///< 0: as the environment says
  std::vector<std::string> overrides;  ///< "key=value"
  std::string memory_limit;            ///< as for parse_memory (core/memory.hpp); empty: what there is
  StudyOptions study_options;
};

/// Parses the arguments (argv[0] is the program). Returns nothing if the program is to end with `exit_code` right away:
/// 0 after --help and --version (printed to standard output), 1 after a mistake (one message on standard error).
std::optional<CommandLine> parse_command_line(int argc, const char* const* argv, int& exit_code);

}  // namespace cgcontact
