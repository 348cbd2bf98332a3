/// [steps] of the scene file.
#include <gtest/gtest.h>

#include "core/scene_file/read_scene.hpp"

namespace cgcontact::test_steps {
namespace {

Scene read(const std::vector<std::string>& overrides) {
  return read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/tests/scenes/gap.toml", overrides);
}

std::string message(const std::vector<std::string>& overrides) {
  try {
    read(overrides);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Steps, FactorsOfEverythingOrOfEachKind) {
  EXPECT_TRUE(read({}).steps.empty());
  const auto all = read({"steps.factors=[0.25, 0.5, 1]"}).steps;
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[1].loads, 0.5);
  EXPECT_EQ(all[1].displacements, 0.5);
  EXPECT_EQ(all[1].interference, 0.5);
  const auto some = read({"steps.interference=[1, 1, 1]", "steps.loads=[0, \"1/2\", 1]"}).steps;
  ASSERT_EQ(some.size(), 3u);
  EXPECT_EQ(some[1].loads, 0.5);
  EXPECT_EQ(some[0].interference, 1);
  EXPECT_EQ(some[0].displacements, 1);  // not given: always as the scene says
}

TEST(Steps, NonsenseIsNamed) {
  const auto expect = [](const std::vector<std::string>& overrides, const std::string& words) {
    const std::string text = message(overrides);
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  expect({"steps.factors=[]"}, "has 0 factors");
  expect({"steps.factors=[0.5, 0.9]"}, "does not end with 1");
  expect({"steps.factors=[-0.5, 1]"}, "out of range");
  expect({"steps.factors=0.5"}, "steps.factors");
  expect({"steps.factors=[0.5, 1]", "steps.loads=[0.5, 1]"}, "stands beside factors");
  expect({"steps.displacements=[0.5, 1]", "steps.loads=[0.2, 0.5, 1]"}, "the list before it");
  expect({"steps.factor=[0.5, 1]"}, "unknown key");
}

}  // namespace
}  // namespace cgcontact::test_steps
