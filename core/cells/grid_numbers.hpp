/// Numbers of the positions of a grid, cells or nodes: the one look-up of both. Numbers go up in the order of the grid,
/// by k, j, i.
///
/// Sparse: a row along x is cut into words of 64 positions with one bit each; a word holds the number of its first
/// position, the others are counted. Nonempty words are found by a hash of their position. Memory goes with the
/// positions that there are (some 35 bytes per word, half a byte per cell of a solid body), not with the bounding box.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/numbers/types.hpp"

namespace cgcontact {

class GridNumbers {
 public:
  GridNumbers() = default;
  /// Starts without positions, out of those with 0 <= c[d] < extent[d].
  explicit GridNumbers(const Index3& extent);
  /// Numbers the given positions, in any order.
  GridNumbers(const Index3& extent, const std::vector<Index3>& indices);

  /// Adds a position, or `length` positions along x from `first` on; repeats do not count. Throws std::logic_error
  /// outside of the extent. Numbers hold after number().
  void insert(const Index3& index) { insert_row(index, 1); }
  void insert_row(const Index3& first, int length);
  /// Numbers all positions. Throws InputError if there are more than 32-bit numbers hold.
  void number();

  std::size_t size() const { return size_; }
  std::size_t bytes() const { return words_.capacity() * sizeof(Word) + table_.capacity() * sizeof(int); }

  /// Returns the number of a position, -1 if it is not there or outside of the extent.
  int find(const Index3& c) const {
    if (!contains_index(c)) return -1;
    const Word* word = find_word(key_of(c[0] / word_size, c[1], c[2]));
    return word ? word->find(c[0] % word_size) : -1;
  }

  /// Finds the numbers of `length` positions that follow each other along x, as find().
  void find_row(const Index3& first, int length, int* numbers) const;

  /// Returns the occupied ones of the 64 positions from `first` on along x: bit i is first + i. Zero outside of the
  /// extent; first[0] > -64.
  std::uint64_t bits(const Index3& first) const;

  /// Calls use(index) for all positions, by number.
  template <class Use>
  void each(const Use& use) const {
    each_word([&](Index3 index, std::uint64_t bits, int) {
      for (const int first = index[0]; bits != 0; bits &= bits - 1) {
        index[0] = first + __builtin_ctzll(bits);
        use(index);
      }
    });
  }

  /// Calls use(first, bits, number) for all words: bits() of the position `first`, whether it is there or not, and the
  /// number of the lowest bit that is set.
  template <class Use>
  void each_word(const Use& use) const {
    for (const Word& word : words_) {
      const std::int64_t row = word.key / words_per_row_;
      use(Index3{static_cast<int>(word.key % words_per_row_) * word_size, static_cast<int>(row % extent_[1]),
                 static_cast<int>(row / extent_[1])},
          word.bits, word.first);
    }
  }

  /// Returns the nodes of these cells: all corners, in an extent larger by one.
  GridNumbers corners() const;

 private:
  static constexpr int word_size = 64;
  struct Word {
    std::int64_t key;
    std::uint64_t bits;
    int first;  ///< number of the first position
    int find(int bit) const {
      const std::uint64_t here = std::uint64_t{1} << bit;
      return bits & here ? first + __builtin_popcountll(bits & (here - 1)) : -1;
    }
  };

  bool contains_index(const Index3& c) const {
    return static_cast<unsigned>(c[0]) < static_cast<unsigned>(extent_[0]) &&
           static_cast<unsigned>(c[1]) < static_cast<unsigned>(extent_[1]) &&
           static_cast<unsigned>(c[2]) < static_cast<unsigned>(extent_[2]);
  }
  std::int64_t key_of(int word, int j, int k) const {
    return (static_cast<std::int64_t>(k) * extent_[1] + j) * words_per_row_ + word;
  }
  std::size_t slot_of(std::int64_t key) const {
    return (static_cast<std::uint64_t>(key) * 0x9E3779B97F4A7C15u) >> shift_;
  }
  const Word* find_word(std::int64_t key) const {
    if (table_.empty()) return nullptr;
    for (std::size_t slot = slot_of(key);; slot = (slot + 1) & (table_.size() - 1)) {
      if (table_[slot] < 0) return nullptr;
      if (words_[table_[slot]].key == key) return &words_[table_[slot]];
    }
  }
  Word& word_at(std::int64_t key);
  void fill_table(std::size_t size);

  Index3 extent_{0, 0, 0};
  std::int64_t words_per_row_ = 1;
  std::vector<Word> words_;  ///< ascending in key, after number()
  std::vector<int> table_;   ///< hash -> word, -1: none; linear probing, a power of two
  int shift_ = 63;
  std::size_t size_ = 0;
};

}  // namespace cgcontact
