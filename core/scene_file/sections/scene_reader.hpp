/// Turns the parsed scene file into a Scene, checking every value. Used by read_scene() only.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/errors/mistakes.hpp"
#include "core/scene/scene.hpp"
#include "core/scene_file/sections/scene_materials.hpp"
#include "core/scene_file/sections/scene_shapes.hpp"
#include "core/scene_file/sections/toml_cursor.hpp"

namespace cgcontact {

class DisplacementField;

/// Values of a table of parameters and those that its text knows already; entries may be expressions of other entries,
/// in any order. `in_file`: values that --set has replaced, with whose units its plain numbers are SI numbers.
Constants read_parameters(const TomlCursor& table, const Constants& in_file = {});

/// Sections and keys at the top of a scene.
const std::vector<std::string>& scene_keys();

/// Reads on behind a mistake as far as what follows does not depend on it, and throws all of them together.
class SceneReader {
 public:
  /// `root`: the whole document; the text's parameters must have been read.
  Scene read(const TomlCursor& root);

 private:
  void read_bodies(const TomlCursor& root);
  void read_plane_strain(const TomlCursor& root);
  void read_axisymmetric(const TomlCursor& root);
  void add_implied_supports();
  void read_body(const TomlCursor& node, const std::optional<SceneMaterials>& materials, bool known_keys);
  void read_faces_of_body(const TomlCursor& node, BodySpec& body, const Shape& shape);
  FaceSpec read_face(const TomlCursor& node, const Shape& shape) const;
  RefineSpec read_refine(const TomlCursor& node, const BodySpec& body, const Shape& shape) const;
  void check_bodies_of_stress(const TomlCursor& node) const;
  void choose_cells_of_rigid_bodies();
  void read_supports(const TomlCursor& root);
  void read_support(const TomlCursor& node);
  void read_displacement_from(const TomlCursor& node, SupportSpec& support);
  void read_loads(const TomlCursor& root);
  void read_load(const TomlCursor& node);
  void read_inertia(const TomlCursor& root);
  void read_contacts(const TomlCursor& root);
  void read_contact(const TomlCursor& node, std::set<std::string>& seen);
  ContactSpec read_pair(const TomlCursor& node) const;
  void read_pair_values(const TomlCursor& node, bool has_pair, ContactSpec& contact);
  void check_preload_of_steps(const TomlCursor& node) const;
  void check_target_of_shear(const TomlCursor& node) const;
  void check_new_pair(const TomlCursor& node, const ContactSpec& contact) const;
  void add_automatic_contacts(const TomlCursor& node);
  void read_settings(const TomlCursor& root);
  void read_probes(const TomlCursor& root);
  ProbeSpec read_probe(const TomlCursor& node) const;
  void find_outside(const TomlCursor& node, ProbeSpec& probe) const;
  void read_sections(const TomlCursor& root);
  SectionSpec read_section(const TomlCursor& node) const;
  FaceRef resolve_face(const TomlCursor& node) const;
  FaceRef resolve_face(const TomlCursor& node, const std::string& reference) const;
  void find_faces_of_targets(const TomlCursor& root);
  int body_index(const std::string& name) const;
  std::vector<std::string> body_names() const;
  std::vector<std::string> face_names(int body) const;

  /// Properties of a body that could not be read: what refers to them follows.
  struct Unread {
    bool name = false, shape = false, faces = false;
  };

  Scene scene_;
  std::vector<Shape> shapes_;   ///< one per body
  std::vector<Unread> unread_;  ///< one per body
  MistakeList mistakes_;
  /// Displacements of earlier results, by directory and body.
  std::map<std::pair<std::string, std::string>, std::shared_ptr<const DisplacementField>> fields_;
};

/// The elements of an optional array of tables at the top.
std::vector<TomlCursor> optional_elements(const TomlCursor& root, const std::string& key);

// Sections without references to bodies' faces (scene_settings.cpp).
std::vector<StepSpec> read_steps(const TomlCursor& node);
/// Factors of one load or support; makes the steps of the scene if it has none yet.
std::vector<double> read_own_steps(const TomlCursor& node, std::vector<StepSpec>& steps);
SolverOptions read_solver(const TomlCursor& node);
RecoveryOptions read_recovery(const TomlCursor& node);
OutputOptions read_output(const TomlCursor& node);
AccuracyOptions read_accuracy(const TomlCursor& node);
/// A relative error: a number, or text with a per cent sign.
double read_target(const TomlCursor& node);

// [reference] (scene_reference.cpp).

/// `contact_force`: value of that name in expressions, N; without one it is not known.
ReferenceSpec read_reference(const TomlCursor& section, const std::vector<std::string>& body_names,
                             std::optional<double> contact_force);
bool uses_contact_force(const TomlCursor& section);

}  // namespace cgcontact
