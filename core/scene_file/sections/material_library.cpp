#include "core/scene_file/sections/material_library.hpp"

#include <optional>

namespace cgcontact {

const std::vector<NamedMaterial>& material_library() {
  constexpr std::nullopt_t none = std::nullopt;
  // name, {E Pa, nu, density kg/m^3, expansion 1/K, yield stress Pa}
  static const std::vector<NamedMaterial> library{
      {"steel", {210e9, 0.3, 7850, 12e-6, none}},
      {"S235", {210e9, 0.3, 7850, 12e-6, 235e6}},
      {"S355", {210e9, 0.3, 7850, 12e-6, 355e6}},
      {"stainless_steel", {200e9, 0.3, 7900, 16e-6, 210e6}},
      {"bearing_steel", {207.9e9, 0.3, none, none, none}},
      {"grey_cast_iron", {110e9, 0.26, 7200, 11.7e-6, none}},
      {"ductile_cast_iron", {169e9, 0.275, 7100, 12.5e-6, 250e6}},
      {"aluminium", {70e9, 0.3, 2700, 23e-6, none}},
      {"aluminium_6082_T6", {70e9, 0.3, 2700, 23e-6, 250e6}},
      {"aluminium_7075_T6", {71.7e9, 0.33, 2810, 23.6e-6, 503e6}},
      {"titanium_Ti6Al4V", {113.8e9, 0.342, 4430, 8.6e-6, 880e6}},
      {"copper", {117e9, 0.34, 8940, 17e-6, none}},
      {"brass", {97e9, 0.34, 8470, 20.9e-6, none}},
      {"nickel_718", {200e9, 0.294, 8220, 13.2e-6, 1034e6}},
      {"concrete_C30", {33e9, 0.2, 2400, 10e-6, none}},
      {"glass", {70e9, 0.2, 2500, 9e-6, none}},
  };
  return library;
}

}  // namespace cgcontact
