#include "core/program/cli.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <tuple>

#include "core/base/errors/errors.hpp"
#include "core/base/errors/suggest.hpp"
#include "core/base/process/memory.hpp"
#include "core/base/process/ranks.hpp"

#ifndef CGCONTACT_VERSION
#define CGCONTACT_VERSION "unknown"
#endif

namespace cgcontact {

namespace {

using Take = std::function<void(const std::string&)>;

const char* const general_footer =
    "Examples:\n"
    "  cgcontact init                                  a scene to start from, in scene.toml\n"
    "  cgcontact init --stl part.stl --unit mm         the same with a part of yours, in part.toml\n"
    "  cgcontact check scenes/rings.toml\n"
    "  cgcontact run scenes/two_solids.toml --set n=32 --out out/fine\n"
    "  cgcontact study scenes/rings.toml --vary n=8,16,32\n"
    "More on a command: cgcontact COMMAND --help\n"
    "Environment: CGCONTACT_OUT, CGCONTACT_THREADS, CGCONTACT_SET (KEY=VALUE;KEY=VALUE), CGCONTACT_MEMORY_LIMIT\n"
    "  stand for --out, --threads, --set, --memory-limit; the command line comes first.\n"
    "Exit codes: 0 solved (or scene is good), 1 bad input, 2 did not converge (results are written and marked so).\n"
    "docs/tutorial.md begins at the beginning; docs/scene.md describes scenes, docs/study.md studies, docs/faq.md "
    "failures\n"
    "(installed in share/doc/cgcontact).";

const char* const run_footer =
    "Examples:\n"
    "  cgcontact run scenes/two_solids.toml\n"
    "  cgcontact run scenes/two_solids.toml --set n=32 --set solver.tolerance=1e-8 --out out/fine\n"
    "  cgcontact run scenes/hertz.toml --set body.block.material.E=70e9 --set output.plots=false\n"
    "  CGCONTACT_SET='n=32;recovery.degree=1' cgcontact run scenes/rings.toml\n"
    "Exit codes: 0 solved, 1 bad input, 2 did not converge (results are written and marked so).\n"
    "Keys of --set and of scenes: docs/scene.md.";

const char* const check_footer =
    "Examples:\n"
    "  cgcontact check scenes/rings.toml\n"
    "  cgcontact check scenes/rings.toml --out out/check         a picture of it, and files for ParaView\n"
    "  cgcontact check scenes/hertz.toml --set n=100      how many unknowns would that be, and how much memory?\n"
    "  cgcontact check scenes/hertz.toml --settings       all settings with default, range and meaning\n"
    "Exit codes: 0 the scene is good, 1 it is not (one message says where).\n"
    "Keys of --set and of scenes: docs/scene.md.";

const char* const study_footer =
    "Examples:\n"
    "  cgcontact study scenes/rings.toml --vary n=8,16,32\n"
    "  cgcontact study scenes/rail.toml --refine 0.5,0.7,1,1.4 --keep\n"
    "  cgcontact study scenes/two_solids_3d.toml --vary n=8,16 --preconditioner multigrid,muelu --repeat 3\n"
    "  cgcontact study scenes/two_solids_3d.toml --backend "
    "serial=build/serial/cgcontact,openmp=build/openmp/cgcontact\n"
    "Exit codes: 0 all runs solved, 1 bad input, 2 at least one run failed or did not converge.\n"
    "Studies: docs/study.md. Keys of --vary and --set: docs/scene.md.";

const char* const compare_footer =
    "Examples:\n"
    "  cgcontact compare out/rings out/fine\n"
    "  cgcontact compare out/rings out/fine --out out/compare     compare.csv and the pressure curves on each other\n"
    "Bodies and contact pairs are compared by their names.\n"
    "Exit codes: 0 compared, 1 bad input.";

const char* const plot_footer =
    "Examples:\n"
    "  cgcontact plot out/rings                                      plot.png: the surfaces, von Mises stress\n"
    "  cgcontact plot out/rings --field stress_zz --section z=0mm    a section, seen against its axis\n"
    "  cgcontact plot out/rings --zoom contact --range '0:2 MPa' --out near.png\n"
    "  cgcontact plot out/rings --field displacement --body inner --deformed 100\n"
    "The result needs result.vtkhdf (output.vtk = true), steps also steps.vtkhdf, --zoom contact.vtkhdf.\n"
    "Exit codes: 0 drawn, 1 bad input (nothing is written).";

const char* const init_footer =
    "Examples:\n"
    "  cgcontact init                                  scene.toml: a sphere on a block, with Hertz's solution\n"
    "  cgcontact init first.toml\n"
    "  cgcontact init part.stl --unit mm               part.toml: the part under a plate, faces and TODOs listed\n"
    "  cgcontact init fine.toml --stl part.obj --unit in --cells 40\n"
    "  cgcontact init assembly.step                    assembly.toml: all its solids as bodies, pairs that may touch\n"
    "  cgcontact init deck.inp --unit mm               deck.toml: bodies, conditions, pairs of a CalculiX or Abaqus "
    "deck\n"
    "The scene runs as it is. A file that exists is never overwritten.\n"
    "Exit codes: 0 written, 1 bad input (nothing is written).";

/// Empty, or what is wrong with the value of an option.
std::string not_empty(const std::string& value) { return value.empty() ? "is empty (allowed: a directory)" : ""; }

std::string long_name(const CLI::Option& option) {
  return option.get_lnames().empty() ? "" : "--" + option.get_lnames().front();
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    if (!option->get_lnames().empty()) names.push_back(long_name(*option));
  return names;
}

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// The command with this name, or null.
const CLI::App* find_command(const CLI::App& app, const std::string& name) {
  for (const CLI::App* command : app.get_subcommands({}))
    if (command->get_name() == name) return command;
  return nullptr;
}

class Parser {
 public:
  Parser();
  /// Throws CLI::Error and InputError.
  void parse(int argc, const char* const* argv);
  std::string explain(const CLI::Error& error, int argc, const char* const* argv) const;

