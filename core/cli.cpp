#include "core/cli.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <iostream>
#include <tuple>

#include "core/errors.hpp"
#include "core/memory.hpp"
#include "core/suggest.hpp"

#ifndef CGCONTACT_VERSION
#define CGCONTACT_VERSION "unknown"
#endif

namespace cgcontact {

namespace {

const char* const footer =
    "Examples:\n"
    "  cgcontact run scenes/two_solids.toml\n"
    "  cgcontact run scenes/two_solids.toml --set n=32 --set solver.tolerance=1e-8 --out out/fine\n"
    "  cgcontact check scenes/rings.toml\n"
    "  cgcontact study scenes/rings.toml --vary n=8,16,32\n"
    "Exit codes: 0 solved (or scene is good), 1 bad input, 2 did not converge (results are written and marked so).\n"
    "The scene file is described in docs/scene.md, studies in docs/study.md.";

/// Empty, or what is wrong with the value of an option.
std::string not_empty(const std::string& value) { return value.empty() ? "is empty (allowed: a directory)" : ""; }

/// An option whose text goes to `take`, which may throw InputError (functions of study_options.hpp).
CLI::Option* add_parsed(CLI::App& command, const std::string& name, const std::function<void(const std::string&)>& take,
                        const std::string& description) {
  const auto checked = [name, take](const std::string& text) {
    try {
      take(text);
    } catch (const InputError& error) {
      throw CLI::ValidationError(name.substr(name.find("--")), error.what());
    }
  };
  return command.add_option_function<std::string>(name, checked, description);
}

void add_common_options(CLI::App& command, CommandLine& line) {
  command.add_option("SCENE", line.scene, "Scene file (TOML, SI units)")->required()->type_name("");
  command
      .add_option("--set", line.overrides,
                  "Replace a value of the scene: a dotted key (array elements by name or index) or a parameter; may be "
                  "repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  const auto take_limit = [&line](const std::string& text) {
    parse_memory(text);
    line.memory_limit = text;
  };
  add_parsed(command, "--memory-limit", take_limit,
             "Refuse scenes that need more, e.g. 8GB, none [default: the memory that is free]")
      ->type_name("SIZE");
}

void add_output_option(CLI::App& command, CommandLine& line, const std::string& description) {
  command.add_option("-o,--out", line.out, description)->type_name("DIR")->check(not_empty, "");
}

void describe_study(CLI::App& study, CommandLine& line) {
  StudyOptions& options = line.study_options;  // outlives this function, as the functions below need
  add_common_options(study, line);
  add_output_option(study, line, "Directory of table and plots [default: out/<scene name>-study]");
  const auto add = [&study](const std::string& name, const std::string& value, const std::string& description,
                            const std::function<void(const std::string&)>& take) {
    return add_parsed(study, name, take, description)->type_name(value);
  };
  CLI::Option* const refine =
      add("--refine", "F,F,...", "Sizes: divide all cell sizes of the scene by each of these factors [default: 0.5,1]",
          [&options](const std::string& text) { options.sizes = parse_factors(text); });
  add("--vary", "KEY=X,X,...", "Sizes: give a value of the scene, for example its parameter n, each of these numbers",
      [&options](const std::string& text) { std::tie(options.key, options.sizes) = parse_vary(text); })
      ->excludes(refine);
  add("--preconditioner", "NAME,...", "Variants: each of these values of solver.preconditioner",
      [&options](const std::string& text) {
        options.preconditioners = parse_list(text, "values of solver.preconditioner");
      });
  add("-t,--threads", "N,...", "Variants: each of these numbers of threads",
      [&options](const std::string& text) { options.threads = parse_thread_list(text); });
  add("--backend", "NAME=PROGRAM,...", "Variants: each of these builds of the program",
      [&options](const std::string& text) { options.backends = parse_backends(text); });
  add("--repeat", "K", "Run everything K times, the fastest run counts",
      [&options](const std::string& text) { options.repeat = parse_repeat(text); });
  study.add_flag("--keep", options.keep, "Keep the results of every run, in the folder runs");
  study.add_flag("--resume", options.resume, "Take over what an earlier study in the same directory has finished");
  study.callback([&line] { line.command = CommandLine::study; });
}

void describe(CLI::App& app, CommandLine& line) {
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.set_version_flag("--version", std::string("cgcontact ") + CGCONTACT_VERSION, "Print the version and exit");
  app.require_subcommand(1);
  app.footer(footer);

  CLI::App& run = *app.add_subcommand("run", "Solve a scene and write pressure, stress, report and pictures");
  add_common_options(run, line);
  add_output_option(run, line, "Output directory [default: out/<scene name>, or the scene's output.directory]");
  add_parsed(
      run, "-t,--threads", [&line](const std::string& text) { line.threads = parse_threads(text); },
      "Number of threads [default: all that the backend offers]")
      ->type_name("N");
  run.callback([&line] { line.command = CommandLine::run; });

  CLI::App& check = *app.add_subcommand("check", "Validate a scene and print what it contains, without solving");
  add_common_options(check, line);
  check.callback([&line] { line.command = CommandLine::check; });

  describe_study(*app.add_subcommand("study", "Run a scene over sizes and variants; table and plots of error and cost"),
                 line);
}

/// The first argument that nobody expected, with a suggestion.
std::string explain_extra(const CLI::App& app) {
  const std::vector<std::string> rest = app.remaining(true);
  const auto is_option = [](const std::string& word) { return !word.empty() && word[0] == '-'; };
  const auto option = std::find_if(rest.begin(), rest.end(), is_option);
  if (option == rest.end()) return "unexpected argument \"" + (rest.empty() ? "" : rest[0]) + "\"";
  std::vector<std::string> known = {"--set", "--memory-limit", "--help"};
  if (app.got_subcommand("run")) known.insert(known.end(), {"--out", "--threads"});
  if (app.got_subcommand("study"))
    known.insert(known.end(), {"--out", "--refine", "--vary", "--preconditioner", "--threads", "--backend", "--repeat",
                               "--keep", "--resume"});
  return "unknown option \"" + *option + "\"" + did_you_mean(*option, known) + " (allowed: " + join(known) + ")";
}

/// The words of the error in one line, with a suggestion if a word is misspelt.
std::string explain(const CLI::Error& error, const CLI::App& app, int argc, const char* const* argv) {
  const std::vector<std::string> commands = {"run", "check", "study"};
  if (argc < 2) return "a command is needed: run SCENE, check SCENE or study SCENE";
  const std::string first = argv[1];
  if (first[0] != '-' && std::find(commands.begin(), commands.end(), first) == commands.end()) {
    const bool is_scene = first.size() > 5 && first.substr(first.size() - 5) == ".toml";
    return "unknown command \"" + first + "\"" +
           (is_scene ? " (did you mean \"run " + first + "\"?)" : did_you_mean(first, commands)) +
           " (allowed: " + join(commands) + ")";
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
