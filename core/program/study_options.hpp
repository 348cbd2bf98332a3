/// Options of `cgcontact study`: lists of sizes and of variants, read from the command line.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace cgcontact {

struct StudyOptions {
  struct Backend {
    std::string name, program;
  };
  std::string key;                             ///< of the scene, given the values `sizes`; empty: ...
  std::vector<std::string> sizes{"0.5", "1"};  ///< ... all cell sizes are divided by these factors
  std::vector<std::string> preconditioners;    ///< empty: the scene's
  std::vector<int> threads;                    ///< empty: as the environment says
  std::vector<Backend> backends;               ///< empty: this program
  int repeat = 1;                              ///< number of runs, of which the fastest counts
  bool keep = false;                           ///< the results of the runs
  bool resume = false;                         ///< take over finished runs of an earlier study
};

constexpr int max_threads = 4096, max_repeats = 1000;

/// Splits and trims "a,b,c". Throws InputError if the list or an entry is empty or an entry is given twice. All
/// functions below throw InputError with the value and what is allowed.
std::vector<std::string> parse_list(const std::string& text, const std::string& allowed);

/// Splits "KEY=1,2,3": the key and the numbers as they were written.
std::pair<std::string, std::vector<std::string>> parse_vary(const std::string& text);

/// Parses numbers > 0.
std::vector<std::string> parse_factors(const std::string& text);

/// Parse one number of threads, and a list of them.
int parse_threads(const std::string& text);
std::vector<int> parse_thread_list(const std::string& text);

/// Parses "NAME=PROGRAM,NAME=PROGRAM"; the programs must be executable files.
std::vector<StudyOptions::Backend> parse_backends(const std::string& text);

int parse_repeat(const std::string& text);

}  // namespace cgcontact
