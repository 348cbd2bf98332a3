#include "core/triangles/triangle_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <string_view>
#include <tuple>

#include "core/base/errors/errors.hpp"
#include "core/triangles/polygon_triangles.hpp"

namespace cgcontact {

namespace {

constexpr std::size_t max_triangles_of_file = 100'000'000;
constexpr std::uintmax_t max_surface_bytes = 20'000'000'000;
constexpr std::size_t stl_header = 84, stl_facet = 50;

[[noreturn]] void fail(const std::string& file, int line, const std::string& problem, const std::string& allowed = {}) {
  throw InputError(SourceLocation{file, line, ""}, "", problem, allowed);
}

std::string read_bytes(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error))
    fail(file, 0, error ? "the file cannot be read: " + error.message() : "there is no such file");
  if (!std::filesystem::is_regular_file(file, error)) fail(file, 0, "is not a file but a folder or device");
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) fail(file, 0, "the file cannot be read: " + error.message());
  if (size > max_surface_bytes) fail(file, 0, fmt::format("has {} bytes", size), "up to 20 GB");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail(file, 0, std::string("the file cannot be read: ") + std::strerror(errno));
  std::string text(size, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream) fail(file, 0, std::string("the file cannot be read: ") + std::strerror(errno));
  return text;
}

/// Lines of a text, and the words of the present one.
class LineReader {
 public:
  LineReader(const std::string& file, std::string_view text) : file_(file), rest_(text) {}

  /// The next line that has a word; its first word, or "" at the end.
  std::string_view next_line() {
    while (!rest_.empty()) {
      const std::size_t end = std::min(rest_.find('\n'), rest_.size());
      words_ = rest_.substr(0, end);
      rest_.remove_prefix(std::min(end + 1, rest_.size()));
      ++line_;
      const std::string_view word = next_word();
      if (!word.empty()) return word;
    }
    return {};
  }
  std::string_view next_word() {
    const char* const blank = " \t\r\f\v";
    words_.remove_prefix(std::min(words_.find_first_not_of(blank), words_.size()));
    const std::string_view word = words_.substr(0, words_.find_first_of(blank));
    words_.remove_prefix(word.size());
    return word;
  }
  double number(const char* what) { return number(next_word(), what); }
  double number(std::string_view word, const char* what) const {
    if (word.empty())
      fail(file_, line_, rest_.empty() ? "the file ends here: is it truncated?" : "a number is missing", what);
    const std::string_view whole = word;
    if (!word.empty() && word[0] == '+') word.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || error != std::errc() || end != word.data() + word.size())
      fail(file_, line_, fmt::format("\"{}\" is no number", whole), what);
    if (!std::isfinite(value)) fail(file_, line_, fmt::format("\"{}\" is not finite", whole), what);
    return value;
  }
  long long integer(const char* what) { return integer(next_word(), what); }
  long long integer(std::string_view word, const char* what) const {
    long long value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || error != std::errc() || end != word.data() + word.size())
      fail(file_, line_, fmt::format("\"{}\" is no integer", word), what);
    return value;
  }
  Vec3 vector(const char* what) {
    Vec3 x;
    for (int k = 0; k < 3; ++k) x[k] = number(what);
    return x;
  }
  int line() const { return line_; }
  std::string_view rest() const { return rest_; }

 private:
  const std::string& file_;
  std::string_view rest_, words_;
  int line_ = 0;
};

