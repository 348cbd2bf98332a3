/// What a running program tells its user: one updating line on a terminal, plain log lines elsewhere.
#pragma once

#include <chrono>
#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

namespace cgcontact {

/// Phases are timed in any mode. On a terminal nothing appears in the first second.
class Progress {
 public:
  enum class Mode { automatic, terminal, log, silent };

  /// Writes to standard error; automatic: terminal if standard error is one, else log.
  explicit Progress(Mode mode = Mode::automatic);
  Progress(Mode mode, std::ostream& stream);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Ends the phase that was running and begins the next one.
  void begin_phase(const std::string& name);
  /// State of the outer (contact) iteration.
  void outer_iteration(int iteration, long long active_points, double residual);
  /// State of the linear solver inside; shown on a terminal only.
  void linear_iteration(int iteration, double residual);
  /// A line that stays, for example a warning.
  void message(const std::string& text);
  /// Ends the last phase and clears the updating line.
  void finish();

  /// Seconds of each phase, in order of first appearance; a phase that ran several times is summed.
  const std::vector<std::pair<std::string, double>>& times_s() const { return times_s_; }

 private:
  using Clock = std::chrono::steady_clock;

  void end_phase();
  void update_line(bool now);
  void clear_line();

  Mode mode_;
  std::ostream& stream_;
  Clock::time_point start_, phase_start_, last_update_;
  std::string phase_, outer_, linear_;
  std::size_t shown_ = 0;  ///< characters of the updating line
  std::vector<std::pair<std::string, double>> times_s_;
};

}  // namespace cgcontact
