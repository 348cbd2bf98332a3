#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/base/errors/errors.hpp"
#include "core/bodies/booleans.hpp"
#include "core/bodies/triangle_body.hpp"
#include "core/triangles/triangle_arrangement.hpp"
#include "core/triangles/triangle_checks.hpp"
#include "core/triangles/triangle_faces.hpp"

namespace cgcontact {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using FaceNumbers = Mesh::Property_map<Mesh::Face_index, int>;

/// Number of the faces that bound a half-space or an endless cylinder far away.
constexpr int far_away = -1;

/// Points of a triangle surface nearer than this to a plane of the other operand are put on it (relative to the size),
/// so that faces coincide as meant.
constexpr double on_plane = 1e-9;

constexpr double facet_length_in_cells = 0.5, facet_error_in_cells = 1e-3;
constexpr int max_facets_around = 20000, max_divisions = 7;  // of an icosahedron: 327680 facets

/// A closed surface; every face carries a number: of its name, or far_away.
struct Operand {
  Mesh mesh;

  explicit Operand(std::size_t points = 0, std::size_t triangles = 0) {
    mesh.reserve(points, 3 * triangles / 2, triangles);
    mesh.add_property_map<Mesh::Face_index, int>("f:number", far_away);
  }
  /// Asked for anew: it does not move with the mesh.
  FaceNumbers numbers() const { return mesh.property_map<Mesh::Face_index, int>("f:number").first; }
  Mesh::Vertex_index add(const Vec3& x) { return mesh.add_vertex(Kernel::Point_3(x[0], x[1], x[2])); }
  void add(Mesh::Vertex_index a, Mesh::Vertex_index b, Mesh::Vertex_index c, int number) {
    const Mesh::Face_index added = mesh.add_face(a, b, c);
    if (added == Mesh::null_face())
      throw InputError(std::string("the triangle surface touches itself in a point or along an edge"));
    numbers()[added] = number;
  }
};

/// Hands the numbers of the faces on to their fragments and copies.
struct KeepNumbers : pmp::Corefinement::Default_visitor<Mesh> {
  std::map<const Mesh*, FaceNumbers>* numbers;
  int divided = far_away;
  explicit KeepNumbers(std::map<const Mesh*, FaceNumbers>& all) : numbers(&all) {}
  void before_subface_creations(Mesh::Face_index face, Mesh& mesh) { divided = numbers->at(&mesh)[face]; }
  void after_subface_created(Mesh::Face_index face, Mesh& mesh) { numbers->at(&mesh)[face] = divided; }
  void after_face_copy(Mesh::Face_index from, const Mesh& source, Mesh::Face_index to, Mesh& target) {
    numbers->at(&target)[to] = numbers->at(&source)[from];
  }
};

Operand combine(BooleanOp::Kind op, Operand& a, Operand& b) {
  const bool a_empty = a.mesh.is_empty(), b_empty = b.mesh.is_empty();
  if (a_empty || b_empty) {
    if (op == BooleanOp::Kind::unite) return a_empty ? std::move(b) : std::move(a);
    return op == BooleanOp::Kind::subtract ? std::move(a) : Operand();
  }
  Operand result;
  std::map<const Mesh*, FaceNumbers> numbers{
      {&a.mesh, a.numbers()}, {&b.mesh, b.numbers()}, {&result.mesh, result.numbers()}};
  const auto parameters = CGAL::parameters::visitor(KeepNumbers(numbers));
  const bool manifold = op == BooleanOp::Kind::unite
                            ? pmp::corefine_and_compute_union(a.mesh, b.mesh, result.mesh, parameters)
                        : op == BooleanOp::Kind::intersect
                            ? pmp::corefine_and_compute_intersection(a.mesh, b.mesh, result.mesh, parameters)
                            : pmp::corefine_and_compute_difference(a.mesh, b.mesh, result.mesh, parameters);
  if (!manifold)
    throw InputError(std::string("the shapes touch along an edge or in a point: the result bounds no body"));
  return result;
}

/// Directions that are those of the axes up to rounding are made so: such planes and points on them are exact.
std::vector<Surface> along_axes(std::vector<Surface> surfaces) {
  for (Surface& surface : surfaces)
    for (int i = 0; i < 3; ++i)
      if (std::abs(surface.direction[i]) > 1 - 1e-12)
        surface.direction = std::copysign(1.0, surface.direction[i]) * Vec3::Unit(i);
  return surfaces;
}

/// Axes, by rows, along the first planes of a solid that are at right angles: there the faces of a box are exact,
/// however it is turned.
Mat3 axes_of(const Solid& solid) {
  const Vec3* first = nullptr;
  for (const Surface& surface : solid.surfaces()) {
    if (surface.kind != Surface::Kind::plane) continue;
    if (!first) first = &surface.direction;
    if (std::abs(first->dot(surface.direction)) > 1e-12) continue;
    Mat3 axes;
    axes << first->transpose(), surface.direction.transpose(), first->cross(surface.direction).transpose();
    return axes;
  }
  return Mat3::Identity();
}

/// The ball that everything of interest is in.
struct BoundingBall {
  Vec3 centre;
  double radius;
};

/// Turns solids into triangles; collects the names of their faces.
class Faceting {
 public:
  Faceting(const BoundingBall& around, double cell_size) : ball_(around), cell_size_(cell_size) {}