std::string lower(std::string_view word) {
  std::string result(word);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

/// Groups of facets, which begin one after the other and last until the next ones begin.
class GroupReader {
 public:
  /// Begins a group after `facets` facets.
  void begin(const std::vector<std::string>& names, int facets, TriangleSoup& soup) {
    finish(facets, soup);
    names_ = names;
    first_ = facets + 1;
  }
  void finish(int facets, TriangleSoup& soup) const {
    if (facets < first_) return;
    for (const std::string& name : names_) soup.groups.push_back({name, first_, facets});
  }

 private:
  std::vector<std::string> names_;
  int first_ = 1;
};

/// Adds a polygon as triangles; `line` 0: the file has none.
void add_polygon(const std::string& file, const std::vector<int>& corners, int number, int line, TriangleSoup& soup) {
  const std::string where = fmt::format("face {}", number);
  if (corners.size() < 3) fail(file, line, where + " has fewer than three corners");
  std::vector<Vec3> positions;
  for (const int c : corners) {
    if (c < 0 || c >= static_cast<int>(soup.points.size()))
      fail(file, line, fmt::format("{} refers to vertex {} of {}", where, c + 1, soup.points.size()));
    positions.push_back(soup.points[c]);
  }
  const std::vector<Triangle> triangles = polygon_triangles(positions);
  if (triangles.empty())
    fail(file, line, where + " crosses itself or has no area", "simple polygons; triangles are best");
  for (const Triangle& t : triangles) {
    soup.triangles.push_back({corners[t[0]], corners[t[1]], corners[t[2]]});
    soup.number.push_back(number);
    if (line > 0) soup.line.push_back(line);
  }
}

/// Polygons whose corners come after them in the file.
class LaterPolygons {
 public:
  void add(const std::string& file, const std::vector<int>& corners, int number, int line, TriangleSoup& soup) {
    const auto known = [&](int c) { return c < static_cast<int>(soup.points.size()); };
    if (std::all_of(corners.begin(), corners.end(), known))
      add_polygon(file, corners, number, line, soup);
    else
      list_.push_back({corners, number, line});
  }
  void finish(const std::string& file, TriangleSoup& soup) const {
    for (const auto& [corners, number, line] : list_) add_polygon(file, corners, number, line, soup);
  }

 private:
  std::vector<std::tuple<std::vector<int>, int, int>> list_;
};

TriangleSoup read_stl_text(const std::string& file, const std::string& text) {
  TriangleSoup soup;
  LineReader reader(file, text);
  int corners = -1, facet_line = 0;  // -1: outside of a facet
  bool ended = false;
  GroupReader groups;
  const auto num_facets = [&] { return static_cast<int>(soup.triangles.size()); };
  for (std::string_view word = reader.next_line(); !word.empty(); word = reader.next_line()) {
    const std::string key = lower(word);
    ended = key == "endsolid";
    if (key == "solid") {
      const std::string_view name = reader.next_word();
      groups.begin(name.empty() ? std::vector<std::string>{} : std::vector<std::string>{std::string(name)},
                   num_facets(), soup);
    } else if (key == "facet") {
      if (corners >= 0) fail(file, reader.line(), "a facet begins before the one before has ended");
      corners = 0;
      facet_line = reader.line();
    } else if (key == "vertex") {
      if (corners < 0) fail(file, reader.line(), "a vertex outside of a facet");
      soup.points.push_back(reader.vector("vertex x y z"));
      ++corners;
    } else if (key == "endfacet") {
      if (corners != 3)
        fail(file, reader.line(), fmt::format("a facet with {} vertices", std::max(corners, 0)), "three");
      const int n = static_cast<int>(soup.points.size());
      soup.triangles.push_back({n - 3, n - 2, n - 1});
      soup.line.push_back(facet_line);
      corners = -1;
    } else if (key != "endsolid" && key != "outer" && key != "endloop") {
      fail(file, reader.line(),
           fmt::format("\"{}\" is no word of an STL file{}", word, reader.rest().empty() ? ": is it truncated?" : ""),
           "solid, facet, outer, vertex, endloop, endfacet, endsolid");
    }
  }
  if (!ended) fail(file, reader.line(), "the file ends before \"endsolid\": is it truncated?");
  groups.finish(num_facets(), soup);
  return soup;
}

TriangleSoup read_stl_binary(const std::string& file, const std::string& bytes) {
  std::uint32_t count = 0;
  if (bytes.size() >= stl_header) std::memcpy(&count, bytes.data() + stl_header - 4, 4);
  const std::size_t expected = stl_header + stl_facet * count;
  if (bytes.size() < stl_header || bytes.size() != expected)
    fail(file, 0,
         fmt::format(
             "is neither an ASCII STL file (\"solid\" ... \"facet\") nor a binary one: it announces {} facets, {} "
             "bytes, and has {} bytes{}",
             count, expected, bytes.size(), bytes.size() < expected ? ": is it truncated?" : ""));
  TriangleSoup soup;
  soup.points.reserve(3 * static_cast<std::size_t>(count));
  soup.triangles.reserve(count);
  for (std::size_t t = 0; t < count; ++t) {
    float values[9];
    std::memcpy(values, bytes.data() + stl_header + stl_facet * t + 12, sizeof(values));
    const int n = static_cast<int>(soup.points.size());
    for (int v = 0; v < 3; ++v) {
      const Vec3 x(values[3 * v], values[3 * v + 1], values[3 * v + 2]);
      if (!x.allFinite()) fail(file, 0, fmt::format("triangle {} has a coordinate that is not finite", t + 1));
      soup.points.push_back(x);
    }
    soup.triangles.push_back({n, n + 1, n + 2});
  }
  return soup;
}

TriangleSoup read_stl(const std::string& file, const std::string& bytes) {
  // Binary headers may begin with "solid" as well: the length decides.
  std::uint32_t count = 0;
  if (bytes.size() >= stl_header) std::memcpy(&count, bytes.data() + stl_header - 4, 4);
  const bool binary = bytes.size() >= stl_header && bytes.size() == stl_header + stl_facet * count;
  LineReader start(file, std::string_view(bytes).substr(0, 4096));
  const bool text = !binary && lower(start.next_line()) == "solid" && bytes.find('\0') == std::string::npos;
  TriangleSoup soup = text ? read_stl_text(file, bytes) : read_stl_binary(file, bytes);
  merge_equal_points(soup);
  return soup;
}

/// Statements of an OBJ file that say nothing about the surface; free-form curves and surfaces are not among them.
bool is_ignored_in_obj(std::string_view word) {
  static const std::set<std::string_view> ignored{"vt",    "vn",       "vp",       "l",      "p",          "o",
                                                  "s",     "mg",       "usemtl",   "mtllib", "usemap",     "maplib",
                                                  "bevel", "c_interp", "d_interp", "lod",    "shadow_obj", "trace_obj"};
  return word[0] == '#' || ignored.count(word) > 0;
}

/// The corners of a face, "7", "7/1", "7//3" or "7/1/3", which may go on after a backslash at the end of a line.
void read_obj_corners(LineReader& reader, const std::string& file, long long num_points, std::vector<int>& corners) {
  corners.clear();
  const char* const allowed = "f vertex vertex vertex, or with /texture/normal";
  for (std::string_view corner = reader.next_word(); !corner.empty() && corner[0] != '#'; corner = reader.next_word()) {
    if (corner == "\\") corner = reader.next_line();
    if (corner.empty()) break;
    if (corner.find_first_not_of("0123456789/-+") != std::string_view::npos)
      fail(file, reader.line(), fmt::format("\"{}\" is no corner of a face", corner), allowed);
    const long long index = reader.integer(corner.substr(0, corner.find('/')), allowed);
    const long long number = index < 0 ? num_points + index : index - 1;
    if (number < 0 || number > 2'000'000'000)
      fail(file, reader.line(), fmt::format("vertex {} of {}", index, num_points));
    corners.push_back(static_cast<int>(number));
  }
}

TriangleSoup read_obj(const std::string& file, const std::string& text) {
  if (text.find('\0') != std::string::npos) fail(file, 0, "is not a text (UTF-8 or ASCII), as OBJ files are");
  TriangleSoup soup;
  LineReader reader(file, text);
  int faces = 0;
  std::vector<int> corners;
  LaterPolygons later;
  GroupReader groups;
  for (std::string_view word = reader.next_line(); !word.empty(); word = reader.next_line()) {
    if (word == "g") {
      std::vector<std::string> names;
      for (word = reader.next_word(); !word.empty() && word[0] != '#'; word = reader.next_word())
        names.emplace_back(word);
      groups.begin(names, faces, soup);
    } else if (word == "v") {
      soup.points.push_back(reader.vector("v x y z"));
    } else if (word == "f") {
      const int line = reader.line();
      read_obj_corners(reader, file, static_cast<long long>(soup.points.size()), corners);
      later.add(file, corners, ++faces, line, soup);
    } else if (!is_ignored_in_obj(word)) {
      fail(file, reader.line(), fmt::format("\"{}\" is no statement of a polygon mesh", word),
           "v, f, and what says nothing about the shape (vt, vn, g, o, s, l, usemtl, mtllib, ...)");
    }
  }
  later.finish(file, soup);
  groups.finish(faces, soup);
  return soup;
}

/// Reads text in OFF, also with colours, normals or texture coordinates behind the coordinates (COFF, NOFF, STOFF,
/// ...), which say nothing about the shape.
TriangleSoup read_off(const std::string& file, const std::string& text) {
  TriangleSoup soup;
  LineReader reader(file, text);
  const auto next_line = [&](const char* wanted) {
    std::string_view word = reader.next_line();
    while (!word.empty() && word[0] == '#') word = reader.next_line();
    if (word.empty()) fail(file, reader.line(), fmt::format("the file ends before its {}: is it truncated?", wanted));
    return word;
  };
  const std::string kind = lower(next_line("header"));
  for (const char* const allowed : {"off", "coff", "noff", "cnoff", "stoff", "stcoff", "stnoff", "stcnoff"})
    if (kind == allowed) soup.line.push_back(0);
  if (soup.line.empty())
    fail(file, reader.line(), fmt::format("\"{}\" does not begin an OFF file in three dimensions", kind),
         "OFF, COFF, NOFF, CNOFF, STOFF, ...");
  soup.line.clear();
  std::string_view word = reader.next_word();
  if (lower(word) == "binary") fail(file, reader.line(), "the file is in binary OFF", "OFF in text, or STL, OBJ, PLY");
  if (word.empty() || word[0] == '#') word = next_line("numbers of vertices and faces");
  const char* const counts = "numbers of vertices, faces and edges";
  const long long vertices = reader.integer(word, counts), faces = reader.integer(counts);
  if (vertices < 0 || faces < 0) fail(file, reader.line(), "a negative number of vertices or faces", counts);
  for (long long v = 0; v < vertices; ++v) {
    Vec3 x;
    x[0] = reader.number(next_line("last vertex"), "x y z");
    for (int k = 1; k < 3; ++k) x[k] = reader.number("x y z");
    soup.points.push_back(x);
  }
  std::vector<int> corners;
  for (long long f = 0; f < faces; ++f) {
    const long long count = reader.integer(next_line("last face"), "number of corners, corners");
    corners.clear();
    for (long long k = 0; k < count; ++k) {
      const long long corner = reader.integer("number of corners, corners");
      if (corner < 0 || corner >= vertices)
        fail(file, reader.line(), fmt::format("face {} refers to vertex {}", f + 1, corner),
             fmt::format("0 to {}", vertices - 1));
      corners.push_back(static_cast<int>(corner));
    }
    add_polygon(file, corners, static_cast<int>(f) + 1, reader.line(), soup);
  }
  return soup;
}

/// Lines of a PLY file's header that describe one element.
struct PlyProperty {
  std::string name, type, count_type;  ///< count_type: of a list
};
struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
};

int ply_size(const std::string& type) {
  for (const char* one : {"char", "uchar", "int8", "uint8"})
    if (type == one) return 1;
  for (const char* two : {"short", "ushort", "int16", "uint16"})
    if (type == two) return 2;
  for (const char* four : {"int", "uint", "int32", "uint32", "float", "float32"})
    if (type == four) return 4;
  return type == "double" || type == "float64" ? 8 : 0;
}

class PlyReader {
 public:
  PlyReader(const std::string& file, const std::string& text) : file_(file), reader_(file, text) {}

  TriangleSoup read() {
    read_header();
    bytes_ = reader_.rest();
    for (const PlyElement& element : elements_) {
      if (element.properties.empty() && element.count > 0)
        fail(file_, 0, fmt::format("the elements \"{}\" have no properties", element.name));
      if (element.count > bytes_.size()) fail(file_, 0, truncated(element));
    }
    for (const char* axis : {"x", "y", "z"}) expect_property("vertex", {axis});
    expect_property("face", {"vertex_indices", "vertex_index"});
    for (const PlyElement& element : elements_)
      for (std::size_t i = 0; i < element.count; ++i) read_item(element, static_cast<int>(i) + 1);
    later_.finish(file_, soup_);
    return std::move(soup_);
  }

 private:
  void read_header() {
    if (reader_.next_line() != "ply") fail(file_, 1, "a PLY file begins with \"ply\"");
    for (std::string_view word = reader_.next_line(); word != "end_header"; word = reader_.next_line()) {
      if (word == "format") {
        format_ = reader_.next_word();
        if (format_ != "ascii" && format_ != "binary_little_endian" && format_ != "binary_big_endian")
          fail(file_, reader_.line(), "unknown format \"" + format_ + "\"",
               "ascii, binary_little_endian, binary_big_endian");
      } else if (word == "element") {
        PlyElement element;
        element.name = reader_.next_word();
        const long long count = reader_.integer("element name count");
        if (count < 0 || count > 3 * static_cast<long long>(max_triangles_of_file))
          fail(file_, reader_.line(), "cannot have so many elements");
        element.count = static_cast<std::size_t>(count);
        elements_.push_back(element);
      } else if (word == "property" && !elements_.empty()) {
        PlyProperty property;
        property.type = reader_.next_word();
        if (property.type == "list") {
          property.count_type = reader_.next_word();
          property.type = reader_.next_word();
        }
        property.name = reader_.next_word();
        if (ply_size(property.type) == 0 || (!property.count_type.empty() && ply_size(property.count_type) == 0))
          fail(file_, reader_.line(), "unknown type of a property");
        elements_.back().properties.push_back(property);
      } else if (word.empty()) {
        fail(file_, reader_.line(), "the header has no \"end_header\": is the file truncated?");
      } else if (word != "comment" && word != "obj_info") {
        fail(file_, reader_.line(), fmt::format("\"{}\" is no word of a PLY header", word));
      }
    }
    if (format_.empty()) fail(file_, 0, "the header has no format");
  }

  /// One of the names.
  void expect_property(const std::string& owner, const std::vector<std::string>& names) const {
    for (const PlyElement& element : elements_)
      for (const PlyProperty& property : element.properties)
        if (element.name == owner && std::find(names.begin(), names.end(), property.name) != names.end()) return;
    fail(file_, 0, fmt::format("the header has no element \"{}\" with a property \"{}\"", owner, names[0]),
         "polygons: vertex with x, y, z and face with the list vertex_indices");
  }

  void read_item(const PlyElement& element, int number) {
    if (format_ == "ascii") {
      word_ = reader_.next_line();
      if (word_.empty()) fail(file_, reader_.line(), truncated(element));
    }
    Vec3 x = Vec3::Zero();
    std::vector<int> corners;
    for (const PlyProperty& property : element.properties) {
      if (property.count_type.empty()) {
        const double v = value(property.type, element);
        for (int k = 0; k < 3; ++k)
          if (property.name == std::string(1, static_cast<char>('x' + k))) x[k] = v;
        continue;
      }
      const double count = value(property.count_type, element);
      if (!(count >= 0 && count == std::floor(count)))
        fail(file_, line_of_item(), fmt::format("{} {}: {} is no length of a list", element.name, number, count));
      const bool used = property.name == "vertex_indices" || property.name == "vertex_index";
      for (double i = 0; i < count; ++i) {
        const double v = value(property.type, element);
        if (!used) continue;
        if (!(v >= 0 && v < 2e9 && v == std::floor(v)))
          fail(file_, line_of_item(), fmt::format("face {} refers to vertex {}", number, v));
        corners.push_back(static_cast<int>(v));
      }
    }
    const int line = line_of_item();
    if (element.name == "vertex") {
      if (!x.allFinite()) fail(file_, line, fmt::format("vertex {} has a coordinate that is not finite", number));
      soup_.points.push_back(x);
    } else if (element.name == "face") {
      later_.add(file_, corners, number, line, soup_);
    }
  }

  int line_of_item() const { return format_ == "ascii" ? reader_.line() : 0; }

  std::string truncated(const PlyElement& element) const {
    return fmt::format("the file ends before its {} elements \"{}\": is it truncated?", element.count, element.name);
  }

  double value(const std::string& type, const PlyElement& element) {
    if (format_ == "ascii") {
      if (word_.empty()) word_ = reader_.next_word();
      if (word_.empty()) fail(file_, reader_.line(), "a number is missing in this line");
      double v = 0;
      const auto [end, error] = std::from_chars(word_.data(), word_.data() + word_.size(), v);
      if (error != std::errc() || end != word_.data() + word_.size())
        fail(file_, reader_.line(), fmt::format("\"{}\" is no number", word_));
      word_ = {};
      return v;
    }
    const auto size = static_cast<std::size_t>(ply_size(type));
    if (bytes_.size() < size) fail(file_, 0, truncated(element));
    char raw[8];
    const bool reversed = format_ == "binary_big_endian";
    for (std::size_t i = 0; i < size && i < sizeof(raw); ++i) raw[i] = bytes_[reversed ? size - 1 - i : i];
    bytes_.remove_prefix(size);
    const auto as = [&](auto v) {
      std::memcpy(&v, raw, sizeof(v));
      return static_cast<double>(v);
    };
    if (type == "float" || type == "float32") return as(float{});
    if (size == 8) return as(double{});
    const bool is_unsigned = type[0] == 'u';
    if (size == 1) return is_unsigned ? as(std::uint8_t{}) : as(std::int8_t{});
    if (size == 2) return is_unsigned ? as(std::uint16_t{}) : as(std::int16_t{});
    return is_unsigned ? as(std::uint32_t{}) : as(std::int32_t{});
  }

  const std::string& file_;
  LineReader reader_;
  std::string format_;
  std::vector<PlyElement> elements_;
  std::string_view bytes_, word_;
  TriangleSoup soup_;
  LaterPolygons later_;
};

/// ".ply", ".off" or words for what is certainly something else than a surface; empty: not known.
std::string other_kind(const std::string& bytes) {
  const auto begins = [&](std::string_view start) { return bytes.compare(0, start.size(), start) == 0; };
  if (begins("\x1f\x8b")) return "compressed (gzip)";
  if (begins("PK\x03\x04")) return "a zip archive";
  if (begins("\xff\xfe") || begins("\xfe\xff")) return "not a text in UTF-8 but in UTF-16";
  if (begins("OFF\n") || begins("OFF\r")) return ".off";
  return begins("ply\n") || begins("ply\r") ? ".ply" : "";
}

std::string extension_of(const std::string& file) { return lower(std::filesystem::path(file).extension().string()); }

/// Throws if the name does not end like one of the formats.
std::string known_extension_of(const std::string& file) {
  if (!is_triangle_file(file))
    fail(file, 0, "unknown kind of file \"" + extension_of(file) + "\"", ".stl, .obj, .ply, .off");
  return extension_of(file);
}

}  // namespace

