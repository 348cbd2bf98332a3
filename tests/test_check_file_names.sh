#!/bin/bash
# scripts/check_file_names.py passes names that one file has, and names each one that another file of the library has too.
#   tests/test_check_file_names.sh CHECKER
set -euo pipefail
checker=$1
tree=$(mktemp -d)
trap 'rm -r "$tree"' EXIT
mkdir -p "$tree"/{core/{base,triangles},kernels,recovery,contact}
failed=0

# write FILE LINE: the line in an unnamed namespace.
write() { printf 'namespace cgcontact {\nnamespace {\n%s\n}  // namespace\n}  // namespace cgcontact\n' "$2" >"$tree/$1"; }

# expect PASSES: the checker passes (1), or fails and tells where the name `flat` of core/b.cpp is (0).
expect() {
  local passes=1 said
  said=$("$checker" "$tree") || passes=0
  if [ $passes != "$1" ] || { [ "$1" = 0 ] && [[ $said != "core/b.cpp:3: flat is a name of "* ]]; }; then
    echo "$2: passes = $passes, said: $said"
    failed=1
  fi
  rm "$tree"/*/*.[ch]pp "$tree"/*/*/*.[ch]pp 2>/dev/null || true
}

# both PASSES FIRST SECOND: the first line in core/a.cpp, the second in core/b.cpp.
both() {
  write core/a.cpp "$2"
  write core/b.cpp "$3"
  expect "$1" "$2   beside   $3"
}

both 0 'constexpr double flat = 1e-3;' 'constexpr double flat = 0.866;'
both 0 'constexpr double flat = 1e-3;' 'constexpr int round = 1, other[] = {1, 2}, flat{3};'
both 0 'struct flat;  struct flat { int a; };' 'using flat = std::vector<int>;'
both 0 'constexpr int flat = 0;' 'template <class T, int n = 3> bool flat(const T& x) { return x < n; }'
both 0 'int flat(const Vec3& x, double size = 1) { return f(x); }' 'int flat(const Vec3& v, double) { return 0; }'
both 1 'int flat(const Vec3& x) { return 0; }' 'int flat(int x) { return 0; }'
both 1 'int a = f(1, [](int flat) { return flat; });' 'int b(int flat) { int flat_too = flat; return flat_too; }'
both 1 '// constexpr int flat = 0;' 'const char* text = "constexpr int flat = 0;";  constexpr int flat = 1'"'"'000;'
both 1 'struct Mine { int flat; enum Kind { flat_kind }; };' 'constexpr int flat = 0;'

write core/b.cpp 'constexpr int flat = 0;' # in the library's own headers and in those below, outside of the unnamed namespace
printf '#pragma once\nnamespace cgcontact {\nbool flat(int x);\n}\n' >"$tree/core/a.hpp"
expect 0 'a header of the library'
write core/b.cpp 'constexpr int flat = 0;'
printf 'namespace cgcontact {\n\nconstexpr int flat = 1;\n}\n' >"$tree/core/a.cpp"
expect 0 'a constant outside of unnamed namespaces'
write core/b.cpp 'constexpr int flat = 0;'
printf 'namespace cgcontact {\nnamespace detail {\nconstexpr int flat = 1;\n}\n}\n' >"$tree/core/a.cpp"
expect 1 'another named namespace'
write core/b.cpp 'constexpr int flat = 0;'
write kernels/a.cpp 'constexpr int flat = 0;'
write core/triangles/triangle_repair.cpp 'constexpr int flat = 0;'
expect 1 'another library, and what is compiled by itself'
printf 'namespace cgcontact {\nclass flat {};\n}\n' >"$tree/core/a.hpp"
printf 'namespace cgcontact {\n\nclass flat {};\nbool round(int x);\n}\n' >"$tree/contact/a.hpp"
if said=$("$checker" "$tree") || [[ $said != "contact/a.hpp:3: flat is a name of core/a.hpp:2 too" ]]; then
  echo "two headers: said: $said"
  failed=1
fi
printf 'namespace cgcontact {\nclass flat;\nbool round(int x);\n}\n' >"$tree/core/a.hpp"
expect 1 'a type and a function that headers only declare'
exit $failed