  Operand operand(const Solid& solid, const std::vector<Surface>& planes_of_other) {
    if (const TriangleSurface* triangles = as_triangles(solid))
      return of_triangles(*triangles, along_axes(planes_of_other));
    if (const CsgBody* csg = as_csg(solid)) return of_expression(*csg);
    throw InputError(std::string("bodies of this kind cannot be combined with others"));
  }
  const std::vector<std::string>& names() const { return names_; }
  double error() const { return error_; }

 private:
  int new_face(const std::string& name) {
    names_.push_back(name);
    return static_cast<int>(names_.size()) - 1;
  }

  Operand of_triangles(const TriangleSurface& surface, const std::vector<Surface>& planes) {
    const int first = static_cast<int>(names_.size());
    names_.insert(names_.end(), surface.face_names().begin(), surface.face_names().end());
    Operand result(surface.points().size(), surface.triangles().size());
    std::vector<Mesh::Vertex_index> vertex;
    for (Vec3 x : surface.points()) {
      for (const Surface& plane : planes)
        if (plane.kind == Surface::Kind::plane && std::abs(plane.signed_distance(x)) < on_plane * ball_.radius)
          x -= plane.signed_distance(x) * plane.direction;
      vertex.push_back(result.add(x));
    }
    for (std::size_t t = 0; t < surface.triangles().size(); ++t) {
      const Triangle& c = surface.triangles()[t];
      result.add(vertex[c[0]], vertex[c[1]], vertex[c[2]], first + surface.patch(static_cast<int>(t)));
    }
    return result;
  }

  /// Boolean expression of elementary surfaces.
  Operand of_expression(const CsgBody& solid) {
    const std::vector<Surface> surfaces = along_axes(solid.surfaces());
    std::vector<int> face;
    const auto named =
        std::find_if(surfaces.begin(), surfaces.end(), [](const Surface& s) { return !s.names.empty(); });
    if (named == surfaces.end()) throw InputError(std::string("one of the shapes is empty"));
    const int first = new_face(named->names[0]);
    // Surfaces without a name bound nothing: what is left of them is rounding.
    for (auto s = surfaces.begin(); s != surfaces.end(); ++s)
      face.push_back(s == named || s->names.empty() ? first : new_face(s->names[0]));
    std::vector<Operand> stack;
    for (const BooleanOp& op : solid.expression()) {
      switch (op.kind) {
        case BooleanOp::Kind::surface:
          stack.push_back(inner_side(surfaces[op.surface], face[op.surface]));
          break;
        case BooleanOp::Kind::complement_surface: {
          Operand all = everything(), inside = inner_side(surfaces[op.surface], face[op.surface]);
          stack.push_back(combine(BooleanOp::Kind::subtract, all, inside));
          break;
        }
        case BooleanOp::Kind::empty:
          stack.emplace_back();
          break;
        default: {
          Operand b = std::move(stack.back());
          stack.pop_back();
          stack.back() = combine(op.kind, stack.back(), b);
        }
      }
    }
    return std::move(stack.back());
  }

  Operand inner_side(const Surface& surface, int face) {
    switch (surface.kind) {
      case Surface::Kind::plane:
        return half_space(surface, face);
      case Surface::Kind::sphere:
        return ball(surface, face);
      case Surface::Kind::cone:
        return half_cone(surface, face);
      default:
        return endless_cylinder(surface, face);
    }
  }

  /// A box below a rectangle, the number of whose face is given: corners centre +- a +- b, and so far down.
  static Operand box_below(const Vec3& centre, const Vec3& a, const Vec3& b, const Vec3& down, int face) {
    Operand box(8, 12);
    std::vector<Mesh::Vertex_index> corner;
    for (int i = 0; i < 8; ++i) {
      const Vec3 x = centre + (i & 1 ? a : Vec3(-a)) + (i & 2 ? b : Vec3(-b));
      corner.push_back(box.add(i & 4 ? x : Vec3(x + down)));
    }
    constexpr int sides[6][4] = {{4, 5, 7, 6}, {0, 2, 3, 1}, {0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}};
    for (int s = 0; s < 6; ++s)
      for (int k = 0; k < 2; ++k)
        box.add(corner[sides[s][0]], corner[sides[s][1 + k]], corner[sides[s][2 + k]], s == 0 ? face : far_away);
    return box;
  }

