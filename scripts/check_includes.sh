#!/bin/bash
# Includes go one way: core <- kernels <- recovery <- contact <- perf, tests. Complains about each line that does not.
#   scripts/check_includes.sh [ROOT]
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"

layers=(core kernels recovery contact)
bad=0
for ((i = 0; i < ${#layers[@]}; i++)); do
  [ -d "${layers[i]}" ] || { echo "no folder ${layers[i]} in $PWD"; exit 1; }
  allowed=$(IFS='|'; echo "${layers[*]:0:i+1}")
  # In quotes only what lies in an allowed folder, written with the folder.
  while IFS= read -r line; do
    echo "$line   (${layers[i]} may include: ${layers[*]:0:i+1})"
    bad=1
  done < <(grep -rnE --include='*.[ch]pp' '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' "${layers[i]}" |
    grep -vE "include[[:space:]]*\"($allowed)/" || true)
  while IFS= read -r line; do
    echo "$line   (in angle brackets: our own headers are included in quotes)"
    bad=1
  done < <(grep -rnE --include='*.[ch]pp' '^[[:space:]]*#[[:space:]]*include[[:space:]]*<(core|kernels|recovery|contact|perf|tests)/' \
    "${layers[i]}" || true)
done
exit $bad
