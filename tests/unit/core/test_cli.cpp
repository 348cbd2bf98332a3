#include <gtest/gtest.h>

#include <cstdlib>
#include <initializer_list>

#include "core/program/cli.hpp"
#include "core/program/progress.hpp"

namespace cgcontact::test_cli {
namespace {

struct Outcome {
  std::optional<CommandLine> line;
  int exit_code = -1;
  std::string out, err;
};

Outcome parse(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "cgcontact");
  Outcome outcome;
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  outcome.line = parse_command_line(static_cast<int>(arguments.size()), arguments.data(), outcome.exit_code);
  outcome.out = testing::internal::GetCapturedStdout();
  outcome.err = testing::internal::GetCapturedStderr();
  return outcome;
}

TEST(CommandLine, run_takes_all_options) {
  const Outcome outcome =
      parse({"run", "a.toml", "--set", "n=3", "--out", "dir", "--set", "b.c=[0, 1]", "--threads", "4"});
  ASSERT_TRUE(outcome.line);
  EXPECT_EQ(outcome.line->command, CommandLine::run);
  EXPECT_EQ(outcome.line->scene, "a.toml");
  EXPECT_EQ(outcome.line->out, "dir");
  EXPECT_EQ(outcome.line->threads, 4);
  EXPECT_EQ(outcome.line->overrides, (std::vector<std::string>{"n=3", "b.c=[0, 1]"}));
}

TEST(CommandLine, set_does_not_swallow_the_scene) {
  const Outcome outcome = parse({"check", "--set", "n=3", "a.toml"});
  ASSERT_TRUE(outcome.line);
  EXPECT_EQ(outcome.line->command, CommandLine::check);
  EXPECT_EQ(outcome.line->scene, "a.toml");
}

TEST(CommandLine, study_takes_all_options) {
  const Outcome outcome =
      parse({"study", "a.toml", "--vary", "n=8,16", "--preconditioner", "x,y", "--threads", "1,2", "--backend",
             "sh=/bin/sh", "--repeat", "3", "--keep", "--resume", "--set", "t=1", "--out", "dir"});
  ASSERT_TRUE(outcome.line) << outcome.err;
  EXPECT_EQ(outcome.line->command, CommandLine::study);
  EXPECT_EQ(outcome.line->out, "dir");
  const StudyOptions& study = outcome.line->study_options;
  EXPECT_EQ(study.key, "n");
  EXPECT_EQ(study.sizes, (std::vector<std::string>{"8", "16"}));
  EXPECT_EQ(study.preconditioners, (std::vector<std::string>{"x", "y"}));
  EXPECT_EQ(study.threads, (std::vector<int>{1, 2}));
  EXPECT_EQ(study.backends.at(0).name, "sh");
  EXPECT_EQ(study.repeat, 3);
  EXPECT_TRUE(study.keep && study.resume);
}

TEST(CommandLine, init_takes_all_options) {
  const Outcome outcome = parse({"init", "a.toml", "--stl", "b.stl", "--unit", "mm", "--cells", "30"});
  ASSERT_TRUE(outcome.line) << outcome.err;
  EXPECT_EQ(outcome.line->command, CommandLine::init);
  const InitOptions& init = outcome.line->init_options;
  EXPECT_EQ(init.file + init.surface + init.unit, "a.tomlb.stlmm");
  EXPECT_EQ(init.cells, 30);
}

/// Sets variables for the life of a test.
class Environment {
 public:
  explicit Environment(std::initializer_list<std::pair<const char*, const char*>> variables) : variables_(variables) {
    for (const auto& [name, value] : variables_) setenv(name, value, 1);
  }
  ~Environment() {
    for (const auto& entry : variables_) unsetenv(entry.first);
  }

