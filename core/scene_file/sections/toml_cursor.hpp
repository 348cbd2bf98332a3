/// A node of the scene file with its dotted key: typed, checked access whose errors name file, line, key and value.
#pragma once

#include <toml++/toml.h>

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/errors/errors.hpp"
#include "core/base/numbers/types.hpp"
#include "core/expressions/expression.hpp"
#include "core/settings/range.hpp"

namespace cgcontact {

/// Data that all cursors of one scene share.
struct SceneText {
  std::string file;
  Constants parameters;
  std::map<std::string, std::string> definitions = {};  ///< of the parameters that are expressions, as written
};

/// Nodes that come from --set carry the text of the option as their source path.
const char* const override_prefix = "--set ";

class TomlCursor {
 public:
  TomlCursor(const toml::node& node, std::string key, const SceneText& text);

  const toml::node& node() const { return *node_; }
  const std::string& key() const { return key_; }
  const SceneText& text() const { return *text_; }
  SourceLocation location() const;
  /// Returns the value as TOML.
  std::string value() const;
  [[noreturn]] void fail(const std::string& problem, const std::string& allowed = {}) const;

  bool is_table() const { return node_->is_table(); }
  bool is_array() const { return node_->is_array(); }
  bool is_string() const { return node_->is_string(); }

  /// Throws unless this is a table that has no other keys than these; tells all others.
  void expect_keys(const std::vector<std::string>& keys) const;
  std::optional<TomlCursor> find(const std::string& key) const;
  /// Throws "missing" unless the key exists; `allowed` says what should be there.
  TomlCursor at(const std::string& key, const std::string& allowed = {}) const;
  /// Returns key and value of all entries in the order of the file.
  std::vector<std::pair<std::string, TomlCursor>> entries() const;
  /// Elements of an array; a missing array of tables is empty. `what` says what the elements are.
  std::vector<TomlCursor> elements(const std::string& what) const;

  std::string string(const std::string& what = "a string") const;
  /// Returns which of these names the string is.
  int one_of(const std::vector<std::string>& names) const;
  bool boolean() const;
  /// Reads a number, or a string that is an expression of the parameters; in the unit of the range.
  double number(const Range& range) const;
  /// Reads the same of any dimension, in SI units.
  Quantity quantity() const;
  int integer(int min, int max) const;
  Vec3 vector(const std::string& unit = "") const;
  /// Reads a vector that is not zero, normalised.
  Vec3 direction() const;
  /// Reads a number, or a string that is an expression of x, y, z and the parameters; `unit`: of the SI, "" for pure
  /// numbers.
  Expression expression(const std::string& unit) const;
  /// Reads {axis = [..], angle = degrees}; other keys are not looked at.
  Mat3 rotation() const;

 private:
  std::string type_name() const;
  Quantity quantity(const std::string& allowed) const;
  /// Returns the value, and what the parameter that it names was defined as.
  std::string value_with_definition() const;

  const toml::node* node_;
  std::string key_;
  const SceneText* text_;
};

/// Reads a name for bodies, faces, contact pairs and shapes: letters, digits, "_" and "-", not starting with a digit;
/// not too long for the names of files.
std::string read_name(const TomlCursor& node);

/// Throws if the name was there before; adds it.
void check_unique(const TomlCursor& node, const std::string& name, std::set<std::string>& seen,
                  const std::string& what);

}  // namespace cgcontact
