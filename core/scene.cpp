#include "core/scene.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string_view>

#include "core/scene_overrides.hpp"
#include "core/scene_reader.hpp"
#include "core/toml_cursor.hpp"

namespace cgcontact {

namespace {

constexpr double box_tolerance =
    1e-9;  // of the size of the coordinates: points on the rim of a flat box count as inside
constexpr double cone_tolerance = 1e-12;

std::string read_file(const std::string& file) {
  const SourcePlace place{file, 0, ""};
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) throw InputError(place, "", "there is no such scene file");
  if (!std::filesystem::is_regular_file(file, ignored))
    throw InputError(place, "", "is not a file but a folder or device");
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw InputError(place, "", "the scene file cannot be read");
  return text.str();
}

toml::table parse_toml(const std::string& text, const std::string& file) {
  try {
    return toml::parse(std::string_view(text), std::string_view(file));
  } catch (const toml::parse_error& error) {
    const SourcePlace place{file, static_cast<int>(error.source().begin.line), ""};
    throw InputError(place, "", "not valid TOML: " + std::string(error.description()));
  }
}

/// If [reference] depends on the contact force, it is read again when that is known; document and text stay until then.
void keep_reference(const TomlCursor& root, const std::shared_ptr<const toml::table>& document,
                    const std::shared_ptr<const SceneText>& text, Scene& scene) {
  const auto section = root.find("reference");
  if (!section || !uses_contact_force(*section)) return;
  std::vector<std::string> names;
  for (const BodySpec& body : scene.bodies) names.push_back(body.name);
  scene.late_reference = [section = *section, names, document, text](double contact_force) {
    return read_reference(section, names, contact_force);
  };
}

}  // namespace

bool FaceSpec::selects(const std::vector<std::string>& names) const {
  const auto is_listed = [this](const std::string& listed) {
    return std::find(surfaces.begin(), surfaces.end(), listed) != surfaces.end();
  };
  return surfaces.empty() || std::any_of(names.begin(), names.end(), is_listed);
}

bool FaceSpec::contains(const Vec3& x, const Vec3& n) const {
  if (box) {
    const double slack =
        box_tolerance * std::max(box->first.lpNorm<Eigen::Infinity>(), box->second.lpNorm<Eigen::Infinity>());
    if ((x.array() < box->first.array() - slack).any() || (x.array() > box->second.array() + slack).any()) return false;
  }
  return !normal_cone || n.dot(normal_cone->first) >= normal_cone->second - cone_tolerance;
}

ReferenceSpec Scene::reference_at(double contact_force) const {
  return late_reference && contact_force > 0 ? late_reference(contact_force) : reference;
}

Scene read_scene(const std::string& file, const std::vector<std::string>& overrides) {
  const auto document = std::make_shared<toml::table>(parse_toml(read_file(file), file));
  apply_overrides(*document, overrides);
  const auto text = std::make_shared<SceneText>(SceneText{file, {}});
  const TomlCursor root(*document, "", *text);
  if (const auto parameters = root.find("parameters")) text->parameters = read_parameters(*parameters);
  Scene scene = SceneReader().read(root);
  keep_reference(root, document, text, scene);
  const std::string stem = std::filesystem::path(file).stem().string();
  if (scene.title.empty()) scene.title = stem;
  if (scene.output.directory.empty()) scene.output.directory = (std::filesystem::path("out") / stem).string();
  return scene;
}

}  // namespace cgcontact
