#include "recovery/constrained/contact_cells.hpp"

#include <algorithm>

#include "core/base/process/parallel.hpp"
#include "recovery/patch/cells_in_box.hpp"

namespace cgcontact {
namespace {

/// Fractions of the depth at which the cells below a point are asked for.
constexpr double depths[] = {0.05, 0.35, 0.65, 0.95};

/// Lists of some cells.
struct FacetLists {
  std::vector<int> facets_of_cell;
  std::vector<ContactFacet> facets;
  std::vector<PatchContactPoint> points;
  std::vector<int> under;
};

template <class T>
void append(const std::vector<T>& from, std::vector<T>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

ContactCells::ContactCells(const std::vector<RecoveryBody>& bodies, const std::vector<StressIntegrals>& integrals,
                           int index, double depth, const KnownPressures* known) {
  const BoundaryData& boundary = *bodies[index].boundary;
  const Grid& grid = bodies[index].mesh->cut_cells->grid;
  const Mat3& rotation = grid.rotation;
  const int num_cells = static_cast<int>(bodies[index].mesh->cell_nodes.size());
  row_of_cell_.assign(num_cells, -1);
  std::vector<int> cells;
  for (int cell = 0; cell < num_cells; ++cell)
    if (!boundary.links_of_cell[cell].empty()) {
      row_of_cell_[cell] = static_cast<int>(cells.size());
      cells.push_back(cell);
    }

  const auto add_point = [&](const ContactLink& link, ContactFacet& facet, FacetLists& lists) {
    if (facet.num_points++ == 0) facet.low = facet.high = link.position;
    facet.area += link.weight;
    facet.larger_cell = std::max(facet.larger_cell, link.larger_cell);
    std::optional<double> square;
    if (known && !boundary.is_bonded(link.pair) && boundary.friction_of(link.pair) == 0)
      square = known->square(link.pair, index, grid.to_global(link.position), rotation * link.normal);
    const bool pressed = square ? *square > 0 : link.active;
    if (pressed) facet.closed_area += link.weight;
    if (pressed && !square) facet.unknown_area += link.weight;
    facet.position += link.weight * link.position;
    facet.other_position += link.weight * link.other_position;
    facet.normal += link.weight * link.normal;
    facet.low = facet.low.cwiseMin(link.position);
    facet.high = facet.high.cwiseMax(link.position);
    const bool slips = link.slips && !link.shear.isZero(0);
    lists.points.push_back(
        {link.position, link.normal, link.distance, pressed, slips ? Vec3(link.shear.normalized()) : Vec3::Zero()});
    const CutCells& other = *bodies[link.other_body].mesh->cut_cells;
    const Vec3 inward =
        depth * other.size(link.other_cell) * (other.grid.rotation.transpose() * (rotation * link.normal));
    for (const double fraction : depths) {
      const int c = cell_at(other, link.other_position + fraction * inward);
      const bool repeated = static_cast<int>(lists.under.size()) > facet.first_under && lists.under.back() == c;
      if (c >= 0 && !repeated && integrals[link.other_body].hold(c)) lists.under.push_back(c);
    }
  };
  const auto add_facets = [&](int cell, FacetLists& lists) {
    const std::size_t first = lists.facets.size();
    for (int l : boundary.links_of_cell[cell]) {  // the pairs, in the order of the links
      const int pair = boundary.links[l].pair;
      if (std::any_of(lists.facets.begin() + static_cast<std::ptrdiff_t>(first), lists.facets.end(),
                      [&](const ContactFacet& p) { return p.pair == pair; }))
        continue;
      ContactFacet facet;
      facet.pair = pair;
      facet.cell_size = bodies[index].mesh->cut_cells->h(cell);
      facet.other_body = boundary.links[l].other_body;
      facet.first_point = static_cast<int>(lists.points.size());
      facet.first_under = static_cast<int>(lists.under.size());
      for (int k : boundary.links_of_cell[cell])
        if (boundary.links[k].pair == pair) add_point(boundary.links[k], facet, lists);
      const auto under = lists.under.begin() + facet.first_under;
      std::sort(under, lists.under.end());
      lists.under.erase(std::unique(under, lists.under.end()), lists.under.end());
      facet.num_under = static_cast<int>(lists.under.size()) - facet.first_under;
      lists.facets.push_back(facet);
    }
    lists.facets_of_cell.push_back(static_cast<int>(lists.facets.size() - first));
  };

  std::vector<FacetLists> chunks(num_chunks(cells.size(), grain_of_heavy));
  parallel_chunks("cgcontact::contact_cells::sums", cells.size(), grain_of_heavy,
                  [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                    for (std::size_t row = begin; row < end; ++row) add_facets(cells[row], chunks[chunk]);
                  });
  facet_begin_.assign(1, 0);
  for (FacetLists& lists : chunks) {
    for (ContactFacet& facet : lists.facets) {
      facet.first_point += static_cast<int>(points_.size());
      facet.first_under += static_cast<int>(under_.size());
    }
    for (const int count : lists.facets_of_cell) facet_begin_.push_back(facet_begin_.back() + count);
    append(lists.facets, facets_);
    append(lists.points, points_);
    append(lists.under, under_);
  }
}

}  // namespace cgcontact