 private:
  std::vector<std::pair<const char*, const char*>> variables_;
};

TEST(CommandLine, environment_stands_for_options_that_are_not_given) {
  const Environment variables{{out_variable, "there"}, {threads_variable, "3"}, {set_variable, "n=1; b.c=[0, 1];"}};
  const Outcome run = parse({"run", "a.toml"});
  ASSERT_TRUE(run.line) << run.err;
  EXPECT_EQ(run.line->out, "there");
  EXPECT_EQ(run.line->threads, 3);
  EXPECT_EQ(run.line->threads_given_by, "CGCONTACT_THREADS");
  EXPECT_EQ(run.line->overrides, (std::vector<std::string>{"n=1", "b.c=[0, 1]"}));

  const Outcome given = parse({"run", "a.toml", "--out", "here", "--threads", "2", "--set", "n=2"});
  ASSERT_TRUE(given.line) << given.err;
  EXPECT_EQ(given.line->out, "here");
  EXPECT_EQ(given.line->threads, 2);
  EXPECT_EQ(given.line->threads_given_by, "--threads");
  EXPECT_EQ(given.line->overrides, (std::vector<std::string>{"n=1", "b.c=[0, 1]", "n=2"})) << "the last one counts";

  const Outcome study = parse({"study", "a.toml"});
  ASSERT_TRUE(study.line) << study.err;
  EXPECT_EQ(study.line->study_options.threads, std::vector<int>{3});
  const Outcome check = parse({"check", "a.toml"});
  ASSERT_TRUE(check.line) << check.err;
  EXPECT_EQ(check.line->out, "") << "check has no such option";
}

TEST(CommandLine, bad_values_in_the_environment_name_the_variable) {
  for (const auto& [variable, value] : {std::pair<const char*, const char*>{threads_variable, "many"},
                                        {threads_variable, "0"},
                                        {set_variable, "n=3;solver"}}) {
    const Environment bad{{variable, value}};
    const Outcome outcome = parse({"run", "a.toml"});
    EXPECT_FALSE(outcome.line);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE(outcome.err.find(std::string("the environment variable ") + variable), std::string::npos) << outcome.err;
    EXPECT_TRUE(parse({"init"}).line) << "of no concern to init";
  }
  const Environment empty{{out_variable, ""}, {threads_variable, ""}, {set_variable, ""}};
  EXPECT_TRUE(parse({"run", "a.toml"}).line) << "empty counts as not set";
}

TEST(CommandLine, help_and_version_end_well) {
  const Outcome help = parse({"--help"}), run_help = parse({"run", "--help"}), version = parse({"--version"});
  EXPECT_FALSE(help.line || run_help.line || version.line);
  EXPECT_EQ(help.exit_code + run_help.exit_code + version.exit_code, 0);
  EXPECT_NE(help.out.find("Exit codes"), std::string::npos);
  EXPECT_EQ(parse({"help"}).out, help.out);
  EXPECT_EQ(parse({"help", "run"}).out, run_help.out);
  EXPECT_NE(run_help.out.find("--threads"), std::string::npos);
  EXPECT_EQ(version.out.rfind("cgcontact ", 0), 0u);
}

TEST(CommandLine, mistakes_give_one_line_and_exit_code_1) {
  const std::vector<std::pair<std::vector<const char*>, std::string>> cases = {
      {{}, "a command is needed"},
      {{"rnu", "a.toml"}, "did you mean \"run\"?"},
      {{"a.toml"}, "did you mean \"run a.toml\"?"},
      {{"run"}, "SCENE is required"},
      {{"run", "a.toml", "--set"}, "--set needs a value"},
      {{"run", "a.toml", "--out", ""}, "--out: is empty"},
      {{"run", "a.toml", "b.toml"}, "unexpected argument \"b.toml\""},
      {{"run", "a.toml", "--thread", "2"}, "did you mean \"--threads\"?"},
      {{"run", "a.toml", "--threads", "0"}, "--threads: \"0\" is not a number of threads"},
      {{"run", "a.toml", "--threads", "2x"}, "an integer from 1 to 4096"},
      {{"init", "--out", "x"}, "unknown option \"--out\""},
      {{"study"}, "SCENE is required"},
      {{"study", "a.toml", "--vary", "n="}, "--vary: \"\" is an empty list"},
      {{"study", "a.toml", "--vary", "n=1", "--refine", "2"}, "--refine excludes --vary"},
      {{"study", "a.toml", "--threads", "0"}, "--threads: \"0\" is not a number of threads"},
      {{"study", "a.toml", "--repeat", "-1"}, "--repeat: \"-1\" is not a number of repetitions"},
      {{"study", "a.toml", "--keeep"}, "did you mean \"--keep\"?"},
      {{"run", "a.toml", "-out", "x"}, "unknown option \"-out\" (did you mean \"--out\"?)"},
      {{"--verison"}, "unknown option \"--verison\" (did you mean \"--version\"?)"},
      {{"--threads", "2", "run", "a.toml"}, "the option \"--threads\" comes after its command (run, study)"},
      {{"init", ""}, "FILE: is empty"},
      {{"-version"}, "did you mean \"--version\"?"},
      {{"check", "a.toml", "--threads=2"}, "unknown option \"--threads\" of check (it belongs to run, study)"},
      {{"help", "nothing"}, "unknown command \"nothing\""},
      {{"init", "--unit", "mm", "--stll", "a.stl"}, "did you mean \"--stl\"?"},
      {{"init", "--cells", "3"}, "--cells: \"3\" is not a number of cells (allowed: an integer from 4 to 200)"},
      {{"run", "a.toml", "--thread", "2"}, "(see cgcontact run --help)"},
  };
  for (const auto& [arguments, text] : cases) {
    const Outcome outcome = parse(arguments);
    EXPECT_FALSE(outcome.line);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE(outcome.err.find(text), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }
}

TEST(Progress, log_has_a_line_per_phase_and_iteration) {
  std::ostringstream stream;
  Progress progress(Progress::Mode::log, stream);
  progress.begin_phase("cut cells");
  progress.begin_phase("solve");
  progress.outer_iteration(1, 120, 0.5);
  progress.message("warning: something");
  progress.begin_phase("cut cells");
  progress.finish();
  const std::string text = stream.str();
  EXPECT_EQ(
      text.rfind("cut cells: 0.00 s\nsolve: outer 1, active 120, residual 5.0e-01\nwarning: something\nsolve: ", 0), 0u)
      << text;
  ASSERT_EQ(progress.times_s().size(), 2u) << "the phase that came back is summed";
  EXPECT_EQ(progress.times_s()[0].first, "cut cells");
}

TEST(Progress, a_phase_that_an_error_ended_is_not_reported_as_done) {
  std::ostringstream stream;
  {
    Progress progress(Progress::Mode::log, stream);
    progress.begin_phase("cut cells");
  }
  EXPECT_EQ(stream.str(), "");
}

TEST(Progress, quick_runs_show_nothing_on_a_terminal) {
  std::ostringstream stream;
  Progress progress(Progress::Mode::terminal, stream);
  progress.begin_phase("solve");
  progress.outer_iteration(1, 120, 0.5);
  progress.finish();
  EXPECT_EQ(stream.str(), "");
}

}  // namespace
}  // namespace cgcontact::test_cli