  Operand everything() const {
    const double r = 4 * ball_.radius;
    return box_below(ball_.centre + r * Vec3::UnitZ(), r * Vec3::UnitX(), r * Vec3::UnitY(), -2 * r * Vec3::UnitZ(),
                     far_away);
  }

  /// Unit vectors t, n x t across a direction; exact for directions along the axes, so that planes stay where they are.
  static std::pair<Vec3, Vec3> across(const Vec3& n) {
    int least = 0;
    n.cwiseAbs().minCoeff(&least);
    const Vec3 t = Vec3::Unit(least).cross(n).normalized();
    return {t, n.cross(t)};
  }

  Operand half_space(const Surface& plane, int face) const {
    const double distance = plane.signed_distance(ball_.centre), length = 2 * (ball_.radius + std::abs(distance));
    const auto [t1, t2] = across(plane.direction);
    // The foot on the plane, beside the centre; along an axis the coordinate of the plane itself.
    Vec3 foot = ball_.centre - distance * plane.direction;
    for (int i = 0; i < 3; ++i)
      if (std::abs(plane.direction[i]) == 1) foot[i] = plane.point[i];
    return box_below(foot, length * t1, length * t2, -2 * length * plane.direction, face);
  }

  /// Edge length of facets on a surface of this radius: the sagitta is length^2 / (8 radius).
  double facet_length(double radius) const {
    return std::min(facet_length_in_cells * cell_size_, std::sqrt(8 * radius * facet_error_in_cells * cell_size_));
  }

  Operand endless_cylinder(const Surface& cylinder, int face) {
    const Vec3& axis = cylinder.direction;
    const Vec3 foot = cylinder.point + axis.dot(ball_.centre - cylinder.point) * axis;
    const double length = 2 * ball_.radius;
    return round_bar(foot - length * axis, foot + length * axis, axis, cylinder.radius, cylinder.radius, face);
  }

  /// Makes the half of a cone that bodies have, as far as it is of interest.
  Operand half_cone(const Surface& cone, int face) {
    const double middle = height(cone, ball_.centre), length = 2 * ball_.radius;
    if (middle + length <= 0) return Operand();
    const double low = std::max(0.0, middle - length), high = middle + length, slope = cone.sine / cone.cosine;
    return round_bar(cone.point + low * cone.direction, cone.point + high * cone.direction, cone.direction, low * slope,
                     high * slope, face);
  }

  /// Facets around an axis between two radii, the first one possibly 0, with ends far away.
  Operand round_bar(const Vec3& begin, const Vec3& end, const Vec3& axis, double first, double second, int face) {
    const int around = static_cast<int>(
        std::clamp(std::ceil(2 * pi * second / facet_length(second)), 32.0, double(max_facets_around)));
    error_ = std::max(error_, second * (1 - std::cos(pi / around)));
    const auto [t1, t2] = across(axis);
    Operand bar(2 * around + 2, 4 * around);
    const Mesh::Vertex_index ends[2] = {bar.add(begin), bar.add(end)};
    std::vector<Mesh::Vertex_index> rim[2];
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * pi * i / around;
      const Vec3 radial = std::cos(angle) * t1 + std::sin(angle) * t2;
      if (first > 0) rim[0].push_back(bar.add(begin + first * radial));
      rim[1].push_back(bar.add(end + second * radial));
    }
    for (int i = 0; i < around; ++i) {
      const int j = (i + 1) % around;
      if (first > 0) {
        bar.add(rim[0][i], rim[0][j], rim[1][j], face);
        bar.add(rim[0][i], rim[1][j], rim[1][i], face);
        bar.add(ends[0], rim[0][j], rim[0][i], far_away);
      } else {
        bar.add(ends[0], rim[1][j], rim[1][i], face);
      }
      bar.add(ends[1], rim[1][i], rim[1][j], far_away);
    }
    return bar;
  }

