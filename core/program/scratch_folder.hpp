/// A folder for files that are moved once all are written: a run that is stopped leaves nothing behind.
#pragma once

#include <filesystem>
#include <optional>

#include "core/program/interruption.hpp"

namespace cgcontact {

/// Goes with all that is in it when this object does, or when the user stops the program.
class ScratchFolder {
 public:
  /// Makes it empty, with the folders above it. Throws std::filesystem::filesystem_error.
  explicit ScratchFolder(std::filesystem::path path);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// Ends the name of a folder while it is being removed.
  static constexpr const char* removed_mark = ".gone";

 private:
  void remove() const;

  const std::filesystem::path path_;
  std::optional<CleanUp> clean_up_;
};

}  // namespace cgcontact
