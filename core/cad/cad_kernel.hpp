/// Interface to OpenCASCADE, in a module of its own, loaded with the first CAD file: OpenCASCADE's libraries take time
/// and memory, and few scenes need them.
#pragma once

#include "core/base/process/packing.hpp"
#include "core/cad/cad_model.hpp"

namespace cgcontact {

/// Functions of CadModel and read_cad that need OpenCASCADE, which may crash or never end on a damaged file: those that
/// look at a file are called in a child process (cad_loader.cpp). Solids and triangles come from there as bytes.
struct CadKernel {
  double (*volume)(const CadModel& model);
  double (*area)(const CadModel& model);
  std::pair<Vec3, Vec3> (*box)(const CadModel& model);
  std::vector<double> (*distances)(const CadModel& model, const std::vector<int>& faces, const Vec3& x);
  void (*pack_triangles)(const CadModel& model, double deflection, Packing& packing);
  CurvedTriangles (*unpack_triangles)(const CadModel& model, const std::vector<char>& bytes);
  CadModel (*combine)(CadModel::Operation operation, const CadModel& a, const Similarity& placement_a,
                      const CadModel& b, const Similarity& placement_b);
  CadModel (*inner_side)(const Surface& surface, const Vec3& centre, double radius);
  CadModel (*revolved)(const std::vector<ProfileEdge>& profile, const ProfileFrame& frame);
  /// Lines in no order.
  std::vector<CadModel::SectionEdge> (*section)(const CadModel& model, const ProfileFrame& frame);
  std::vector<CadSolid> (*read)(const std::string& file, const CadReading& reading);
  void (*pack_solids)(const std::vector<CadSolid>& solids, Packing& packing);
  std::vector<CadSolid> (*unpack_solids)(const std::vector<char>& bytes);
};

/// The name of the module's function that returns its kernel.
constexpr const char* cad_kernel_function = "cgcontact_cad_kernel";

}  // namespace cgcontact