  /// An icosahedron whose triangles are divided in four, again and again, the new corners put on the sphere.
  Operand ball(const Surface& sphere, int face) {
    const double golden = (1 + std::sqrt(5.0)) / 2;
    std::vector<Vec3> points;
    for (const double a : {-1.0, 1.0})
      for (const double b : {-golden, golden}) {
        points.emplace_back(0, a, b);
        points.emplace_back(a, b, 0);
        points.emplace_back(b, 0, a);
      }
    for (Vec3& x : points) x.normalize();
    const double edge = 2 / std::sqrt(1 + golden * golden) * 1.001;  // of the unit icosahedron
    std::vector<Triangle> triangles;
    for (int i = 0; i < 12; ++i)
      for (int j = i + 1; j < 12; ++j)
        for (int k = j + 1; k < 12; ++k) {
          const Vec3 &a = points[i], &b = points[j], &c = points[k];
          if ((a - b).norm() > edge || (b - c).norm() > edge || (c - a).norm() > edge) continue;
          triangles.push_back((b - a).cross(c - a).dot(a) > 0 ? Triangle{i, j, k} : Triangle{i, k, j});
        }
    double length = edge * sphere.radius;
    for (int division = 0; division < 2 || (length > facet_length(sphere.radius) && division < max_divisions);
         ++division) {
      std::map<std::pair<int, int>, int> middles;
      const auto middle = [&](int i, int j) {
        const auto [entry, is_new] = middles.try_emplace(std::minmax(i, j), static_cast<int>(points.size()));
        if (is_new) points.push_back((points[i] + points[j]).normalized());
        return entry->second;
      };
      std::vector<Triangle> finer;
      for (const auto& [a, b, c] : triangles) {
        const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        for (const Triangle& t : {Triangle{a, ab, ca}, Triangle{ab, b, bc}, Triangle{ca, bc, c}, Triangle{ab, bc, ca}})
          finer.push_back(t);
      }
      triangles = std::move(finer);
      length /= 2;
    }
    Operand result(points.size(), triangles.size());
    std::vector<Mesh::Vertex_index> vertex;
    for (const Vec3& x : points) vertex.push_back(result.add(sphere.point + sphere.radius * x));
    for (const auto& [a, b, c] : triangles) {
      const double height = std::abs((points[b] - points[a]).cross(points[c] - points[a]).normalized().dot(points[a]));
      error_ = std::max(error_, sphere.radius * (1 - height));
      result.add(vertex[a], vertex[b], vertex[c], face);
    }
    return result;
  }

  BoundingBall ball_;
  double cell_size_;
  std::vector<std::string> names_;
  double error_ = 0;
};

/// The surface in double precision, checked like one from a file.
Solid to_solid(const Operand& result, const std::vector<std::string>& names) {
  TriangleSoup soup;
  std::vector<int> point_of(result.mesh.num_vertices());
  for (const Mesh::Vertex_index v : result.mesh.vertices()) {
    const Kernel::Point_3& x = result.mesh.point(v);
    point_of[v] = static_cast<int>(soup.points.size());
    soup.points.emplace_back(CGAL::to_double(x.x()), CGAL::to_double(x.y()), CGAL::to_double(x.z()));
  }
  const FaceNumbers numbers = result.numbers();
  std::vector<int> face;
  for (const Mesh::Face_index f : result.mesh.faces()) {
    Triangle triangle;
    int k = 0;
    for (const Mesh::Vertex_index v : result.mesh.vertices_around_face(result.mesh.halfedge(f)))
      triangle[k++] = point_of[v];
    soup.triangles.push_back(triangle);
    soup.number.push_back(static_cast<int>(face.size()) + 1);
    face.push_back(numbers[f]);
    if (face.back() == far_away) throw InputError(std::string("the result is unbounded: a half-space is part of it"));
  }
  if (face.empty())
    throw InputError(std::string("the result is empty: the shapes do not overlap, or one holds the other"));
  std::vector<int> all(soup.points.size());
  std::iota(all.begin(), all.end(), 0);
  soup.merge(std::move(all), rounding_distance * soup.diagonal());
  repair_and_check(soup, "the combined surface");
  NamedTriangles faces;
  faces.names = names;
  for (const int number : soup.number) faces.face.push_back(face[number - 1]);
  // Patches of the operands are smooth: no further creases.
  return Solid::bounded_by(make_surface(soup, faces, pi));
}

BoundingBall ball_around(const Solid& a, const Solid& b) {
  const auto [low, high] = box_around(a, b);
  return {0.5 * (low + high), (high - low).norm()};
}

}  // namespace

TriangleBoolean combine_triangles(BooleanOp::Kind op, const Solid& a, const Solid& b, double cell_size) {
  const Mat3 axes = axes_of(as_triangles(a) ? b : a), back = axes.transpose();
  const Solid turned_a = a.transformed(axes, Vec3::Zero()), turned_b = b.transformed(axes, Vec3::Zero());
  Faceting faceting(ball_around(turned_a, turned_b), cell_size);
  Operand first = faceting.operand(turned_a, turned_b.surfaces()),
          second = faceting.operand(turned_b, turned_a.surfaces());
  const Solid result = to_solid(combine(op, first, second), faceting.names());
  return {axes == Mat3::Identity() ? result : result.transformed(back, Vec3::Zero()), faceting.error()};
}

}  // namespace cgcontact
