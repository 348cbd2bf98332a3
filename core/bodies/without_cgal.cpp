// Replaces what needs CGAL (CGCONTACT_CGAL=OFF).
#include "core/base/errors/errors.hpp"
#include "core/bodies/booleans.hpp"
#include "core/triangles/triangle_repair.hpp"

namespace cgcontact {
namespace {

const char* const lacking = "this program was built without CGAL: it ";
const char* const allowed = " (allowed: a build with -DCGCONTACT_CGAL=ON and libcgal-dev";

}  // namespace

TriangleBoolean combine_triangles(BooleanOp::Kind, const Solid&, const Solid&, double) {
  throw InputError(std::string(lacking) + "has no boolean operations on triangle surfaces" + allowed +
                   ", or a surface that is cut already)");
}

SurfaceRepair repair_surface(TriangleSoup&, const std::string& file) {
  throw InputError(file + ": " + lacking + "repairs no surfaces" + allowed + ", or a surface that bounds a body)");
}

}  // namespace cgcontact
