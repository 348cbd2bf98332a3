#include "core/scene_file/read_scene.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string_view>

#include "core/base/files/text.hpp"
#include "core/cad/cad_model.hpp"
#include "core/expressions/unit_hints.hpp"
#include "core/scene_file/scene_copies.hpp"
#include "core/scene_file/scene_overrides.hpp"
#include "core/scene_file/sections/scene_reader.hpp"
#include "core/scene_file/sections/toml_cursor.hpp"
#include "core/scene_file/templates/scene_template.hpp"
#include "core/triangles/triangle_reader.hpp"

namespace cgcontact {

namespace {

/// A scene is text that somebody writes; toml++ calls itself for every name in a key and every level of a value.
constexpr std::uintmax_t max_scene_bytes = 16 << 20;
constexpr int max_key_depth = 20;

/// Throws for a geometry file that a scene can name, with what makes a scene of it.
void expect_no_part(const std::string& file) {
  const CadFormat format = cad_format(file);
  const bool is_cad = format != CadFormat::unknown;
  if (!is_cad && !is_triangle_file(file) && !is_deck(file)) return;
  throw InputError(SourceLocation{file, 0, ""}, "", "is a part and not a scene",
                   "cgcontact init " + shell_word(file) + (is_cad && format != CadFormat::brep ? "" : " --unit mm") +
                       " makes a scene of it");
}

std::string read_file(const std::string& file) {
  expect_no_part(file);
  const SourceLocation location{file, 0, ""};
  std::error_code error;
  if (file.find('\0') != std::string::npos)
    throw InputError(printable(file) + ": there is no such scene file: no file has a name with a zero byte");
  if (!std::filesystem::exists(file, error))
    throw InputError(location, "",
                     error ? "the scene file cannot be read: " + error.message() : "there is no such scene file");
  if (!std::filesystem::is_regular_file(file, error))
    throw InputError(location, "", "is not a file but a folder or device");
  if (std::filesystem::file_size(file, error) > max_scene_bytes)
    throw InputError(location, "", "is too large for a scene", "16 MB");
  std::ifstream stream(file, std::ios::binary);
  std::string text(max_scene_bytes + 1, '\0');
  if (stream) stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream.is_open() || stream.bad())
    throw InputError(location, "", std::string("the scene file cannot be read: ") + std::strerror(errno));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

/// Returns the end of a comment or string that begins at `begin`; `begin` if none.
std::size_t end_of_comment_or_string(std::string_view text, std::size_t begin) {
  const char quote = text[begin];
  if (quote == '#') return std::min(text.find('\n', begin), text.size());
  if (quote != '"' && quote != '\'') return begin;
  const std::string three(3, quote);
  const std::string delimiter = text.substr(begin, 3) == three ? three : std::string(1, quote);
  for (std::size_t k = begin + delimiter.size(); k < text.size(); ++k) {
    if (quote == '"' && text[k] == '\\')
      ++k;
    else if (text.substr(k, delimiter.size()) == delimiter)
      return k + delimiter.size();
  }
  return text.size();
}

/// Throws for what toml++ does not survive, or does not explain: keys of very many names, texts that are not UTF-8.
void check_text(std::string_view text, const std::string& file) {
  const std::string_view mark = text.substr(0, 2);
  if (mark == "\xff\xfe" || mark == "\xfe\xff")
    throw InputError(SourceLocation{file, 1, ""}, "", "the text is UTF-16", "a file saved as UTF-8");
  int depth = 1;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const std::size_t end = end_of_comment_or_string(text, k);
    if (end > k) {
      k = end - 1;
      continue;
    }
    const bool in_key = std::isalnum(static_cast<unsigned char>(text[k])) || std::strchr("_- \t.", text[k]);
    if (!in_key || text[k] == '\0') depth = 1;
    if (text[k] != '.' || ++depth <= max_key_depth) continue;
    const auto line = static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(k), '\n'));
    throw InputError(SourceLocation{file, line + 1, ""}, "", "a key of too many parts",
                     "at most " + std::to_string(max_key_depth) + " parts with dots between them");
  }
}

/// One line of a text, counted from 1; "" beyond its end.
std::string line_of(const std::string& text, int number) {
  std::istringstream stream(text);
  std::string line;
  for (int k = 0; k < number; ++k)
    if (!std::getline(stream, line)) return "";
  return line;
}

toml::table parse_toml(const std::string& text, const std::string& file) {
  try {
    return toml::parse(std::string_view(text), std::string_view(file));
  } catch (const toml::parse_error& error) {
    const SourceLocation location{file, static_cast<int>(error.source().begin.line), ""};
    throw InputError(
        location, "",
        "not valid TOML: " + std::string(error.description()) + hint_of_line(line_of(text, location.line)));
  }
}

/// Returns parameters as the file has them, before overrides; none where they cannot be read, which is an error later
/// unless the overrides mend it.
Constants parameters_in_file(const toml::table& document, const std::string& file) try {
  const SceneText text{file, {}};
  const auto parameters = TomlCursor(document, "", text).find("parameters");
  return parameters ? read_parameters(*parameters) : Constants{};
} catch (const InputError&) {
  return {};
}

/// If [reference] depends on the contact force, it is read again when that is known; document and text stay until then.
void keep_reference(const TomlCursor& root, const std::shared_ptr<const toml::table>& document,
                    const std::shared_ptr<const SceneText>& text, Scene& scene) {
  const auto section = root.find("reference");
  if (!section || !uses_contact_force(*section)) return;
  std::vector<std::string> names;
  for (const BodySpec& body : scene.bodies) names.push_back(body.name);
  scene.reference_of_force = [section = *section, names, document, text](double contact_force) {
    return read_reference(section, names, contact_force);
  };
}

}  // namespace

Scene read_scene(const std::string& file, const std::vector<std::string>& overrides) {
  return parse_scene(read_file(file), file, overrides);
}

Scene parse_scene(const std::string& text, const std::string& file, const std::vector<std::string>& overrides) {
  check_text(text, file);
  const auto document = std::make_shared<toml::table>(parse_toml(text, file));
  const Constants in_file = overrides.empty() ? Constants{} : parameters_in_file(*document, file);
  apply_overrides(*document, overrides);
  const auto source = std::make_shared<SceneText>(SceneText{file, {}});
  const TomlCursor root(*document, "", *source);
  if (const auto parameters = root.find("parameters")) {
    source->parameters = read_parameters(*parameters, in_file);
    for (const auto& [name, value] : parameters->entries())
      if (value.is_string()) source->definitions[name] = value.string();
  }
  make_copies(*document, *source, [&] {
    toml::table again = parse_toml(text, file);
    apply_overrides(again, overrides);
    return again;
  });
  Scene scene = SceneReader().read(root);
  keep_reference(root, document, source, scene);
  const std::string stem = std::filesystem::path(file).stem().string();
  if (scene.title.empty()) scene.title = stem;
  if (scene.output.directory.empty()) scene.output.directory = (std::filesystem::path("out") / stem).string();
  return scene;
}

}  // namespace cgcontact
