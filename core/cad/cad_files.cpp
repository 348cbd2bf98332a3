#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "core/base/numbers/types.hpp"
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

std::string cad_size_text(const CadFace& face, double mm, const std::string& unit) {
  if (face.kind == "torus")
    return fmt::format("ring radius {:.6g} {}, tube radius {:.6g} {}", face.ring_radius * mm, unit, face.radius * mm,
                       unit);
  if (face.kind == "cone") return fmt::format("half-angle {:.6g} degrees", face.half_angle / radians_per_degree);
  return face.radius > 0 ? fmt::format("radius {:.6g} {}", face.radius * mm, unit) : "";
}

CadModel::CadModel(std::shared_ptr<const Shape> shape, std::vector<CadFace> faces)
    : shape_(std::move(shape)), faces_(std::move(faces)) {}

CadModel CadModel::named(const std::vector<std::vector<std::string>>& names) const {
  CadModel result = *this;
  for (std::size_t f = 0; f < names.size(); ++f) result.faces_[f].names = names[f];
  return result;
}

}  // namespace cgcontact