  CLI::App app{"cgcontact: contact between elastic bodies on Cartesian grids", "cgcontact"};
  CommandLine line;

 private:
  /// Default of an option that is not given.
  struct Default {
    CLI::Option* option;
    const char* variable;
    Take take;
  };

  CLI::App& add_command(const std::string& name, CommandLine::Command command, const std::string& description,
                        const char* footer);
  CLI::Option* add(CLI::App& command, const std::string& name, const std::string& value, const std::string& description,
                   const Take& take);
  void add_scene(CLI::App& command);
  void add_output(CLI::App& command, const std::string& description);
  void describe_init();
  void describe_study();
  void describe_plot();
  void refuse_single_dashes(int argc, const char* const* argv) const;
  void take_environment();
  void take_set_variable(const std::string& text);
  std::vector<std::string> commands() const;
  std::string explain_extra() const;
  std::string explain_option(const std::string& word, const CLI::App& command) const;
  const CLI::App& used() const;

  std::vector<Default> defaults_;
};

CLI::App& Parser::add_command(const std::string& name, CommandLine::Command command, const std::string& description,
                              const char* footer) {
  CLI::App& added = *app.add_subcommand(name, description);
  added.footer(footer);
  added.callback([this, command] { line.command = command; });
  return added;
}

/// An option whose text goes to `take`, which may throw InputError (functions of study_options.hpp).
CLI::Option* Parser::add(CLI::App& command, const std::string& name, const std::string& value,
                         const std::string& description, const Take& take) {
  const auto checked = [name, take](const std::string& text) {
    try {
      take(text);
    } catch (const InputError& error) {
      throw CLI::ValidationError(name.substr(name.find("--")), error.what());
    }
  };
  return command.add_option_function<std::string>(name, checked, description)->type_name(value);
}

void Parser::add_scene(CLI::App& command) {
  command.add_option("SCENE", line.scene, "Scene file (TOML, SI units)")->required()->type_name("");
  CLI::Option* const set = command
                               .add_option("--set", line.overrides,
                                           "Replace a value of the scene; may be repeated [environment: CGCONTACT_SET]")
                               ->type_name("KEY=VALUE")
                               ->allow_extra_args(false);
  defaults_.push_back({set, set_variable, [this](const std::string& text) { take_set_variable(text); }});
  add(command, "--memory-limit", "SIZE",
      "Refuse what needs more [default: what is free] [environment: CGCONTACT_MEMORY_LIMIT]",
      [this](const std::string& text) {
        parse_memory(text);
        line.memory_limit = text;
      });
}

void Parser::add_output(CLI::App& command, const std::string& description) {
  CLI::Option* const out = command.add_option("-o,--out", line.out, description + " [environment: CGCONTACT_OUT]")
                               ->type_name("DIR")
                               ->check(not_empty, "");
  defaults_.push_back({out, out_variable, [this](const std::string& text) {
                         line.out = text;
                         line.from_environment.emplace_back(out_variable, text);
                       }});
}

void Parser::describe_init() {
  CLI::App& init =
      add_command("init", CommandLine::init, "Write a commented scene to start from; it runs as it is", init_footer);
  InitOptions& options = line.init_options;
  init.add_option("FILE", options.file, "Scene to write [default: scene.toml], or a part: CAD file, surface, deck.inp")
      ->type_name("")
      ->check([](const std::string& value) { return value.empty() ? "is empty (allowed: a name in .toml)" : ""; }, "");
  add(init, "--stl", "FILE", "A closed surface (.stl, .obj, .ply or .off) to be a body of the scene",
      [&options](const std::string& text) {
        if (text.empty()) throw InputError("is empty (allowed: an .stl, .obj, .ply or .off file)");
        options.surface = text;
      });
  add(init, "--cad", "FILE", "A CAD file (.step, .iges or .brep) whose solids become bodies; without --cad: init FILE",
      [&options](const std::string& text) {
        if (text.empty()) throw InputError("is empty (allowed: a .step, .iges or .brep file)");
        options.cad = text;
      });
  add(init, "--unit", "UNIT", "Unit of the surface: " + join(unit_names()),
      [&options](const std::string& text) { options.unit = parse_unit(text); });
  init.add_flag("--repair", options.repair, "Repair a surface that is open, crosses itself, ...; what changed is told");
  add(init, "--cells", "N", "Cells of one size, N along the longest side, and no [accuracy]",
      [&options](const std::string& text) { options.cells = parse_init_cells(text); });
}

void Parser::describe_study() {
  StudyOptions& options = line.study_options;
  CLI::App& study = add_command("study", CommandLine::study,
                                "Run a scene over sizes and variants; table and plots of error and cost", study_footer);
  add_scene(study);
  add_output(study, "Output directory [default: out/<scene name>-study]");
  CLI::Option* const refine =
      add(study, "--refine", "F,F,...", "Sizes: divide all cell sizes by each of these factors [default: 0.5,1]",
          [&options](const std::string& text) { options.sizes = parse_factors(text); });
  add(study, "--vary", "KEY=X,X,...", "Sizes: give a value of the scene, such as a parameter, each of these numbers",
      [&options](const std::string& text) { std::tie(options.key, options.sizes) = parse_vary(text); })
      ->excludes(refine);
  add(study, "--preconditioner", "NAME,...", "Variants: each of these values of solver.preconditioner",
      [&options](const std::string& text) {
        options.preconditioners = parse_list(text, "values of solver.preconditioner");
      });
  const Take take_threads = [&options](const std::string& text) { options.threads = parse_thread_list(text); };
  CLI::Option* const threads =
      add(study, "-t,--threads", "N,...", "Variants: each of these numbers of threads [environment: CGCONTACT_THREADS]",
          take_threads);
  defaults_.push_back({threads, threads_variable, take_threads});
  add(study, "--backend", "NAME=PROGRAM,...", "Variants: each of these builds of the program",
      [&options](const std::string& text) { options.backends = parse_backends(text); });
  add(study, "--repeat", "K", "Run everything K times, the fastest run counts",
      [&options](const std::string& text) { options.repeat = parse_repeat(text); });
  study.add_flag("--keep", options.keep, "Keep the results of every run, in the folder runs");
  study.add_flag("--resume", options.resume, "Take over what an earlier study in the same directory has finished");
}

void Parser::describe_plot() {
  PlotOptions& options = line.plot_options;
  CLI::App& plot = add_command("plot", CommandLine::plot,
                               "Draw a finished result again: any field, section, range, place", plot_footer);
  plot.add_option("DIR", options.directory, "Output directory of a run")
      ->required()
      ->type_name("")
      ->check(not_empty, "");
  add(plot, "--field", "NAME", "What the colours show [default: von_mises]; a wrong name lists what there is",
      [&options](const std::string& text) { options.field = text; });
  add(plot, "--section", "AXIS=VALUE", "Cut the bodies across an axis, such as z=5mm [default: their surfaces]",
      [&options](const std::string& text) { options.section = parse_plane(text); });
  add(plot, "--range", "LOW:HIGH", "Ends of the colours, such as '0:300 MPa' [default: from the values]",
      [&options](const std::string& text) { options.range = parse_ends(text); });
  add(plot, "--zoom", "contact", "Only what is near a contact zone: contact, or contact:PAIR [default: everything]",
      [&options](const std::string& text) {
        options.pair = parse_zoom(text);
        options.zoom = true;
      });
  add(plot, "--step", "K", "Step of a result with steps, from 1 [default: the last one]",
      [&options](const std::string& text) { options.step = parse_plot_step(text); });
  plot.add_option("--body", options.bodies, "Draw this body; may be repeated [default: all]")
      ->type_name("NAME")
      ->allow_extra_args(false);
  add(plot, "--deformed", "FACTOR", "Multiply the displacements that are drawn [default: 1, of sections 0]",
      [&options](const std::string& text) { options.deformed = parse_deformed(text); });
  add(plot, "-o,--out", "FILE.png", "Picture to write; a PNG that is there is replaced [default: plot.png]",
      [&options](const std::string& text) { options.out = text; });
}

Parser::Parser() {
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.set_version_flag("--version", std::string("cgcontact ") + CGCONTACT_VERSION, "Print the version and exit");
  app.require_subcommand(1);
  app.footer(general_footer);
  describe_init();
  CLI::App& run =
      add_command("run", CommandLine::run, "Solve a scene and write pressure, stress, report and pictures", run_footer);
  add_scene(run);
  add_output(run, "Output directory [default: out/<scene name>]");
  const Take take_threads = [this](const std::string& text) { line.threads = parse_threads(text); };
  CLI::Option* const threads =
      add(run, "-t,--threads", "N", "Number of threads [default: all that there are] [environment: CGCONTACT_THREADS]",
          take_threads);
  defaults_.push_back({threads, threads_variable, [this, take_threads](const std::string& text) {
                         take_threads(text);
                         line.threads_given_by = threads_variable;
                       }});
  run.add_flag("-q,--quiet", line.quiet, "Print warnings and errors only");
  run.add_flag("--json", line.json, "Print report.json in the place of the summary; with --quiet nothing else");
  CLI::App& check = add_command("check", CommandLine::check,
                                "Validate a scene and print what it contains, without solving", check_footer);
  add_scene(check);
  check
      .add_option("-o,--out", line.out,
                  "Draw it too: check.png and files for ParaView go there [default: nothing is written]")
      ->type_name("DIR")
      ->check(not_empty, "");
  check.add_flag("--settings", line.settings, "Print all settings with default, range and meaning too, as TOML");
  describe_study();
  CLI::App& compare =
      add_command("compare", CommandLine::compare, "Put the results of two runs side by side", compare_footer);
  compare.add_option("A", line.first_result, "Output directory of a run")
      ->required()
      ->type_name("")
      ->check(not_empty, "");
  compare.add_option("B", line.second_result, "That of another one")->required()->type_name("")->check(not_empty, "");
  compare
      .add_option("-o,--out", line.out, "Write compare.csv and the pressure curves there [default: nothing is written]")
      ->type_name("DIR")
      ->check(not_empty, "");
  describe_plot();
}

std::vector<std::string> Parser::commands() const {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

/// The command that was given, or the program.
const CLI::App& Parser::used() const {
  const auto given = app.get_subcommands();
  return given.empty() ? app : *given.front();
}

/// "-out DIR" would be read as the option -o with the value "ut".
void Parser::refuse_single_dashes(int argc, const char* const* argv) const {
  if (argc < 2) return;
  const CLI::App* const command = find_command(app, argv[1]);
  const std::vector<std::string> known = option_names(command ? *command : app);
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word.size() > 2 && word[0] == '-' && word[1] != '-' && contains(known, "-" + word))
      throw InputError(fmt::format("unknown option \"{}\" (did you mean \"-{}\"?)", word, word));
  }
}

/// Takes --set: the texts between ";", which come before those of --set.
void Parser::take_set_variable(const std::string& text) {
  std::vector<std::string> changes;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(';', begin), text.size());
    const std::string change = text.substr(begin, end - begin);
    begin = end + 1;
    if (change.find_first_not_of(" \t\n") == std::string::npos) continue;
    const std::size_t first = change.find_first_not_of(" \t\n");
    changes.push_back(change.substr(first));
    if (change.find('=') == std::string::npos)
      throw InputError(fmt::format("\"{}\" has no \"=\" (allowed: KEY=VALUE;KEY=VALUE;...)", changes.back()));
    line.from_environment.emplace_back(set_variable, changes.back());
  }
  line.overrides.insert(line.overrides.begin(), changes.begin(), changes.end());
}

