/// Way into the module with OpenCASCADE.
#include "core/cad/cad_kernel.hpp"
#include "core/cad/cad_shape.hpp"

extern "C" const cgcontact::CadKernel* cgcontact_cad_kernel() {
  using namespace cgcontact;
  static const CadKernel kernel{
      [](const CadModel& model) { return model.volume(); },
      [](const CadModel& model) { return model.area(); },
      [](const CadModel& model) { return model.box(); },
      [](const CadModel& model, const std::vector<int>& faces, const Vec3& x) { return model.distances(faces, x); },
      pack_triangles,
      unpack_triangles,
      [](CadModel::Operation operation, const CadModel& a, const Similarity& placement_a, const CadModel& b,
         const Similarity& placement_b) { return CadModel::combine(operation, a, placement_a, b, placement_b); },
      [](const Surface& surface, const Vec3& centre, double radius) {
        return CadModel::inner_side(surface, centre, radius);
      },
      [](const std::vector<ProfileEdge>& profile, const ProfileFrame& frame) {
        return CadModel::revolved(profile, frame);
      },
      section_edges,
      [](const std::string& file, const CadReading& reading) { return read_cad(file, reading); },
      pack_solids,
      unpack_solids};
  return &kernel;
}
