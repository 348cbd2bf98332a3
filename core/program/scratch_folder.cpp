#include "core/program/scratch_folder.hpp"

#include <system_error>
#include <utility>

namespace cgcontact {

namespace fs = std::filesystem;

ScratchFolder::ScratchFolder(fs::path path) : path_(std::move(path)), clean_up_(std::in_place, [this] { remove(); }) {
  remove();
  fs::create_directories(path_);
}

/// A signal while files are being removed must not leave the others.
ScratchFolder::~ScratchFolder() {
  uninterrupted([&] {
    clean_up_.reset();
    remove();
  });
}

/// Renames it first: other threads may be writing to it faster than files go, and by its name they make none any more.
/// What one is just making can come between two attempts.
void ScratchFolder::remove() const {
  const fs::path removed = path_.string() + removed_mark;
  std::error_code error;
  fs::remove_all(removed, error);  // of a killed process of the same number
  fs::rename(path_, removed, error);
  if (error) return;
  for (int attempt = 0; attempt < 10 && fs::exists(removed, error); ++attempt) fs::remove_all(removed, error);
}

}  // namespace cgcontact
