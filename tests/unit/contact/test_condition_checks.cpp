/// Conditions that contradict each other: supports among themselves, supports, loads and contact on the same faces,
/// supports that would deform a rigid body.
#include <gtest/gtest.h>

#include "contact/checks/condition_checks.hpp"
#include "contact/checks/rigid_supports.hpp"
#include "contact/preparation.hpp"
#include "core/scene_file/read_scene.hpp"
#include "tests/support/input_errors.hpp"
#include "tests/support/scene_text.hpp"

namespace cgcontact::test_condition_checks {
namespace {

using test::support_text;

/// What the check of a scene's conditions says.
std::string refusal(const std::string& text) {
  const Scene scene = parse_scene(text, "scene.toml");
  const Preparation p = discretise(scene);
  return message_of([&] { check_conditions(scene, p.bodies, p.pairs); });
}

std::string block(const std::string& more) {
  return test::box_text("block", "[0, 0, 0]", "[0.5, 0.4, 0.6]", 0.23, test::turned_grid) + more;
}

/// The normal of z- points down: values along it have the other sign than those along z.
TEST(Supports, PrescribeOneDisplacementForEveryDirection) {
  const auto both = [](const std::string& first, const std::string& second) {
    return refusal(block(support_text("block.z-", first) + support_text("block.z-", second)));
  };
  EXPECT_EQ(both("displacement = {z = 2e-6}", "displacement = {normal = -2e-6}"), "");
  EXPECT_EQ(both("displacement = {z = \"1e-3*x\"}", "displacement = {z = \"x/1000\"}"), "");
  EXPECT_EQ(both("displacement = {z = 2e-6}", "displacement = {x = 1e-6, y = 3e-6}"), "");
  EXPECT_EQ(both("displacement = {z = 2e-6}", "stiffness = 1e9"), "") << "springs agree with everything";
  expect_contains(both("displacement = {z = 2e-6}", "displacement = {normal = 2e-6}"),
                  {"support[1]: prescribes 2e-06 m where the support of \"block.z-\" prescribes -2e-06 m in the same "
                   "direction, at (",
                   "one displacement for every point and direction"});
  expect_contains(both("symmetry = true", "displacement = {x = 0, z = 1e-6}"),
                  {"prescribes 1e-06 m", "prescribes 0 m in the same direction"});
  expect_contains(both("displacement = {z = \"1e-3*x\"}", "displacement = {z = \"1.001e-3*x\"}"), {"support[1]"});
}

/// A component and the normal of one support are the same direction on a plane across it, and only there.
TEST(Supports, AgreeWithThemselves) {
  EXPECT_EQ(refusal(block(support_text("block.z-", "displacement = {x = 0, y = 0, z = 1e-6, normal = -1e-6}"))), "");
  EXPECT_EQ(refusal(block(support_text("block.y-", "displacement = {x = 0, z = 1e-6, normal = 2e-6}"))), "");
  expect_contains(refusal(block(support_text("block.z-", "displacement = {x = 0, z = 1e-6, normal = 1e-6}"))),
                  {"support[0]: prescribes 1e-06 m where the support of \"block.z-\" prescribes -1e-06 m"});
}

/// Faces that meet at an edge only share no point.
TEST(Supports, OfFacesThatMeetAtAnEdgeShareNothing) {
  EXPECT_EQ(refusal(block(support_text("block.z-", "displacement = {x = 1e-6, y = 0, z = 0}") +
                          support_text("block.x-", "displacement = {x = 2e-6, y = 1e-6, z = 3e-6}"))),
            "");
}

/// Two blocks that touch on 0.5 x 0.4 m, the lower one held at its foot. `faces`: declared in the lower one.
std::string two_blocks(const std::string& faces, const std::string& more) {
  return test::box_text("lower", "[0, 0, 0]", "[0.5, 0.4, 0.6]", 0.23, test::turned_grid + faces) +
         test::box_text("upper", "[0, 0, 0.6]", "[0.5, 0.4, 1.3]", 0.21, "grid = {offset = [0.3, 0.6, 0.2]}\n") +
         support_text("lower.z-", "displacement = {x = 0, y = 0, z = 0}") + more;
}
const std::string contact = test::contact_text("lower.z+", "upper.z-"), bond = contact + "bonded = true\n";

/// Declares the part of the top of the lower block between two x.
std::string part(const std::string& name, double low, double high) {
  return "{name = \"" + name + "\", surfaces = [\"z+\"], box = {min = [" + std::to_string(low) + ", -1, -1], max = [" +
         std::to_string(high) + ", 1, 2]}}";
}
std::string strip(double width) { return "faces = [" + part("strip", -1, width) + "]\n"; }

/// A hundredth of the face is the rim that is let pass; facets are cut where the strip ends, so that its area is exact.
TEST(ContactFaces, AreHeldAlongTheirNormalOnTheirRimAtMost) {
  const std::string held = support_text("lower.strip", "displacement = {z = 0}");
  EXPECT_EQ(refusal(two_blocks(strip(0.0045), contact + held)), "");
  expect_contains(refusal(two_blocks(strip(0.0055), contact + held)),
                  {"\"lower.strip\": holds 0.0022 m2 of a face of contact \"lower-upper\" along its normal",
                   "a support or a contact on every part of a face"});
  EXPECT_EQ(refusal(two_blocks(strip(0.25), contact + support_text("lower.strip", "displacement = {x = 0, y = 0}"))),
            "")
      << "along the face";
}

/// Tied faces carry all components.
TEST(ContactFaces, OfBondsAreNeitherHeldNorLoaded) {
  const std::string load = "[[load]]\nface = \"lower.strip\"\npressure = 1e6\n";
  expect_contains(refusal(two_blocks(strip(0.25), bond + support_text("lower.strip", "displacement = {x = 0}"))),
                  {"\"lower.strip\": holds 0.1 m2 of a face of the bonded contact \"lower-upper\": contact cannot"});
  expect_contains(refusal(two_blocks(strip(0.25), bond + load)),
                  {"\"lower.strip\": loads 0.1 m2 of a face of the bonded contact \"lower-upper\"", "not bonded"});
  EXPECT_EQ(refusal(two_blocks(strip(0.0045), bond + load)), "") << "the rim";
  EXPECT_EQ(refusal(two_blocks(strip(0.25), contact + load)), "") << "contact lets a load act";
}

/// Two pairs share what both faces of both have in common; the order of the bodies does not matter.
TEST(ContactFaces, AreInOnePairOnly) {
  const std::string halves =
      "faces = [" + part("low", -1, 0.25) + ", " + part("high", 0.25, 1) + ", " + part("most", 0.1, 1) + "]\n";
  const auto pairs = [&](const std::string& first, const std::string& second) {
    return refusal(two_blocks(halves, "[[contact]]\nname = \"one\"\nfaces = " + first +
                                          "\n[[contact]]\nname = \"two\"\nfaces = " + second + "\n"));
  };
  EXPECT_EQ(pairs("[\"lower.low\", \"upper.z-\"]", "[\"lower.high\", \"upper.z-\"]"), "");
  for (const char* second : {"[\"lower.most\", \"upper.z-\"]", "[\"upper.z-\", \"lower.most\"]"})
    expect_contains(pairs("[\"lower.low\", \"upper.z-\"]", second),
                    {"\"two\": shares 0.06 m2 of its faces with contact \"one\"", "the pressure would act twice"});
}

/// What the check of a rigid body's supports says: a block of 10 x 10 x 5 mm.
std::string rigid_refusal(const std::string& supports, bool rigid = true) {
  const std::string text =
      test::box_text("plate", "[0, 0, 0]", "[0.01, 0.01, 0.01]", 0.0043) +
      "[[body]]\nname = \"block\"\nshape = {box = {min = [0, 0, 0.01], max = [0.01, 0.01, 0.015]}}\n" +
      (rigid ? "rigid = true\n" : "material = {E = 1e9, nu = 0.3}\n") +
      "cell_size = 0.0031\ngrid = {offset = [0.3, 0.6, 0.2]}\n" + supports + test::contact_text("plate.z+", "block.z-");
  const Scene scene = parse_scene(text, "scene.toml");
  const Preparation p = discretise(scene);
  return message_of([&] { check_supports_of_rigid_bodies(scene, p.bodies, p.supports); });
}

/// Rigid motions, also those that several supports give together, in components that do not fix them all.
TEST(RigidSupports, MayPrescribeAnyRigidMotion) {
  const std::string up = support_text("block.x-", "displacement = {z = 1e-6}"),
                    further_up = support_text("block.x+", "displacement = {z = 2e-6}");
  EXPECT_EQ(rigid_refusal(up), "");
  EXPECT_EQ(rigid_refusal(up + further_up), "") << "about y";
  EXPECT_EQ(rigid_refusal(support_text("block.z+", "displacement = {x = \"-1e-4*y\", y = \"1e-4*x\", z = 3e-6}")), "");
  EXPECT_EQ(rigid_refusal(support_text("block.z+", "displacement = {z = \"1e-6 + 1e-4*x - 2e-4*y\"}")), "");
  EXPECT_EQ(rigid_refusal(up + further_up + support_text("block.z+", "stiffness = [1e9, 1e9, 1e9]")), "")
      << "springs give way";
}

/// The nearest rigid motion of a stretch by 1e-4 is its mean displacement. A shear differs from a
/// small rotation by one sign. Two supports that a rigid motion meets each by itself deform the body together.
TEST(RigidSupports, MayNotDeformTheBody) {
  const std::string stretch = support_text("block.z+", "displacement = {y = \"1e-4*y\"}");
  expect_contains(rigid_refusal(stretch), {"\"block.z+\": would deform the rigid body \"block\": prescribes ",
                                           ", 0.015) m where the nearest "
                                           "rigid motion has 5e-07 m",
                                           "rotation = {axis, angle}"});
  EXPECT_EQ(rigid_refusal(stretch, false), "") << "an elastic body";
  expect_contains(rigid_refusal(support_text("block.z+", "displacement = {x = \"1e-4*y\", y = \"1e-4*x\"}")),
                  {"would deform"});
  const std::string ends = support_text("block.x-", "displacement = {x = 0, z = 1e-6}") +
                           support_text("block.x+", "displacement = {z = 2e-6}");
  expect_contains(rigid_refusal(ends), {"would deform the rigid body \"block\""});
}

}  // namespace
}  // namespace cgcontact::test_condition_checks