void Parser::take_environment() {
  for (const Default& entry : defaults_) {
    const char* const text = std::getenv(entry.variable);
    const std::vector<const CLI::Option*> options = used().get_options();
    const bool of_command = std::find(options.begin(), options.end(), entry.option) != options.end();
    const bool adds = entry.variable == set_variable;
    if (!text || !*text || !of_command || (entry.option->count() > 0 && !adds)) continue;
    try {
      entry.take(text);
    } catch (const InputError& error) {
      throw InputError(fmt::format("the environment variable {}: {}", entry.variable, error.what()));
    }
  }
}

void Parser::parse(int argc, const char* const* argv) {
  refuse_single_dashes(argc, argv);
  app.parse(argc, argv);
  take_environment();
}

/// The first argument that nobody expected, with a suggestion.
std::string Parser::explain_extra() const {
  const std::vector<std::string> rest = app.remaining(true);
  const auto is_option = [](const std::string& word) { return !word.empty() && word[0] == '-'; };
  const auto found = std::find_if(rest.begin(), rest.end(), is_option);
  if (found == rest.end()) return "unexpected argument \"" + (rest.empty() ? "" : rest[0]) + "\"";
  return explain_option(*found, used());
}

/// An option that the command, or the program before any command, does not have.
std::string Parser::explain_option(const std::string& word, const CLI::App& command) const {
  const std::string option = word.substr(0, word.find('='));
  const std::vector<std::string> known = option_names(command);
  std::vector<std::string> owners;
  for (const CLI::App* other : app.get_subcommands({}))
    if (contains(option_names(*other), option)) owners.push_back(other->get_name());
  if (&command == &app && !owners.empty())
    return "the option \"" + option + "\" comes after its command (" + join(owners) + ")";
  const std::string hint = owners.empty() ? did_you_mean(option, known) : " (it belongs to " + join(owners) + ")";
  return "unknown option \"" + option + "\"" + (&command == &app ? "" : " of " + command.get_name()) + hint +
         " (allowed: " + join(known) + ")";
}

