#include <gtest/gtest.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <functional>

#include "core/base/errors/errors.hpp"
#include "core/base/files/text.hpp"
#include "core/output/study/output_study.hpp"
#include "core/program/child_process.hpp"
#include "core/program/study_options.hpp"

namespace cgcontact::test_study {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

TEST(StudyOptions, lists_are_split_and_trimmed) {
  EXPECT_EQ(parse_list("a", "x"), Words{"a"});
  EXPECT_EQ(parse_list(" a, b ,c", "x"), (Words{"a", "b", "c"}));
  EXPECT_EQ(parse_factors("0.5,1,2e0"), (Words{"0.5", "1", "2e0"}));
  EXPECT_EQ(parse_thread_list("1,4"), (std::vector<int>{1, 4}));
  EXPECT_EQ(parse_repeat("3"), 3);
  const auto [key, numbers] = parse_vary(" body.lower.cell_size = 1e-3, -2");
  EXPECT_EQ(key, "body.lower.cell_size");
  EXPECT_EQ(numbers, (Words{"1e-3", "-2"}));
  const auto backends = parse_backends("one=/bin/sh, two=/bin/sh");
  ASSERT_EQ(backends.size(), 2u);
  EXPECT_EQ(backends[1].name, "two");
  EXPECT_EQ(backends[1].program, "/bin/sh");
}

TEST(StudyOptions, mistakes_name_the_value_and_what_is_allowed) {
  const std::vector<std::pair<std::function<void()>, std::string>> cases = {
      {[] { parse_list("", "names"); }, "\"\" is an empty list (allowed: names)"},
      {[] { parse_list(" ", "names"); }, "is an empty list"},
      {[] { parse_list("a,", "names"); }, "has an empty entry"},
      {[] { parse_list("a,a", "names"); }, "\"a\" is there twice"},
      {[] { parse_vary("n"); }, "\"n\" has no key or no values"},
      {[] { parse_vary("=3"); }, "has no key"},
      {[] { parse_vary("n=8,x"); }, "\"x\" is not a number"},
      {[] { parse_vary("n=8,nan"); }, "\"nan\" is not a number"},
      {[] { parse_vary("n=0x8"); }, "\"0x8\" is not a number"},
      {[] { parse_vary("n=1e999"); }, "\"1e999\" is not a number"},
      {[] { parse_vary("n=8,8.0"); }, "\"8.0\" is there twice"},
      {[] { parse_factors("1,0"); }, "\"0\" is out of range (allowed: numbers > 0"},
      {[] { parse_factors("-1"); }, "\"-1\" is out of range"},
      {[] { parse_thread_list("1,0"); }, "\"0\" is not a number of threads (allowed: an integer from 1 to 4096)"},
      {[] { parse_thread_list("1,01"); }, "\"01\" is there twice"},
      {[] { parse_repeat("-1"); }, "\"-1\" is not a number of repetitions (allowed: an integer from 1 to 1000)"},
      {[] { parse_repeat("1.5"); }, "\"1.5\" is not a number of repetitions"},
      {[] { parse_backends("/bin/sh"); }, "has no \"=\""},
      {[] { parse_backends("a b=/bin/sh"); }, "has no good name"},
      {[] { parse_backends("a=/bin/sh,a=/bin/ls"); }, "\"a\" is there twice"},
      {[] { parse_backends("a=/etc/passwd"); }, "\"/etc/passwd\" is not a program that can be run"},
      {[] { parse_backends("a=/nowhere"); }, "\"/nowhere\" is not a program that can be run"},
  };
  for (const auto& [parse, text] : cases) try {
      parse();
      ADD_FAILURE() << "accepted: " << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
}

/// Errors that fall with orders 1, 1.5 and 2; the sizes are not in order and one run has failed.
Study make_study() {
  Study study;
  study.scene_file = "scene.toml";
  study.title = "Two, \"quoted\"";
  study.key = "n";
  study.variants = {"first", "second"};
  for (const std::string& variant : study.variants)
    for (const int n : {32, 8, 16}) {
      StudyRow row;
      row.variant = variant;
      row.size = std::to_string(n);
      row.cell_size = 1.0 / n;
      row.fingerprint = variant + row.size;
      if (variant == "second" && n == 16) {
        row.status = StudyRow::Status::failed;
        row.message = "out of memory, \"really\"";
      } else {
        row.status = StudyRow::Status::solved;
        row.errors = {{"whole", 1.0 / n, 4 * std::pow(n, -1.5), 2.0 / (n * n)}, {"outside", 0.1, 0.1, 1e-17}};
        row.report = "{}";
        row.figures.unknowns = n * n;
        row.figures.times_s = {{"solve", 0.1 * n}, {"error estimate", 0.5}};
        row.figures.force = 99;
        row.force_reference = -100;
      }
      study.rows.push_back(row);
    }
  return study;
}

TEST(StudyTable, rates_are_between_neighbouring_solved_sizes) {
  const Study study = make_study();
  const auto rate = [&](int row, int kind, const char* zone = "whole") {
    return observed_rate(study, study.rows[row], zone, pressure_kinds()[kind]);
  };
  EXPECT_FALSE(rate(1, 0)) << "nothing is coarser";
  for (const int row : {0, 2, 3}) {  // the last one goes past the run that failed
    ASSERT_TRUE(rate(row, 0));
    EXPECT_NEAR(*rate(row, 0), 1, 1e-12);
    EXPECT_NEAR(*rate(row, 1), 1.5, 1e-12);
    EXPECT_NEAR(*rate(row, 2), 2, 1e-12);
  }
  EXPECT_FALSE(rate(5, 0)) << "failed";
  EXPECT_FALSE(rate(0, 2, "outside")) << "rounding has no rate";
  EXPECT_FALSE(rate(0, 0, "nowhere"));
}

TEST(StudyTable, ratios_and_forces) {
  const Study study = make_study();
  EXPECT_NEAR(*error_ratio(study.rows[2], "whole"), 8, 1e-12);
  EXPECT_FALSE(error_ratio(study.rows[2], "outside"));
  EXPECT_NEAR(*force_error(study.rows[0]), 0.01, 1e-12);
  EXPECT_FALSE(force_error(study.rows[5]));
  EXPECT_EQ(zone_names(study), (Words{"whole", "outside"}));
  EXPECT_EQ(phase_names(study), (Words{"solve", "error estimate"}));
}

class StudyFiles : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = fs::temp_directory_path() / ("cgcontact_study_" + std::to_string(getpid()));
    fs::create_directory(directory_);
  }
  void TearDown() override { fs::remove_all(directory_); }
  std::string file(const std::string& name) const { return (directory_ / name).string(); }

