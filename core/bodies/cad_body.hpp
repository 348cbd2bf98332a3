/// Bodies from CAD files: bounded by the exact surfaces of a CadModel. Triangles close to them decide what is inside
/// and where to search on the surface; all measures are those of the surface.
#pragma once

#include <limits>
#include <memory>
#include <optional>

#include "core/bodies/csg_body.hpp"
#include "core/cad/cad_model.hpp"
#include "core/geometry/solid.hpp"
#include "core/triangles/triangle_surface.hpp"

namespace cgcontact {

/// Triangles with what they stand for, in the same coordinates.
struct CadSurface {
  CurvedTriangles curved;
  TriangleSurface flat;  ///< patches are the faces
  double sag = 0;        ///< the largest distance between both, where triangles are wanted

  /// `sag` is that of the triangles that are wanted.
  CadSurface(CurvedTriangles triangles, const std::vector<std::string>& names,
             const CurvedTriangles::Wanted& wanted = {});
};

class CadBody final : public BodyGeometry {
 public:
  /// Makes the body in the model's own position, scaled (m per mm). `cell_size` (m): the triangles are within a
  /// hundredth of it of the surface. Throws InputError.
  CadBody(const CadModel& model, double scale, double cell_size);

  const CadModel& model() const { return model_; }
  const Similarity& placement() const { return surface_->curved.placement; }
  const CadSurface& surface() const { return *surface_; }

  std::shared_ptr<const BodyGeometry> transformed(const Mat3& rotation, const Vec3& translation,
                                                  double scale) const override;
  std::shared_ptr<const BodyGeometry> on_level(int level, const CellTree& tree) const override;
  /// Throws InputError: not possible.
  std::shared_ptr<const BodyGeometry> stretched(int axis, double factor, double shift) const override;
  bool bounding_box(Vec3& min, Vec3& max) const override;
  bool contains(const Vec3& x) const override { return signed_distance(x) <= 0; }
  double distance_to_surfaces(const Vec3& x) const override { return std::abs(signed_distance(x)); }
  int surface_at(const Vec3& x, const Vec3& n) const override {
    return surface_->flat.patch(surface_->flat.nearest_facing(x, n));
  }
  void crossings(const Vec3& x, const Vec3& d, double reach, std::vector<Crossing>& found) const override;

  std::unique_ptr<CellSweep> sweep_cells(const Grid& grid, const std::vector<Plane>& dividers, int order,
                                         const LeafLevel& leaves) const override;
  void boundary_points(const Index3& cell, const std::vector<char>& selected, const std::vector<Plane>& dividers,
                       int order, int owner, BoundaryPoints& points) const override;
  CellEstimate estimate_cells(const Grid& grid, double max_cells) const override;

  std::size_t num_facets() const override { return surface_->flat.triangles().size(); }
  std::vector<int> surfaces_near(const Vec3& centre, double half_size, double slack,
                                 const std::vector<int>& candidates) const override;
  double signed_distance(const Vec3& x) const override;
  void each_facet_in_cell(const UseFacet& use) const override;

 private:
  CadBody(const CadModel& model, std::shared_ptr<const CadSurface> surface);
  void set_surfaces();

  static constexpr int max_index = std::numeric_limits<int>::max();

  CadModel model_;
  std::shared_ptr<const CadSurface> surface_;
  /// Cells that may be leaves of a level, with those around that give them their boundary: all that facets are cut for.
  Index3 first_cell_{-max_index, -max_index, -max_index}, last_cell_{max_index, max_index, max_index};
};

/// Returns nullptr for bodies of another kind.
const CadBody* as_cad(const Solid& solid);

/// Computes a op b of two bodies of which at least one is a CAD body and the other one too, or an expression of
/// surfaces; nullopt if one is bounded by triangles. Throws InputError.
std::optional<Solid> combine_cad(BooleanOp::Kind op, const Solid& a, const Solid& b, double cell_size);

}  // namespace cgcontact
