#!/bin/bash
# scripts/check_includes.sh passes includes in the order of the folders and their rooms, and names each one against it.
#   tests/test_check_includes.sh CHECKER
set -euo pipefail
checker=$1
tree=$(mktemp -d)
trap 'rm -r "$tree"' EXIT
mkdir -p "$tree"/{core/{base/{numbers,files},geometry},kernels/mesh,recovery/patch,contact/model}
failed=0

# expect PASSES FILE LINE: with this line in this file the checker passes (1) or fails and names the file (0).
expect() {
  echo "$3" >"$tree/$2"
  local passes=1 said
  said=$("$checker" "$tree") || passes=0
  if [ $passes != "$1" ] || { [ "$1" = 0 ] && [[ $said != "$2:1:"* ]]; }; then
    echo "$2 with $3: passes = $passes, said: $said"
    failed=1
  fi
  rm "$tree/$2"
}

expect 1 core/geometry/a.hpp '#include "core/base/b.hpp"'
expect 1 core/base/a.cpp '#include "core/base/b.hpp"'
expect 1 core/base/files/a.cpp '#include "core/base/numbers/b.hpp"'
expect 1 core/geometry/a.cpp '#include "core/base/files/b.hpp"'
expect 1 recovery/patch/a.cpp '#include "core/geometry/b.hpp"'
expect 1 contact/a.cpp '#include "kernels/mesh/b.hpp"'
expect 0 core/base/a.hpp '#include "core/geometry/b.hpp"'     # a later room
expect 0 core/base/a.hpp '  #  include  "core/b.hpp"'         # beside the rooms
expect 0 core/base/numbers/a.hpp '#include "core/base/files/b.hpp"' # a later room of a room
expect 0 core/base/numbers/a.hpp '#include "core/base/b.hpp"'
expect 0 kernels/mesh/a.cpp '#include "recovery/patch/b.hpp"' # a later folder
expect 0 kernels/mesh/a.cpp '#include "b.hpp"'
expect 0 kernels/mesh/a.cpp '#include <core/base/b.hpp>'
for room in core/attic core/geometry/attic; do
  mkdir "$tree/$room"
  if "$checker" "$tree" >/dev/null; then
    echo "$room, which is in no list, passes"
    failed=1
  fi
  rmdir "$tree/$room"
done
exit $failed
