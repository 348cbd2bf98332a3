#include "recovery/constrained/contact_cells.hpp"

#include <algorithm>

#include "core/base/parallel.hpp"

namespace cgcontact {
namespace {

constexpr std::size_t grain = 64;

/// Parts of the depth at which the cells below a point are asked for.
constexpr double depths[] = {0.05, 0.35, 0.65, 0.95};

}  // namespace

ContactCells::ContactCells(const std::vector<RecoveryBody>& bodies, const std::vector<StressIntegrals>& integrals,
                           int index, double depth) {
  const BoundaryData& boundary = *bodies[index].boundary;
  const Mat3& rotation = bodies[index].mesh->cut_cells->grid.rotation;
  const int num_cells = static_cast<int>(bodies[index].mesh->cell_nodes.size());
  row_of_cell_.assign(num_cells, -1);
  std::vector<int> cells;
  for (int cell = 0; cell < num_cells; ++cell)
    if (!boundary.links_of_cell[cell].empty()) {
      row_of_cell_[cell] = static_cast<int>(cells.size());
      cells.push_back(cell);
    }
  pieces_.resize(cells.size());
  parallel_for("cgcontact::contact_cells::sums", cells.size(), grain, [&](std::size_t row) {
    std::vector<ContactPiece>& pieces = pieces_[row];
    for (int l : boundary.links_of_cell[cells[row]]) {
      const ContactLink& link = boundary.links[l];
      auto piece = std::find_if(pieces.begin(), pieces.end(), [&](const auto& p) { return p.pair == link.pair; });
      if (piece == pieces.end()) {
        piece = pieces.insert(piece, ContactPiece());
        piece->pair = link.pair;
        piece->other_body = link.other_body;
        piece->low = piece->high = link.position;
      }
      piece->area += link.weight;
      if (link.active) piece->closed_area += link.weight;
      piece->position += link.weight * link.position;
      piece->other_position += link.weight * link.other_position;
      piece->normal += link.weight * link.normal;
      piece->low = piece->low.cwiseMin(link.position);
      piece->high = piece->high.cwiseMax(link.position);
      const CutCells& other = *bodies[link.other_body].mesh->cut_cells;
      const Vec3 inward = depth * (other.grid.rotation.transpose() * (rotation * link.normal));
      for (const double part : depths) {
        const Vec3 x = link.other_position + part * inward;
        const int c = other.find({static_cast<int>(std::floor(x[0])), static_cast<int>(std::floor(x[1])),
                                  static_cast<int>(std::floor(x[2]))});
        if (c < 0 || (!piece->under.empty() && piece->under.back() == c) || !integrals[link.other_body].hold(c))
          continue;
        piece->under.push_back(c);
      }
    }
    for (ContactPiece& piece : pieces) {
      std::sort(piece.under.begin(), piece.under.end());
      piece.under.erase(std::unique(piece.under.begin(), piece.under.end()), piece.under.end());
    }
  });
}

}  // namespace cgcontact
