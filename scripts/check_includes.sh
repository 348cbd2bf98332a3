#!/bin/bash
# Includes go one way: core <- kernels <- recovery <- contact <- perf, tests; and in each of these from room to room (sub-folder) in the order below.
# Files beside the rooms come last: they may include any room, no room includes them. Complains about each line that does not keep to it.
#   scripts/check_includes.sh [ROOT]
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"

layers=(core kernels recovery contact)
declare -A rooms=(
  [core]="base settings triangles quadrature geometry cad cells bodies scene decks results drawing program output"
  [kernels]="simd mesh operator reference assembled ranks multigrid solver"
  [recovery]="patch spr zone_edge batched constrained face error"
  [contact]="kernels model motions face solve results adaptive study"
)

include='^[[:space:]]*#[[:space:]]*include[[:space:]]*'
bad=0

# refuse FOLDER PATTERN-OF-LINES PATTERN-OF-ALLOWED-ONES WHY
refuse() {
  while IFS= read -r line; do
    echo "$line   ($4)"
    bad=1
  done < <(grep -rnE --include='*.[ch]pp' "$2" "$1" | grep -vE "$3" || true)
}

for ((i = 0; i < ${#layers[@]}; i++)); do
  layer=${layers[i]}
  [ -d "$layer" ] || { echo "no folder $layer in $PWD"; exit 1; }
  allowed=$(IFS='|'; echo "${layers[*]:0:i+1}")
  # In quotes only what lies in an allowed folder, written with the folder.
  refuse "$layer" "$include\"" "include[[:space:]]*\"($allowed)/" "$layer may include: ${layers[*]:0:i+1}"
  refuse "$layer" "$include<(core|kernels|recovery|contact|perf|tests)/" '^$' 'in angle brackets: our own headers are included in quotes'
  [ -n "${rooms[$layer]:-}" ] || continue
  before=
  for room in ${rooms[$layer]}; do
    before=${before:+$before|}$room
    if [ -d "$layer/$room" ]; then
      refuse "$layer/$room" "$include\"$layer/" "include[[:space:]]*\"$layer/($before)/" "$layer/$room may include: ${before//|/ }"
    fi
  done
  for folder in "$layer"/*/; do
    room=$(basename "$folder")
    [[ " ${rooms[$layer]} " == *" $room "* ]] || { echo "$layer/$room: not among the rooms of $layer in scripts/check_includes.sh"; bad=1; }
  done
done
exit $bad
