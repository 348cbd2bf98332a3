#include "core/output/report/read_report.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "core/base/errors/errors.hpp"
#include "core/base/files/text.hpp"

namespace cgcontact {

Json read_report(const std::string& directory) {
  const std::filesystem::path report = std::filesystem::path(directory) / "report.json";
  std::error_code error;
  if (!std::filesystem::is_directory(directory, error))
    throw InputError(fmt::format("{}: there is no such directory", directory));
  if (!std::filesystem::is_regular_file(report, error))
    throw InputError(fmt::format(
        "{}: holds no result: there is no report.json (allowed: the output directory of a run)", directory));
  Json json = Json::parse(read_text(report.string()), nullptr, false);
  if (!json.is_object() || json.value("program", Json()) != "cgcontact" || !json.value("contact", Json()).is_array() ||
      !json.value("bodies", Json()).is_array())
    throw InputError(fmt::format("{}: report.json is not one of a run of cgcontact", directory));
  return json;
}

}  // namespace cgcontact
