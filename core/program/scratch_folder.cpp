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

/// Removes it in several attempts: other threads may be writing to it.
void ScratchFolder::remove() const {
  std::error_code error;
  for (int attempt = 0; attempt < 10 && fs::exists(path_, error); ++attempt) fs::remove_all(path_, error);
}

}  // namespace cgcontact