  fs::path directory_;
};

TEST_F(StudyFiles, the_table_holds_every_run_that_has_ended) {
  Study study = make_study();
  study.rows[0].status = StudyRow::Status::not_run;
  write_study(study, directory_.string());
  const std::string csv = read_text(file("study.csv"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 6) << "names, five of six runs";
  EXPECT_EQ(csv.rfind("variant,key,size,cell_size_m,status,", 0), 0u);
  EXPECT_NE(csv.find(",time_solve_s,time_error_estimate_s,"), std::string::npos);
  EXPECT_NE(csv.find("\nfirst,n,8.0,0.125,solved,"), std::string::npos) << csv;
  EXPECT_NE(csv.find("\"out of memory, \"\"really\"\"\"\n"), std::string::npos) << csv;
  EXPECT_NE(read_text(file("study.json")).find("\"complete\": false"), std::string::npos);
  for (const fs::directory_entry& entry : fs::directory_iterator(directory_))
    EXPECT_NE(entry.path().filename().string()[0], '.') << "nothing temporary stays";
}

TEST_F(StudyFiles, a_write_that_fails_says_so_and_leaves_nothing) {
  fs::create_directories(directory_ / "study.csv" / "something");
  EXPECT_THROW(write_study(make_study(), directory_.string()), InputError);
  EXPECT_EQ(std::distance(fs::directory_iterator(directory_), fs::directory_iterator()), 1);
}

TEST_F(StudyFiles, only_the_directory_of_a_study_is_taken) {
  EXPECT_NO_THROW(check_study_directory(directory_.string()));
  EXPECT_NO_THROW(check_study_directory(file("missing")));
  write_text(file("mine.txt"), "mine");
  EXPECT_THROW(check_study_directory(directory_.string()), InputError);
  EXPECT_THROW(check_study_directory(file("mine.txt")), InputError);
  write_text(file("study.json"), "{\"program\": \"other\"}");
  EXPECT_THROW(check_study_directory(directory_.string()), InputError);
  write_study(make_study(), directory_.string());
  EXPECT_NO_THROW(check_study_directory(directory_.string()));
}

TEST_F(StudyFiles, the_summary_names_failures) {
  const std::string text = study_summary(make_study(), directory_.string());
  EXPECT_NE(text.find("5 of 6 runs solved, 1 failed"), std::string::npos) << text;
  EXPECT_NE(text.find("second, n = 16: out of memory"), std::string::npos) << text;
}

TEST_F(StudyFiles, child_processes_end_in_their_own_way) {
  ChildRunner children;
  const ChildOutcome words = children.run("/bin/sh", {"-c", "echo out; echo err >&2; exit 3"}, file("log"));
  EXPECT_EQ(words.exit_code, 3);
  EXPECT_EQ(words.signal, 0);
  EXPECT_EQ(read_text(file("log")), "out\nerr\n");
  EXPECT_EQ(children.run("/bin/sh", {"-c", "kill -SEGV $$"}, file("log")).signal, SIGSEGV);
  EXPECT_EQ(children.run(file("none"), {}, file("log")).error, ENOENT);
  EXPECT_EQ(children.run("/bin/sh", {"-c", "true"}, file("no/log")).error, ENOENT);
  EXPECT_EQ(children.stop_signal(), 0);
}

/// A signal to a process goes to any of its threads, and ChildRunner blocks it in its own only: as in the program it
/// has to be made before any thread, and this process may have those of Kokkos. What was forked has none but its own.
TEST_F(StudyFiles, a_signal_stops_the_child_and_is_remembered) {
  const auto whole_test = [&] {
    std::signal(SIGTERM, SIG_DFL);
    ChildRunner children;
    const ChildOutcome stopped =
        children.run("/bin/sh", {"-c", "kill -TERM " + std::to_string(getpid()) + "; exec sleep 60"}, file("log"));
    EXPECT_EQ(stopped.signal, SIGTERM);
    EXPECT_LT(stopped.wall_s, 30);
    EXPECT_EQ(children.stop_signal(), SIGTERM);
    _exit(HasFailure() ? 1 : 0);
  };
  GTEST_FLAG_SET(death_test_style, "fast");  // forks; the other style starts the program anew, with Kokkos
  EXPECT_EXIT(whole_test(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace cgcontact::test_study
