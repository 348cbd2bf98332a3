/// Segments of a region on a line t = const.
#pragma once

#include <vector>

#include "core/quadrature/region.hpp"

namespace cgcontact {

/// Maximal segment with one value and one set of divider bits. Ids of the ends: 2 f + r for the r-th root of function
/// f, negative for the ends of the square's edge.
struct Segment {
  double begin, end;
  int begin_id, end_id;
  int value;
  std::uint64_t mask;
};

/// Structure of a slice, constant on an interval of t.
struct Signature {
  std::uint64_t hash = 0;
  std::uint64_t used = 0;  ///< functions that delimit segments
  bool empty = true;
  bool operator==(const Signature& other) const { return hash == other.hash; }
  bool operator!=(const Signature& other) const { return hash != other.hash; }
};

class Slicer {
 public:
  void reset(const Region& region);
  const Region& region() const { return *region_; }

  /// Returns segments that are valid until the next call.
  const std::vector<Segment>& slice(double t);
  Signature signature(double t);

 private:
  struct Cut {
    double s;
    int id;
  };
  void add_roots(int f, double t);
  void add_general_roots(int f, double t, double begin, double end);
  void sort_cuts();
  std::uint64_t mask_at(double s, double t, bool with_general) const;

  const Region* region_ = nullptr;
  bool has_general_ = false;  ///< a function needs numerical roots
  std::vector<Cut> cuts_;
  std::vector<Segment> segments_;
};

/// Returns whether it is a function on the graph whose roots along a line have no closed form here.
inline bool is_general_trace(const RegionFunction& f) { return f.on_graph && !f.quadric.q.isZero(0); }

}  // namespace cgcontact
