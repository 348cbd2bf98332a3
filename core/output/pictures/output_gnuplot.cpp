#include "core/output/pictures/output_gnuplot.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <utility>

#include "core/base/errors/errors.hpp"
#include "core/base/files/text.hpp"
#include "core/base/process/parallel.hpp"
#include "core/base/process/resources.hpp"

extern char** environ;

namespace cgcontact {

namespace {

namespace fs = std::filesystem;

constexpr std::array<std::array<double, 3>, 7> palette_colours{{{0.15, 0.18, 0.50},
                                                                {0.13, 0.43, 0.71},
                                                                {0.30, 0.69, 0.76},
                                                                {0.72, 0.87, 0.70},
                                                                {0.97, 0.86, 0.45},
                                                                {0.93, 0.50, 0.20},
                                                                {0.68, 0.11, 0.13}}};

/// Letters of DejaVu Sans, the font of gnuplot on Debian: those of Europe, mathematics, symbols. A letter that no font
/// has covers a whole PNG in black (gnuplot 5.4 with Pango 1.50).
constexpr char32_t drawable[][2] = {{0x20, 0x7e},     {0xa0, 0x2e9},    {0x300, 0x34f},   {0x38e, 0x3a1},
                                    {0x3a3, 0x525},   {0x1e00, 0x1efb}, {0x2010, 0x2027}, {0x2030, 0x205e},
                                    {0x2074, 0x208e}, {0x20a0, 0x20b5}, {0x2100, 0x2109}, {0x2150, 0x2185},
                                    {0x2190, 0x2311}, {0x2500, 0x269c}};
constexpr std::size_t max_at_once = 32;         // runs of gnuplot
constexpr char32_t instead_of_others = 0x25a1;  // a square

bool is_drawable(char32_t letter) {
  return std::any_of(std::begin(drawable), std::end(drawable),
                     [&](const auto& range) { return letter >= range[0] && letter <= range[1]; });
}

/// Letters of a text; control characters are spaces, and what is no UTF-8 are question marks.
std::u32string letters_of(const std::string& text) {
  std::u32string letters;
  for (const char c : printable(text, text.size())) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xc0) == 0x80)
      letters.back() = letters.back() << 6 | (byte & 0x3f);
    else
      letters += byte < 0x80 ? byte : byte < 0xe0 ? byte & 0x1f : byte < 0xf0 ? byte & 0x0f : byte & 0x07;
  }
  return letters;
}

std::string utf8(char32_t letter) {
  if (letter < 0x80) return {static_cast<char>(letter)};
  if (letter < 0x800) return {static_cast<char>(0xc0 | letter >> 6), static_cast<char>(0x80 | (letter & 0x3f))};
  return {static_cast<char>(0xe0 | letter >> 12), static_cast<char>(0x80 | (letter >> 6 & 0x3f)),
          static_cast<char>(0x80 | (letter & 0x3f))};
}

/// Width of a letter over the size of the font, about.
double width_of(char32_t letter) {
  static const std::u32string narrow = U" ilj.,:;'|!()[]ftrI-/", wide = U"mwMW@%";
  if (narrow.find(letter) != std::u32string::npos) return 0.4;
  return wide.find(letter) != std::u32string::npos || letter >= 0x2000 ? 1.0
         : letter < 'a' && letter >= 'A'                               ? 0.72
                                                                       : 0.63;
}

/// Starts gnuplot in a folder; 0, or an error number when it could not be started.
int spawn_gnuplot(const std::string& folder, const std::string& script, const std::string& log, pid_t& child) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&actions, 1, 2);
  std::string program = "gnuplot", option = "-d", file = script;
  char* const arguments[] = {program.data(), option.data(), file.data(), nullptr};
  const UnboundThread unbound;  // gnuplot shares no CPU with this thread
  const int error = posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

/// gnuplot's SVG is no XML where a text has "]]>" or one of the two letters that XML does not allow.
void make_well_formed(const std::string& file) {
  const std::string text = read_text(file);
  std::string good;
  std::size_t from = 0;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const bool end_of_data = text.compare(k, 3, "]]>") == 0;
    const bool forbidden = text.compare(k, 3, "\xef\xbf\xbe") == 0 || text.compare(k, 3, "\xef\xbf\xbf") == 0;
    if (!end_of_data && !forbidden) continue;
    good += text.substr(from, k - from) + (end_of_data ? "]]&gt;" : utf8(instead_of_others));
    from = k + 3;
    k += 2;
  }
  if (from > 0) write_text(file, good + text.substr(from));
}

