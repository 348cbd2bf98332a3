/// In the place of OpenCASCADE where the program is built without it (-DCGCONTACT_CAD=OFF).
#include "core/base/errors.hpp"
#include "core/cad/cad_model.hpp"

namespace cgcontact {

namespace {

[[noreturn]] void refuse() {
  throw InputError(
      std::string("this program was built without OpenCASCADE and reads no CAD files (allowed: a build with "
                  "-DCGCONTACT_CAD=ON and libocct-data-exchange-dev, or a triangle surface: mesh = {...})"));
}

}  // namespace

struct CadModel::Shape {};

bool can_read_cad() { return false; }
double CadModel::volume() const { refuse(); }
double CadModel::area() const { refuse(); }
std::pair<Vec3, Vec3> CadModel::box() const { refuse(); }
double CadModel::distance(int, const Vec3&) const { refuse(); }
CurvedTriangles CadModel::triangles(double) const { refuse(); }
CadModel CadModel::combine(Operation, const CadModel&, const Similarity&, const CadModel&, const Similarity&) {
  refuse();
}
CadModel CadModel::inner_side(const Surface&, const Vec3&, double) { refuse(); }
std::vector<CadSolid> read_cad(const std::string&, const CadReading&) { refuse(); }

}  // namespace cgcontact
