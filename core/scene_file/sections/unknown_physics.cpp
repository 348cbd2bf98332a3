#include "core/scene_file/sections/unknown_physics.hpp"

#include <algorithm>
#include <cctype>
#include <vector>

namespace cgcontact {

namespace {

struct PhysicsEntry {
  const char* sentence;
  std::vector<const char*> words;      ///< the whole key
  std::vector<const char*> fragments;  ///< anywhere in it
};

const std::vector<PhysicsEntry>& entries() {
  static const std::vector<PhysicsEntry> all{
      {"friction is one of a contact pair: friction of the [[contact]], a number from 0 to 2",
       {"mu", "mus", "muk", "mud", "cof"},
       {"friction", "coulomb", "stickslip"}},
      {"there is no cohesion: contact carries pressure only and opens without resistance; bodies that hold together "
       "are one body (a union of shapes)",
       {"tie", "tied", "glue", "glued", "weld", "bond"},
       {"cohesi", "adhesi", "bonded"}},
      {"a force is a load of a face: [[load]] with face, force = [x, y, z] in N and, if not at its centroid, at = [x, "
       "y, "
       "z]; there are no forces on points or nodes",
       {"force", "forces", "pointload", "pointforce", "nodalforce", "fx", "fy", "fz", "cload"},
       {"resultantforce", "totalforce"}},
      {"a bolt is tightened by a contact pair: preload in N of the [[contact]]",
       {"pretension", "clampforce"},
       {"bolt"}},
      {"a moment is a load of a face: [[load]] with face and moment = [x, y, z] in N m",
       {"moment", "moments", "torque", "mx", "my", "mz", "couple"},
       {"moment", "torque"}},
      {"the density is one of the material: material.density, kg/m^3", {"rho"}, {"density"}},
      {"gravity is one for the whole scene: gravity = [0, 0, -9.81] in m/s^2 at the top of the file, with a density in "
       "every material",
       {"g", "dload"},
       {"gravity", "acceleration", "selfweight"}},
      {"a change of temperature is one of a body: temperature in K of the [[body]]",
       {"cte", "dt"},
       {"temperature", "thermal"}},
      {"the coefficient of thermal expansion is one of the material: material.expansion, 1/K", {}, {"expansion"}},
      {"there is no plasticity: materials are linear elastic, E and nu; compare the von Mises stress with the yield "
       "stress",
       {"sigmay", "sy", "re", "rp02", "creep"},
       {"plastic", "hardening", "damage", "viscos"}},
      {"the yield stress is one of the material: material.yield, Pa", {}, {"yield"}},
      {"there is no dynamics: the result is the static equilibrium",
       {"velocity", "mass", "dynamic", "dynamics", "frequency"},
       {"damping", "inertia"}},
      {"springs are supports of a face: [[support]] with stiffness in N/m^3 of its area, or spring in N/m of the whole "
       "face",
       {"k", "spring", "springs"},
       {"springstiffness", "elasticfoundation"}},
      {"a face that is held in all directions has displacement = {x = 0, y = 0, z = 0}",
       {"fix", "clamp", "encastre"},
       {"fixed", "clamped"}},
      {"materials are isotropic: E and nu are all there is",
       {"ex", "ey", "ez", "gxy", "gxz", "gyz", "nuxy", "orthotropic", "anisotropic"},
       {"orthotrop", "anisotrop"}},
      {"the shear modulus follows from E and nu: G = E/(2(1+nu))", {"shearmodulus"}, {}},
  };
  return all;
}

}  // namespace

std::string unknown_physics(const std::string& key) {
  std::string word;
  for (const char c : key)
    if (c != '_' && c != '-') word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto is_word = [&](const char* other) { return word == other; };
  const auto is_within = [&](const char* fragment) { return word.find(fragment) != std::string::npos; };
  for (const PhysicsEntry& entry : entries())
    if (std::any_of(entry.words.begin(), entry.words.end(), is_word) ||
        std::any_of(entry.fragments.begin(), entry.fragments.end(), is_within))
      return entry.sentence;
  return "";
}

}  // namespace cgcontact
