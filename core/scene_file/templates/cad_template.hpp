/// Scene of all solids of a CAD file, for `cgcontact init`.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/cad/cad_model.hpp"
#include "core/geometry/solid.hpp"
#include "core/scene_file/templates/part_outline.hpp"
#include "core/scene_file/templates/scene_template.hpp"

namespace cgcontact {

class CadTemplate {
 public:
  /// Reads the file; `source` is its name as the scene has it. Throws InputError.
  CadTemplate(const InitOptions& options, const std::string& source);

  /// The only solid of the file as a part of a scene.
  struct Single {
    std::string shape;  ///< lines for [body.shape]
    PartOutline outline;
  };
  std::optional<Single> single() const;

  /// Returns a scene: each solid is a body, solids that touch or nearly touch are contact pairs, what touches nothing
  /// is held; what the file does not say is marked TODO. `file`: the scene; `state`: whether it runs. Appends remarks
  /// for the user to `told`.
  std::string scene(const std::string& file, const std::string& state, std::string& told) const;

  /// Returns lines that say what was repaired and what was left out, or nothing.
  std::string remarks() const;

 private:
  struct Part {
    std::string name;
    const CadSolid* solid;
    Solid body;
    double cell_size;
    Vec3 min, max;
    std::set<int> touching;  ///< faces (from 0) that touch or nearly touch another solid
    std::string declared;    ///< lines that declare them
  };
  /// A face that holds the bodies.
  struct Held {
    std::size_t part = 0;
    int face = -1;  ///< -1: the whole surface
  };

  void add_parts();
  void add_contacts();
  Held find_held(std::size_t largest) const;
  std::string cad_line(const CadSolid& solid) const;

  InitOptions options_;
  std::string source_;
  bool without_unit_;
  double scale_;
  std::vector<CadSolid> solids_;
  std::vector<Part> parts_;
  std::string contacts_;
  int pairs_ = 0;
};

}  // namespace cgcontact
