#include "core/cli.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>

#include "core/suggest.hpp"

#ifndef CGCONTACT_VERSION
#define CGCONTACT_VERSION "unknown"
#endif

namespace cgcontact {

namespace {

constexpr int most_threads = 4096;

const char* const footer =
    "Examples:\n"
    "  cgcontact run scenes/two_solids.toml\n"
    "  cgcontact run scenes/two_solids.toml --set n=32 --set solver.tolerance=1e-8 --out out/fine\n"
    "  cgcontact check scenes/rings.toml\n"
    "Exit codes: 0 solved (or scene is good), 1 bad input, 2 did not converge (results are written and marked so).\n"
    "The scene file is described in docs/scene.md.";

/// Empty, or what is wrong with the value of an option.
std::string not_empty(const std::string& value) { return value.empty() ? "is empty (allowed: a directory)" : ""; }

std::string number_of_threads(const std::string& value) {
  int number = 0;
  if (CLI::detail::lexical_cast(value, number) && number >= 1 && number <= most_threads) return "";
  return fmt::format("\"{}\" is not a number of threads (allowed: an integer from 1 to {})", value, most_threads);
}

void add_common_options(CLI::App& command, CommandLine& line) {
  command.add_option("SCENE", line.scene, "Scene file (TOML, SI units)")->required()->type_name("");
  command
      .add_option("--set", line.overrides,
                  "Replace a value of the scene: a dotted key (array elements by name or index) or a parameter; may be "
                  "repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

void describe(CLI::App& app, CommandLine& line) {
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.set_version_flag("--version", std::string("cgcontact ") + CGCONTACT_VERSION, "Print the version and exit");
  app.require_subcommand(1);
  app.footer(footer);

  CLI::App& run = *app.add_subcommand("run", "Solve a scene and write pressure, stress, report and pictures");
  add_common_options(run, line);
  run.add_option("-o,--out", line.out, "Output directory [default: out/<scene name>, or the scene's output.directory]")
      ->type_name("DIR")
      ->check(not_empty, "");
  run.add_option("-t,--threads", line.threads, "Number of threads [default: all that the backend offers]")
      ->type_name("N")
      ->check(number_of_threads, "");
  run.callback([&line] { line.command = CommandLine::run; });

  CLI::App& check = *app.add_subcommand("check", "Validate a scene and print what it contains, without solving");
  add_common_options(check, line);
  check.callback([&line] { line.command = CommandLine::check; });
}

/// The first argument that nobody expected, with a suggestion.
std::string explain_extra(const CLI::App& app) {
  const std::vector<std::string> rest = app.remaining(true);
  const auto is_option = [](const std::string& word) { return !word.empty() && word[0] == '-'; };
  const auto option = std::find_if(rest.begin(), rest.end(), is_option);
  if (option == rest.end()) return "unexpected argument \"" + (rest.empty() ? "" : rest[0]) + "\"";
  std::vector<std::string> known = {"--set", "--help"};
  if (app.got_subcommand("run")) known.insert(known.end(), {"--out", "--threads"});
  return "unknown option \"" + *option + "\"" + did_you_mean(*option, known) + " (allowed: " + join(known) + ")";
}

/// The words of the error in one line, with a suggestion if a word is misspelt.
std::string explain(const CLI::Error& error, const CLI::App& app, int argc, const char* const* argv) {
  const std::vector<std::string> commands = {"run", "check"};
  if (argc < 2) return "a command is needed: run SCENE or check SCENE";
  const std::string first = argv[1];
  if (first[0] != '-' && std::find(commands.begin(), commands.end(), first) == commands.end()) {
    const bool is_scene = first.size() > 5 && first.substr(first.size() - 5) == ".toml";
    return "unknown command \"" + first + "\"" +
           (is_scene ? " (did you mean \"run " + first + "\"?)" : did_you_mean(first, commands)) +
           " (allowed: run, check)";
  }
  if (dynamic_cast<const CLI::ExtrasError*>(&error)) return explain_extra(app);
  std::string text = error.what();
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) text = text.substr(0, text.find(':')) + " needs a value";
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

std::optional<CommandLine> parse_command_line(int argc, const char* const* argv, int& exit_code) {
  CommandLine line;
  CLI::App app("cgcontact: frictionless contact between elastic bodies on Cartesian grids", "cgcontact");
  describe(app, line);
  exit_code = 0;
  try {
    app.parse(argc, argv);
    return line;
  } catch (const CLI::Success& success) {  // --help, --version
    exit_code = app.exit(success, std::cout, std::cerr);
  } catch (const CLI::Error& error) {
    std::cerr << "cgcontact: " << explain(error, app, argc, argv) << " (see cgcontact --help)\n";
    exit_code = 1;
  }
  return std::nullopt;
}

}  // namespace cgcontact