/// The words of the error in one line, with a suggestion if a word is misspelt.
std::string Parser::explain(const CLI::Error& error, int argc, const char* const* argv) const {
  if (argc < 2) return "a command is needed: init, run SCENE, check SCENE, study SCENE, compare A B or plot DIR";
  const std::string first = argv[1];
  if (first[0] != '-' && !contains(commands(), first)) {
    const bool is_scene = first.size() > 5 && first.substr(first.size() - 5) == ".toml";
    std::vector<std::string> similar = commands();
    similar.insert(similar.end(), {"--help", "--version"});
    return "unknown command \"" + first + "\"" +
           (is_scene ? " (did you mean \"run " + first + "\"?)" : did_you_mean(first, similar)) +
           " (allowed: " + join(commands()) + ")";
  }
  if (first[0] == '-' && !contains({"-h", "--help", "--version"}, first)) return explain_option(first, app);
  if (dynamic_cast<const CLI::ExtrasError*>(&error)) return explain_extra();
  std::string text = error.what();
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error))
    text = text.substr(0, text.find(':')) +
           (text.find("received") != std::string::npos ? " is given more than once" : " needs a value");
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

std::string CommandLine::with_variables(const std::string& message) const {
  for (const auto& [variable, value] : from_environment)
    if (message.find(value) != std::string::npos)
      return fmt::format("{} (from the environment: {}={})", message, variable, value);
  return message;
}