/// Did the child end well? It becomes 0 at the moment from which its number may be another process'.
bool wait_for(pid_t& child) {
  siginfo_t info{};
  while (waitid(P_PID, child, &info, WEXITED | WNOWAIT) < 0 && errno == EINTR) {
  }
  int status = 0;
  bool ended = false;
  uninterrupted([&] { ended = waitpid(std::exchange(child, 0), &status, 0) > 0; });
  return ended && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

GnuplotRuns::GnuplotRuns(const std::string& directory) : directory_(directory), clean_up_([this] { kill_all(); }) {}

/// Waits for the runs, without a word of what fails: nobody asks for the pictures of a run that an exception ends.
GnuplotRuns::~GnuplotRuns() {
  try {
    finish();
  } catch (const InputError&) {
  }
}

void GnuplotRuns::kill_all() {
  for (const Run& run : runs_)
    if (run.child > 0) kill(run.child, SIGKILL);
  for (const Run& run : runs_)
    if (run.child > 0) waitpid(run.child, nullptr, 0);
}

void GnuplotRuns::warn(const std::string& warning) {
  const std::lock_guard lock(mutex_);
  if (std::find(warnings_.begin(), warnings_.end(), warning) == warnings_.end()) warnings_.push_back(warning);
}

void GnuplotRuns::start(const std::string& name, const std::string& script, const std::vector<std::string>& pictures) {
  std::vector<LayeredPicture> without_layers;
  for (const std::string& picture : pictures) without_layers.push_back({picture, {}});
  start_layered(name, script, std::move(without_layers));
}

void GnuplotRuns::start_layered(const std::string& name, const std::string& script,
                                std::vector<LayeredPicture> pictures) {
  const fs::path folder = fs::path(directory_) / "plots";
  write_text((folder / (name + ".gp")).string(), script);
  std::unique_lock lock(mutex_);
  if (runs_.size() >= max_at_once)
    if (Run& earlier = runs_[runs_.size() - max_at_once]; earlier.child > 0)
      earlier.ended_well = wait_for(earlier.child);
  int error = 0;
  uninterrupted([&] {
    pid_t child = 0;
    error = spawn_gnuplot(folder.string(), name + ".gp", name + ".log", child);
    if (error == 0) runs_.push_back({name, std::move(pictures), child});
  });
  lock.unlock();
  if (error == 0) return;
  if (error == ENOENT)
    warn(
        "no pictures: the program gnuplot was not found (Debian package gnuplot-nox); its scripts and data are in "
        "the folder plots of the result");
  else
    warn(fmt::format("no pictures: gnuplot could not be started ({})", std::strerror(error)));
}

void GnuplotRuns::complete(const Run& run) {
  for (const LayeredPicture& picture : run.pictures) {
    const fs::path file = fs::path(directory_) / picture.name;
    std::error_code error;
    const bool drawn = fs::exists(file, error) && fs::file_size(file, error) > 0;
    if (run.ended_well && drawn) {
      if (file.extension() == ".svg") make_well_formed(file.string());
      if (picture.layers.empty()) continue;
      try {
        lay_below(file.string(), picture.layers);
        continue;
      } catch (const InputError& wrong) {
        warn(fmt::format("no {}: {}", picture.name, wrong.what()));
      }
    } else {
      warn(fmt::format("no {0}: gnuplot failed on plots/{1}.gp, its messages are in plots/{1}.log", picture.name,
                       run.name));
    }
    fs::remove(file, error);
  }
}

const std::vector<std::string>& GnuplotRuns::finish() {
  uninterrupted([&] {  // the threads have started them in any order
    std::sort(runs_.begin(), runs_.end(), [](const Run& a, const Run& b) { return a.name < b.name; });
  });
  for (Run& run : runs_)
    if (run.child > 0) run.ended_well = wait_for(run.child);
  dispatch_chunks("cgcontact::output_gnuplot::complete", runs_.size(), [&](std::size_t k) { complete(runs_[k]); });
  uninterrupted([&] { runs_.clear(); });
  return warnings_;
}

std::array<double, 3> palette_colour(double value) {
  const double position = std::clamp(value, 0.0, 1.0) * (palette_colours.size() - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(position), palette_colours.size() - 2);
  std::array<double, 3> colour;
  for (int c = 0; c < 3; ++c)
    colour[c] = palette_colours[k][c] +
                (position - static_cast<double>(k)) * (palette_colours[k + 1][c] - palette_colours[k][c]);
  return colour;
}

std::string gnuplot_palette() {
  std::string text = "set palette defined (";
  for (std::size_t k = 0; k < palette_colours.size(); ++k)
    text += fmt::format("{}{} {} {} {}", k ? ", " : "", k, palette_colours[k][0], palette_colours[k][1],
                        palette_colours[k][2]);
  return text + ")\n";
}

std::string gnuplot_text(const std::string& text) {
  std::string quoted = "'";
  for (const char c : printable(text, text.size())) quoted += c == '\'' ? "''" : std::string(1, c);
  return quoted + "'";
}

std::string drawable_text(const std::string& text) {
  std::string drawn;
  for (const char32_t letter : letters_of(text)) drawn += utf8(is_drawable(letter) ? letter : instead_of_others);
  return drawn;
}

double gnuplot_width(const std::string& text, double pixels) {
  double width = 0;
  for (const char32_t letter : letters_of(text)) width += width_of(letter) * pixels;
  return width;
}

GnuplotTitle gnuplot_title(const std::string& text, int width, double pixels) {
  constexpr std::size_t max_lines = 4;
  const double letter = gnuplot_width(text, pixels) / std::max(1, columns_of(text));
  const int columns = std::max(10, static_cast<int>(width / std::max(letter, 0.1 * pixels)));
  std::vector<std::string> lines;
  for (std::string line : wrapped(text, "", columns)) {
    while (columns_of(line) > columns) {  // a word longer than a line is divided
      std::size_t end = 0, next = 0;
      while (next < line.size()) {
        do ++next;
        while (next < line.size() && (static_cast<unsigned char>(line[next]) & 0xc0) == 0x80);
        if (columns_of(line.substr(0, next)) > columns) break;
        end = next;
      }
      lines.push_back(line.substr(0, end));
      line.erase(0, end);
    }
    lines.push_back(line);
  }
  if (lines.size() > max_lines) {
    lines.resize(max_lines);
    lines.back() += " ...";
  }
  GnuplotTitle title{"", static_cast<int>(lines.size())};
  for (std::size_t k = 0; k < lines.size(); ++k)
    title.text += (k ? ".\"\\n\"." : "") + gnuplot_text(lines[k]);  // in double quotes gnuplot would run backquotes
  return title;
}

}  // namespace cgcontact
