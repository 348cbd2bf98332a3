/// Writes the results of a run into a directory that is either the old one or the new one, never half of it.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "core/output/report/output_report.hpp"
#include "core/results/results.hpp"
#include "core/scene/scene.hpp"

namespace cgcontact {

struct PageContents;

/// Writes report.json and what the scene asks for (result.vtkhdf, contact.vtkhdf, contact.csv, pictures) to a temporary
/// directory beside `directory` and exchanges the two. Files of the old directory that are not this program's are kept.
/// Throws InputError if `directory` cannot be written or holds something that is not a result; it is then as before.
/// Returns warnings (e.g. no gnuplot, no pictures), which report.json holds too.
std::vector<std::string> write_results(Results& results, const Scene& scene, const std::string& directory);

/// Writer of a run in steps: all fields too, in steps.vtkhdf and pictures. Collective.
class ResultWriter {
 public:
  /// Takes the scene as it was read; the grids of the solved one may be others.
  ResultWriter(const Scene& scene, const std::string& directory);
  ~ResultWriter();
  ResultWriter(const ResultWriter&) = delete;

  /// Adds a step but the last, from number 0, with fields, contact rows and pairs. Number 0 forgets all before.
  void add_step(std::size_t number, const Results& step);
  /// Adds the last step and writes as write_results.
  std::vector<std::string> write(Results& results, const Scene& scene);

 private:
  bool forget_other_steps(const Results& results);
  void finish(Results& results, const Scene& scene, const std::vector<std::string>& old, PageContents& contents,
              std::chrono::steady_clock::time_point start);

  struct State;
  std::unique_ptr<State> state_;
};

/// Throws the InputError that write_results would throw for a directory that it may not replace or create; for use
/// before a long run.
void check_output_directory(const std::string& directory);

}  // namespace cgcontact
