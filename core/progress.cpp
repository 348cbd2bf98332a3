#include "core/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <iostream>

namespace cgcontact {

namespace {

constexpr double first_shown_s = 1.0, shown_every_s = 0.1;
constexpr std::size_t line_width = 79;

Progress::Mode resolve(Progress::Mode mode) {
  if (mode != Progress::Mode::automatic) return mode;
  return isatty(STDERR_FILENO) ? Progress::Mode::terminal : Progress::Mode::log;
}

double seconds(std::chrono::steady_clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

[[gnu::format(printf, 1, 2)]] std::string print(const char* format, ...) {
  char buffer[160];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  return buffer;
}

}  // namespace

Progress::Progress(Mode mode) : Progress(mode, std::cerr) {}

Progress::Progress(Mode mode, std::ostream& stream) : mode_(resolve(mode)), stream_(stream), start_(Clock::now()) {
  phase_start_ = last_update_ = start_;
}

Progress::~Progress() { clear_line(); }  // a phase that an error ended is not done

void Progress::begin_phase(const std::string& name) {
  end_phase();
  phase_ = name;
  phase_start_ = Clock::now();
  update_line(true);
}

void Progress::outer_iteration(int iteration, long long active_points, double residual) {
  outer_ = print("outer %d, active %lld, residual %.1e", iteration, active_points, residual);
  linear_.clear();
  if (mode_ == Mode::log) stream_ << phase_ << ": " << outer_ << std::endl;
  update_line(true);
}

void Progress::linear_iteration(int iteration, double residual) {
  linear_ = print("linear %d: %.1e", iteration, residual);
  update_line(false);
}

void Progress::message(const std::string& text) {
  if (mode_ == Mode::silent) return;
  clear_line();
  stream_ << text << std::endl;
  update_line(true);
}

void Progress::finish() {
  end_phase();
  clear_line();
}

void Progress::end_phase() {
  if (phase_.empty()) return;
  const double time = seconds(Clock::now() - phase_start_);
  const auto same = [this](const auto& entry) { return entry.first == phase_; };
  const auto found = std::find_if(times_s_.begin(), times_s_.end(), same);
  if (found == times_s_.end())
    times_s_.emplace_back(phase_, time);
  else
    found->second += time;
  if (mode_ == Mode::log) stream_ << phase_ << ": " << print("%.2f s", time) << std::endl;
  phase_.clear();
  outer_.clear();
  linear_.clear();
}

/// Rewrites the line; unless `now`, at most ten times a second.
void Progress::update_line(bool now) {
  if (mode_ != Mode::terminal) return;
  const auto time = Clock::now();
  if (seconds(time - start_) < first_shown_s) return;
  if (!now && seconds(time - last_update_) < shown_every_s) return;
  last_update_ = time;
  std::string line = print("[%.0f s] ", seconds(time - start_)) + phase_;
  if (!outer_.empty()) line += ": " + outer_;
  if (!linear_.empty()) line += (outer_.empty() ? ": " : ", ") + linear_;
  line.resize(std::min(line.size(), line_width));
  const std::size_t rest = shown_ > line.size() ? shown_ - line.size() : 0;
  stream_ << '\r' << line << std::string(rest, ' ') << std::flush;
  shown_ = line.size();
}

void Progress::clear_line() {
  if (shown_ == 0) return;
  stream_ << '\r' << std::string(shown_, ' ') << '\r' << std::flush;
  shown_ = 0;
}

}  // namespace cgcontact
