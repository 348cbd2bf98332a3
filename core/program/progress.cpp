#include "core/program/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <iostream>

namespace cgcontact {

namespace {

constexpr double first_shown_s = 1.0, updated_every_s = 0.2;
constexpr std::size_t line_width = 79;

Progress::Mode resolve(Progress::Mode mode) {
  using Mode = Progress::Mode;
  if (mode != Mode::automatic && mode != Mode::terminal_only) return mode;
  if (isatty(STDERR_FILENO)) return Mode::terminal;
  return mode == Mode::automatic ? Mode::log : Mode::silent;
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
  phase_start_ = start_;
  if (mode_ == Mode::terminal) updates_ = std::thread([this] { keep_updating(); });
}

/// A phase that is still running was ended by an error: it is not reported as done.
Progress::~Progress() {
  stop_updating();
  const std::lock_guard lock(mutex_);
  clear_line();
}

void Progress::begin_phase(const std::string& name) {
  const std::lock_guard lock(mutex_);
  end_phase();
  phase_ = name;
  phase_start_ = Clock::now();
  update_line();
}

void Progress::outer_iteration(int iteration, long long active_points, double residual) {
  const std::lock_guard lock(mutex_);
  outer_ = print("outer %d, active %lld, residual %.1e", iteration, active_points, residual);
  if (mode_ == Mode::log) stream_ << phase_ << ": " << outer_ << std::endl;
  update_line();
}

void Progress::message(const std::string& text) {
  const std::lock_guard lock(mutex_);
  if (mode_ != Mode::warnings) show(text);
}

void Progress::warning(const std::string& text) {
  const std::lock_guard lock(mutex_);
  show("warning: " + text);
}

void Progress::show(const std::string& text) {
  if (mode_ == Mode::silent) return;
  clear_line();
  stream_ << text << std::endl;
  update_line();
}

void Progress::finish() {
  stop_updating();
  const std::lock_guard lock(mutex_);
  end_phase();
  clear_line();
}

void Progress::abandon() {
  const std::lock_guard lock(mutex_);
  clear_line();
  mode_ = Mode::silent;
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
}

void Progress::keep_updating() {
  std::unique_lock lock(mutex_);
  while (!stop_.wait_for(lock, std::chrono::duration<double>(updated_every_s), [this] { return stopped_; }))
    update_line();
}

void Progress::stop_updating() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  stop_.notify_all();
  if (updates_.joinable()) updates_.join();
}

void Progress::update_line() {
  if (mode_ != Mode::terminal || phase_.empty()) return;
  const double time = seconds(Clock::now() - start_);
  if (time < first_shown_s) return;
  std::string line = print("[%.0f s] ", time) + phase_;
  if (!outer_.empty()) line += ": " + outer_;
  line.resize(std::min(line.size(), line_width));
  if (line == line_) return;
  const std::size_t rest = line_.size() > line.size() ? line_.size() - line.size() : 0;
  stream_ << '\r' << line << std::string(rest, ' ') << std::flush;
  line_ = line;
}

void Progress::clear_line() {
  if (line_.empty()) return;
  stream_ << '\r' << std::string(line_.size(), ' ') << '\r' << std::flush;
  line_.clear();
}

}  // namespace cgcontact
