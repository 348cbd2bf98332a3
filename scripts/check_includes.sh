#!/bin/bash
# Includes go one way: core <- kernels <- recovery <- contact <- perf, tests; and in each folder that has rooms
# (sub-folders) from room to room in the order below. Files beside the rooms come last: they may include any room, no
# room includes them. Complains about each line that does not keep to it.
#   scripts/check_includes.sh [ROOT]
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"

layers=(core kernels recovery contact)
declare -A rooms=(
  [core]="base settings triangles quadrature geometry cad cells bodies expressions scene scene_file decks results drawing program output"
  [core/base]="numbers errors files process"
  [core/scene_file]="sections templates"
  [core/output]="fields pictures check view report study plot"
  [kernels]="simd mesh operator reference assembled ranks multigrid solver"
  [recovery]="patch spr zone_edge batched constrained face error"
  [contact]="kernels model checks groups motions face solve results adaptive study"
  [contact/solve]="forces floating"
  [contact/results]="reference figures verdict estimates face_problems"
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
done

while IFS= read -r folder; do
  list=${rooms[$folder]:-}
  before=
  for room in $list; do
    before=${before:+$before|}$room
    if [ -d "$folder/$room" ]; then
      refuse "$folder/$room" "$include\"$folder/" "include[[:space:]]*\"$folder/($before)/" "$folder/$room may include: ${before//|/ }"
    fi
  done
  for path in "$folder"/*/; do
    room=$(basename "$path")
    [[ ! -d $path || " $list " == *" $room "* ]] || { echo "$folder/$room: not among the rooms of $folder in scripts/check_includes.sh"; bad=1; }
  done
done < <(find "${layers[@]}" -type d | sort)
exit $bad
