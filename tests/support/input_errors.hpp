/// What an InputError says, for tests.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/base/errors/errors.hpp"

namespace cgcontact {

/// what() of the InputError that the call throws, or "" if there is none.
template <class Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

inline void expect_contains(const std::string& text, const std::vector<std::string>& phrases) {
  for (const std::string& phrase : phrases)
    EXPECT_NE(text.find(phrase), std::string::npos) << phrase << "\n  in: " << text;
}

}  // namespace cgcontact
