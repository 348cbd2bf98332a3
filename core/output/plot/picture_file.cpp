#include "core/output/plot/picture_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include "core/base/errors/errors.hpp"
#include "core/base/files/text.hpp"
#include "core/program/scratch_folder.hpp"

namespace cgcontact {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_picture(const std::string& file, const std::string& problem, const std::string& allowed) {
  throw InputError(fmt::format("--out {}: {} (allowed: {})", file, problem, allowed));
}

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

bool is_png(const fs::path& file) {
  constexpr char signature[] = "\x89PNG\r\n\x1a\n";
  char head[8] = "";
  std::ifstream(file, std::ios::binary).read(head, sizeof head);
  return std::memcmp(head, signature, sizeof head) == 0;
}

/// Returns whether a folder is another one or lies in it.
bool lies_in(const fs::path& folder, const fs::path& other) {
  std::error_code error;
  for (fs::path path = fs::weakly_canonical(folder, error); !path.empty(); path = path.parent_path()) {
    if (fs::equivalent(path, other, error)) return true;
    if (path == path.parent_path()) return false;
  }
  return false;
}

/// Returns what gnuplot has said of a script; nothing in the folder will be there to look at.
std::string messages_of_gnuplot(const fs::path& folder, const std::string& name) {
  std::error_code error;
  const fs::path log = folder / "plots" / (name + ".log");
  return fs::is_regular_file(log, error) ? trimmed(read_text(log.string())) : "";
}

}  // namespace

PictureFile::PictureFile(const std::string& file, const std::string& result) : file_(file) {
  const fs::path path(file);
  std::error_code error;
  if (path.extension() != ".png") refuse_picture(file, "is no PNG", "a name in .png");
  if (!fs::is_directory(folder_of(path), error))
    refuse_picture(file, "its folder does not exist", "a file in a folder");
  if (lies_in(folder_of(path), result))
    refuse_picture(file, "lies in the result, which stays as it is", "--out FILE.png in another folder");
  if (!fs::exists(fs::symlink_status(path, error))) return;
  if (!fs::is_regular_file(path, error) || !is_png(path))
    refuse_picture(file, "is there and is no PNG", "a new file, or a PNG to replace");
}

void PictureFile::draw(const std::function<void(GnuplotRuns& runs, const std::string& name)>& use) const try {
  const std::string name = "plot";
  const fs::path path(file_);
  const ScratchFolder folder(folder_of(path) / fmt::format(".{}.tmp-{}", path.filename().string(), getpid()));
  fs::create_directory(folder.path() / "plots");
  GnuplotRuns runs(folder.path().string());
  use(runs, name);
  const std::vector<std::string> warnings = runs.finish();
  const fs::path picture = folder.path() / (name + ".png");
  if (!warnings.empty() || !fs::is_regular_file(picture)) {
    const std::string warning = warnings.empty() ? "nothing was drawn" : warnings.front();
    const std::string said = messages_of_gnuplot(folder.path(), name);
    throw InputError(fmt::format("--out {}: {}{}{}", file_, warning.substr(0, warning.find_first_of(";,")),
                                 said.empty() ? "" : ": ", said));
  }
  uninterrupted([&] { fs::rename(picture, file_); });
} catch (const fs::filesystem_error& error) {
  throw InputError(fmt::format("--out {}: cannot be written: {}", file_, error.code().message()));
}

}  // namespace cgcontact