bool is_triangle_file(const std::string& file) {
  const std::string extension = extension_of(file);
  return extension == ".stl" || extension == ".obj" || extension == ".ply" || extension == ".off";
}

int merge_equal_points(TriangleSoup& soup) {
  std::size_t size = 16;
  while (size < 2 * soup.points.size()) size *= 2;
  std::vector<int> table(size, -1), number(soup.points.size());
  std::size_t count = 0;
  for (std::size_t p = 0; p < soup.points.size(); ++p) {
    const Vec3 x = soup.points[p] + Vec3::Zero();  // -0 becomes 0
    std::uint64_t words[3], slot = 0;
    std::memcpy(words, x.data(), sizeof(words));
    for (const std::uint64_t word : words) {
      slot = (slot ^ word) * 0x9e3779b97f4a7c15ull;
      slot ^= slot >> 29;
    }
    for (slot &= size - 1; table[slot] >= 0 && soup.points[table[slot]] != x; slot = (slot + 1) & (size - 1)) {
    }
    if (table[slot] < 0) {
      table[slot] = static_cast<int>(count);
      soup.points[count++] = x;
    }
    number[p] = table[slot];
  }
  const int gone = static_cast<int>(soup.points.size() - count);
  soup.points.resize(count);
  for (Triangle& t : soup.triangles)
    for (int& p : t) p = number[p];
  return gone;
}

TriangleSoup read_triangles(const std::string& file) {
  known_extension_of(file);
  return parse_triangles(file, read_bytes(file));
}

TriangleSoup parse_triangles(const std::string& file, const std::string& bytes) {
  const std::string extension = known_extension_of(file);
  if (bytes.empty()) fail(file, 0, "the file is empty");
  if (bytes.rfind("\xef\xbb\xbf", 0) == 0) return parse_triangles(file, bytes.substr(3));  // a byte order mark
  const std::string other = other_kind(bytes);
  if (!other.empty() && other != extension)
    fail(file, 0, "the content is " + other, "what the name says: .stl, .obj, .ply or .off");
  TriangleSoup soup = extension == ".stl"   ? read_stl(file, bytes)
                      : extension == ".obj" ? read_obj(file, bytes)
                      : extension == ".off" ? read_off(file, bytes)
                                            : PlyReader(file, bytes).read();
  if (soup.triangles.empty()) fail(file, 0, "there is no triangle in the file");
  if (soup.triangles.size() > max_triangles_of_file) fail(file, 0, "has more than 1e8 triangles");
  return soup;
}

}  // namespace cgcontact