std::optional<CommandLine> parse_command_line(int argc, const char* const* argv, int& exit_code) {
  Parser parser;
  if (argc > 1 && std::string(argv[1]) == "help") {  // cgcontact help run
    std::vector<const char*> words{argv[0]};
    if (argc > 2) words.push_back(argv[2]);
    if (argc == 2 || find_command(parser.app, argv[2])) words.push_back("--help");
    return parse_command_line(static_cast<int>(words.size()), words.data(), exit_code);
  }
  const bool silent = ranks_of_mpirun().second > 0;  // the first rank reports it
  std::ostream nowhere(nullptr);
  exit_code = 0;
  std::string mistake;
  try {
    parser.parse(argc, argv);
    return parser.line;
  } catch (const CLI::Success& success) {  // --help, --version
    exit_code = parser.app.exit(success, silent ? nowhere : std::cout, silent ? nowhere : std::cerr);
    return std::nullopt;
  } catch (const CLI::Error& error) {
    mistake = parser.explain(error, argc, argv);
  } catch (const InputError& error) {
    mistake = error.what();
  }
  const CLI::App* const command = argc > 1 ? find_command(parser.app, argv[1]) : nullptr;
  (silent ? nowhere : std::cerr) << "cgcontact: " << printable(mistake) << " (see cgcontact "
                                 << (command ? command->get_name() + " " : "") << "--help)\n";
  exit_code = 1;
  return std::nullopt;
}

}  // namespace cgcontact
