/// Expressions in x, y, z (m) given by the user, compiled by muParser.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/base/errors/errors.hpp"
#include "core/base/numbers/types.hpp"
#include "core/expressions/unit_check.hpp"

namespace cgcontact {

/// Named numbers that expressions may use besides x, y, z and pi (the scene's [parameters]).
using Constants = std::map<std::string, Quantity>;

/// Name of the constant that only [reference] knows, after the solve: magnitude of the first pair's contact force, N.
inline constexpr const char* contact_force_name = "contact_force";

/// Number, an expression of x, y, z, or another function of the position. Several threads may evaluate one object at
/// once.
class Expression {
 public:
  Expression();  ///< zero
  explicit Expression(double value);
  /// Takes a function of x (global coordinates, m) that several threads may call at once.
  explicit Expression(std::function<double(const Vec3& x)> function);
  /// Compiles; throws InputError that names the line, the text and the position of the mistake. Units in the text are
  /// checked against the SI unit that is `wanted` (none: any dimension), x, y and z being lengths.
  Expression(const std::string& text, const SourceLocation& location, const Constants& constants = {},
             const std::optional<Unit>& wanted = std::nullopt);
  ~Expression();
  Expression(const Expression&);
  Expression& operator=(const Expression&);
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;

  /// Returns the value at x (global coordinates, m); throws InputError if it is not finite there (division by zero,
  /// ...).
  double operator()(const Vec3& x) const;
  /// Returns whether it is the constant zero.
  bool is_zero() const;
  bool is_constant() const;
  /// Differences of what is compared by size in its text (of `sign`: what it takes), but for constants: where one
  /// changes its sign the value may jump.
  std::vector<Expression> compared() const;

 private:
  struct Compiled;
  double constant_ = 0;
  std::function<double(const Vec3& x)> function_;  ///< none: the constant, or what is compiled
  std::unique_ptr<Compiled> compiled_;
};

/// Evaluates an expression of the constants alone; throws InputError like Expression, also if x, y or z occur.
Quantity evaluate_constant(const std::string& text, const SourceLocation& location, const Constants& constants = {});

/// Lists the variables and constants (not functions) that occur in the text, in order, without repetition; with units
/// behind "*" or "/", which may be meant as constants.
std::vector<std::string> identifiers(const std::string& text);

/// " with n = 16, t = 0.1" for the constants that occur in the text, or "".
std::string used_constants(const std::string& text, const Constants& constants);

/// Returns whether the name is free to be used as a constant: an identifier that is no variable, function or built-in
/// name.
bool is_free_name(const std::string& name);

}  // namespace cgcontact
