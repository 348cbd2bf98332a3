#include "core/scene_file/scene_copies.hpp"

#include <algorithm>
#include <cmath>

namespace cgcontact {

namespace {

const char* const copies_key = "copies";
const std::string mark = "{i}";
constexpr int max_copies = 1000;

int number_of_copies(const TomlCursor& copies) {
  const Range range = Range::integers(1, max_copies);
  const double number = copies.number(range);
  if (number != std::round(number)) copies.fail("is not a whole number", range.text);
  return static_cast<int>(number);
}

/// The largest number of copies below; checks all of them.
int max_copies_within(const TomlCursor& node, bool in_array, bool copied) {
  int largest = 0;
  const auto copies = in_array ? node.find(copies_key) : std::nullopt;
  if (copies && copied) copies->fail("copies cannot be nested", "copies on one of the two levels");
  if (copies) largest = number_of_copies(*copies);
  copied |= copies.has_value();
  if (node.is_array())
    for (const TomlCursor& child : node.elements("values"))
      largest = std::max(largest, max_copies_within(child, true, copied));
  for (const auto& [key, child] : node.entries()) largest = std::max(largest, max_copies_within(child, false, copied));
  return largest;
}

/// Writes the number into all texts.
void number_texts(toml::node& node, int number) {
  if (toml::table* table = node.as_table())
    for (auto&& [key, child] : *table) number_texts(child, number);
  if (toml::array* array = node.as_array())
    for (toml::node& child : *array) number_texts(child, number);
  if (toml::value<std::string>* value = node.as_string()) {
    std::string& text = value->get();
    for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at))
      text.replace(at, mark.size(), std::to_string(number));
  }
}

/// nodes: the same one of the document, first, and of its doubles.
void make_copies(const std::vector<toml::node*>& nodes, const SceneText& text) {
  const auto each = [&](const auto& child_of) {
    std::vector<toml::node*> children;
    for (toml::node* node : nodes) children.push_back(child_of(*node));
    return children;
  };
  if (toml::table* table = nodes.front()->as_table())
    for (auto&& [key, child] : *table)
      make_copies(each([name = key.str()](toml::node& node) { return node.as_table()->get(name); }), text);
  toml::array* array = nodes.front()->as_array();
  if (!array) return;
  toml::array all;
  for (std::size_t k = 0; k < array->size(); ++k) {
    const std::vector<toml::node*> elements = each([k](toml::node& node) { return node.as_array()->get(k); });
    const auto copies = TomlCursor(*elements.front(), "", text).find(copies_key);
    const int count = copies ? number_of_copies(*copies) : 1;
    if (!copies) make_copies(elements, text);
    for (int number = 1; number <= count; ++number) {
      toml::node& element = *elements[number - 1];
      if (copies) {
        element.as_table()->erase(copies_key);
        number_texts(element, number);
      }
      element.visit([&](auto& value) { all.push_back(std::move(value)); });
    }
  }
  array->clear();
  for (toml::node& element : all) element.visit([&](auto& value) { array->push_back(std::move(value)); });
}

}  // namespace

void make_copies(toml::table& document, const SceneText& text, const std::function<toml::table()>& again) {
  const int largest = max_copies_within(TomlCursor(document, "", text), false, false);
  if (largest == 0) return;
  std::vector<toml::table> doubles;
  for (int k = 1; k < largest; ++k) doubles.push_back(again());
  std::vector<toml::node*> documents{&document};
  for (toml::table& table : doubles) documents.push_back(&table);
  make_copies(documents, text);
}

}  // namespace cgcontact
