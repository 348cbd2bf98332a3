#include <gtest/gtest.h>

#include <cmath>
#include <thread>
#include <vector>

#include "core/expressions/expression.hpp"
#include "tests/support/input_errors.hpp"

namespace cgcontact::test_expression {
namespace {

const SourceLocation location{"scene.toml", 7, "load[0].pressure"};

std::string message_of_text(const std::string& text, const Constants& constants = {}) {
  return message_of([&] { Expression(text, location, constants)(Vec3(0.3, 0.2, 0.1)); });
}

TEST(Expression, default_is_zero) {
  EXPECT_TRUE(Expression().is_zero());
  EXPECT_TRUE(Expression().is_constant());
  EXPECT_EQ(Expression()(Vec3(1, 2, 3)), 0);
}

TEST(Expression, number_is_constant) {
  EXPECT_TRUE(Expression(2.5).is_constant());
  EXPECT_FALSE(Expression(2.5).is_zero());
  EXPECT_EQ(Expression(2.5)(Vec3(1, 2, 3)), 2.5);
}

TEST(Expression, function_of_the_position) {
  const Expression f([](const Vec3&x) { return x[0] - 2 * x[2]; }), copy(f);
  EXPECT_FALSE(f.is_constant());
  EXPECT_FALSE(f.is_zero());
  EXPECT_EQ(f(Vec3(1, 2, 3)), -5);
  EXPECT_EQ(copy(Vec3(1, 2, 3)), -5);
  EXPECT_TRUE(f.compared().empty());
}

TEST(Expression, text_without_variables_is_constant) {
  EXPECT_TRUE(Expression("2*pi", location).is_constant());
  EXPECT_TRUE(Expression("1-1", location).is_zero());
  EXPECT_FALSE(Expression("x-x", location).is_constant());
}

TEST(Expression, follows_the_variables) {
  const Vec3 x(0.3, -0.2, 0.007);
  EXPECT_DOUBLE_EQ(Expression("4e11*(0.01-z)*z", location)(x), 4e11 * (0.01 - x[2]) * x[2]);
  EXPECT_DOUBLE_EQ(Expression("x + 2*y", location)(x), x[0] + 2 * x[1]);
  EXPECT_DOUBLE_EQ(Expression("sqrt(x) + abs(y) + sin(z)", location)(x), std::sqrt(x[0]) + 0.2 + std::sin(x[2]));
  EXPECT_EQ(Expression("min(x, y, z) + max(x, y)", location)(x), -0.2 + 0.3);
  EXPECT_EQ(Expression("sign(y)", location)(x), -1);
  EXPECT_EQ(Expression("y < 0 && x > 0 ? 5 : 6", location)(x), 5);
  EXPECT_DOUBLE_EQ(Expression("_pi", location)(x), Expression("pi", location)(x));
  EXPECT_DOUBLE_EQ(Expression("ln(_e)", location)(x), 1);
  EXPECT_DOUBLE_EQ(Expression("x^2", location)(x), x[0] * x[0]);
}

TEST(Expression, knows_constants) {
  EXPECT_EQ(Expression("n*x", location, {{"n", 16}})(Vec3(0.5, 0, 0)), 8);
  EXPECT_TRUE(Expression("n/4", location, {{"n", 16}}).is_constant());
}

TEST(Expression, copies_are_independent) {
  const Expression first("x + y", location);
  Expression second = first, third;
  third = second;
  EXPECT_EQ(first(Vec3(1, 2, 3)), 3);
  EXPECT_EQ(second(Vec3(5, 2, 3)), 7);
  EXPECT_EQ(third(Vec3(0, 1, 0)), 1);
  third = Expression(4.0);
  EXPECT_EQ(third(Vec3(0, 1, 0)), 4);
  EXPECT_EQ(first(Vec3(1, 2, 3)), 3);
}

TEST(Expression, copies_can_be_evaluated_at_the_same_time) {
  const Expression original("x*x + y", location);
  std::vector<int> wrong(4, 0);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([copy = original, t, &wrong] {
      for (int k = 0; k < 20000; ++k)
        if (copy(Vec3(k, t, 0)) != static_cast<double>(k) * k + t) ++wrong[t];
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, std::vector<int>(4, 0));
}

TEST(Expression, division_by_zero_names_location_text_and_point) {
  const Expression expression("1e6/(z-2)", location);
  EXPECT_DOUBLE_EQ(expression(Vec3(0, 0, 3)), 1e6);
  expect_contains(message_of([&] { expression(Vec3(0.25, 0.5, 2)); }),
                  {"scene.toml:7: load[0].pressure = \"1e6/(z-2)\"", "infinite", "x = 0.25, y = 0.5, z = 2"});
  expect_contains(message_of_text("1/0"), {"scene.toml:7", "infinite"});
  expect_contains(message_of_text("sqrt(-x)"), {"not a number", "x = 0.3"});
}

TEST(Expression, mistakes_name_location_and_text) {
  for (const char* text : {"x+", "sin(x", "x y", "3 4", "1 +* 2", "x^", "x ? 1", "+", "", " ", "x, y", "x = 3", ")"})
    expect_contains(message_of_text(text),
                    {"scene.toml:7: load[0].pressure = \"" + std::string(text) + "\"", "allowed"});
}

TEST(Expression, unknown_names_are_named_with_a_suggestion) {
  expect_contains(message_of_text("pressur*x", {{"pressure", 1}}), {"\"pressur\"", "did you mean \"pressure\"?"});
  expect_contains(message_of_text("sqr(x)"), {"unknown function \"sqr\"", "did you mean \"sqrt\"?"});
  expect_contains(message_of_text("w"), {"unknown name \"w\"", "(allowed: x, y, z, pi"});
}

TEST(Expression, constants_alone_give_a_number) {
  EXPECT_DOUBLE_EQ(evaluate_constant("0.01/(1.3*n)", location, {{"n", 16}}), 0.01 / (1.3 * 16));
  expect_contains(message_of([] { evaluate_constant("1 + x", location); }), {"cannot depend on \"x\""});
  expect_contains(message_of([] { evaluate_constant("1/n", location, {{"n", 0}}); }), {"not finite", "n = 0"});
}

TEST(Expression, identifiers_are_not_functions_nor_exponents) {
  EXPECT_EQ(identifiers("1e5*n + sin (t) + n + 2.e-3*_a1 + e"), (std::vector<std::string>{"n", "t", "_a1", "e"}));
  EXPECT_TRUE(is_free_name("thickness_2"));
  for (const char* name : {"x", "z", "pi", "_pi", "_e", "sin", "2a", "a-b", ""})
    EXPECT_FALSE(is_free_name(name)) << name;
}

/// Any number of threads on one object, whatever the backend.
TEST(Expression, ThreadsShareIt) {
  const Expression f("x*x + sin(y)*z", SourceLocation{});
  std::vector<std::thread> threads;
  std::vector<int> wrong(8, 0);
  for (int t = 0; t < 8; ++t)
    threads.emplace_back([&, t] {
      for (int i = 0; i < 2000; ++i) {
        const Vec3 x(i, t, 0.5 * i);
        wrong[t] += std::abs(f(x) - (x[0] * x[0] + std::sin(x[1]) * x[2])) > 1e-6;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, std::vector<int>(8, 0));
}

}  // namespace
}  // namespace cgcontact::test_expression
