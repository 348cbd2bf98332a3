#include "core/cells/grid_numbers.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "core/base/errors/errors.hpp"

namespace cgcontact {

GridNumbers::GridNumbers(const Index3& extent) : extent_(extent) {
  words_per_row_ = std::max(1, (extent[0] + word_size - 1) / word_size);
}

GridNumbers::GridNumbers(const Index3& extent, const std::vector<Index3>& indices) : GridNumbers(extent) {
  for (const Index3& index : indices) insert(index);
  number();
}

void GridNumbers::insert_row(const Index3& first, int length) {
  if (length <= 0) return;
  for (int d = 0; d < 3; ++d)
    if (first[d] < 0 || first[d] + (d == 0 ? length : 1) > extent_[d])
      throw std::logic_error("a place outside of the grid is to be numbered");
  for (int begin = first[0], end = begin + length; begin < end;) {
    const int word = begin / word_size, bit = begin % word_size, count = std::min(end - begin, word_size - bit);
    const std::uint64_t ones = ~std::uint64_t{0} >> (word_size - count);
    word_at(key_of(word, first[1], first[2])).bits |= ones << bit;
    begin += count;
  }
}

GridNumbers::Word& GridNumbers::word_at(std::int64_t key) {
  if (!words_.empty() && words_.back().key == key) return words_.back();  // positions mostly come along rows
  if (2 * (words_.size() + 1) > table_.size()) fill_table(std::max<std::size_t>(16, 2 * table_.size()));
  std::size_t slot = slot_of(key);
  for (; table_[slot] >= 0; slot = (slot + 1) & (table_.size() - 1))
    if (words_[table_[slot]].key == key) return words_[table_[slot]];
  table_[slot] = static_cast<int>(words_.size());
  words_.push_back({key, 0, 0});
  return words_.back();
}

/// size: a power of two, at least twice the words.
void GridNumbers::fill_table(std::size_t size) {
  table_.assign(size, -1);
  shift_ = __builtin_clzll(size) + 1;
  for (std::size_t w = 0; w < words_.size(); ++w) {
    std::size_t slot = slot_of(words_[w].key);
    while (table_[slot] >= 0) slot = (slot + 1) & (size - 1);
    table_[slot] = static_cast<int>(w);
  }
}

void GridNumbers::number() {
  const auto before = [](const Word& a, const Word& b) { return a.key < b.key; };
  if (!std::is_sorted(words_.begin(), words_.end(), before)) {
    std::sort(words_.begin(), words_.end(), before);
    fill_table(table_.size());
  }
  words_.shrink_to_fit();
  size_ = 0;
  for (Word& word : words_) {
    word.first = static_cast<int>(size_);
    size_ += static_cast<std::size_t>(__builtin_popcountll(word.bits));
    if (size_ > static_cast<std::size_t>(std::numeric_limits<int>::max()))
      throw InputError("a body has more than " + std::to_string(std::numeric_limits<int>::max()) +
                       " cells or grid nodes (allowed: fewer, larger cells)");
  }
}

void GridNumbers::find_row(const Index3& first, int length, int* numbers) const {
  const bool row_exists = first[1] >= 0 && first[1] < extent_[1] && first[2] >= 0 && first[2] < extent_[2];
  for (int i = first[0], end = first[0] + length; i < end;) {
    const bool exists = row_exists && i >= 0 && i < extent_[0];
    const Word* word = exists ? find_word(key_of(i / word_size, first[1], first[2])) : nullptr;
    const int stop = exists ? std::min(end, (i / word_size + 1) * word_size) : i < 0 ? std::min(end, 0) : end;
    for (; i < stop; ++i) *numbers++ = word ? word->find(i % word_size) : -1;
  }
}

std::uint64_t GridNumbers::bits(const Index3& first) const {
  if (first[1] < 0 || first[1] >= extent_[1] || first[2] < 0 || first[2] >= extent_[2]) return 0;
  const auto word_bits = [&](int w) {
    const Word* word = w < words_per_row_ ? find_word(key_of(w, first[1], first[2])) : nullptr;
    return word ? word->bits : std::uint64_t{0};
  };
  if (first[0] < 0) return word_bits(0) << -first[0];
  const int w = first[0] / word_size, shift = first[0] % word_size;
  return shift == 0 ? word_bits(w) : word_bits(w) >> shift | word_bits(w + 1) << (word_size - shift);
}

GridNumbers GridNumbers::corners() const {
  GridNumbers nodes({extent_[0] + 1, extent_[1] + 1, extent_[2] + 1});
  for (const Word& word : words_) {
    const std::int64_t row = word.key / words_per_row_;
    const int w = static_cast<int>(word.key % words_per_row_), j = static_cast<int>(row % extent_[1]),
              k = static_cast<int>(row / extent_[1]);
    for (int side = 0; side < 4; ++side) {
      nodes.word_at(nodes.key_of(w, j + side % 2, k + side / 2)).bits |= word.bits | word.bits << 1;
      if (word.bits >> (word_size - 1))
        nodes.word_at(nodes.key_of(w + 1, j + side % 2, k + side / 2)).bits |= std::uint64_t{1};
    }
  }
  nodes.number();
  return nodes;
}

}  // namespace cgcontact
