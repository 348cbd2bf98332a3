#include <algorithm>
#include <cctype>
#include <filesystem>

#include "core/cad/cad_model.hpp"

namespace cgcontact {

CadFormat cad_format(const std::string& file) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending == ".step" || ending == ".stp") return CadFormat::step;
  if (ending == ".iges" || ending == ".igs") return CadFormat::iges;
  if (ending == ".brep" || ending == ".brp") return CadFormat::brep;
  return CadFormat::unknown;
}

const std::vector<std::string>& cad_kinds() {
  static const std::vector<std::string> kinds{"plane", "cylinder", "cone", "sphere", "torus", "other"};
  return kinds;
}

CadModel::CadModel(std::shared_ptr<const Shape> shape, std::vector<CadFace> faces)
    : shape_(std::move(shape)), faces_(std::move(faces)) {}

CadModel CadModel::named(const std::vector<std::vector<std::string>>& names) const {
  CadModel result = *this;
  for (std::size_t f = 0; f < names.size(); ++f) result.faces_[f].names = names[f];
  return result;
}

}  // namespace cgcontact
