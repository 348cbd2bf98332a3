# Completion of cgcontact for bash: commands, options, scenes, keys of --set and --vary. Installed where bash-completion
# looks for it; without an installation: source scripts/completion/cgcontact.bash
# zsh: autoload -U +X bashcompinit && bashcompinit, then source it.

# Keys that every scene has (docs/scene.md).
_cgcontact_settings="title
solver.tolerance solver.max_outer_iterations solver.linear_tolerance solver.max_linear_iterations solver.method
solver.preconditioner solver.nested solver.kappa solver.ghost_penalty solver.shared_unknowns
recovery.spr_c recovery.rank_tolerance recovery.auxiliary_depth recovery.contact_edge recovery.pressure recovery.degree
recovery.inverse_variance recovery.points_per_face recovery.patch_volume recovery.rings
output.directory output.vtk output.vtu output.frd output.csv output.plots output.report output.view output.path"

# _cgcontact_keys SCENE: the parameters, the bodies' and the pairs' values of a scene file, then the settings.
_cgcontact_keys() {
  awk '
    /^[ \t]*\[/ { section = $1; gsub(/[][]/, "", section); if (section == "body") body = "" ; if (section == "load") ++loads }
    section == "load" && /^[ \t]*\[/ { print "load." loads - 1 ".pressure" }
    match($0, /^[ \t]*[A-Za-z_][A-Za-z_0-9]*[ \t]*=/) {
      key = $1; sub(/=.*/, "", key)
      if (section == "parameters") print key
      if (section == "body" && key == "name" && split($0, token, "\"") > 1) {
        body = "body." token[2]
        print body ".cell_size"; print body ".material.E"; print body ".material.nu"; print body ".grid.offset"
      }
    }' "$1" 2>/dev/null
  echo "$_cgcontact_settings"
}

# _cgcontact_options PROGRAM [COMMAND]: the long options in its help.
_cgcontact_options() {
  "$@" --help 2>/dev/null | sed -nE 's/^  (-[a-z],)?(--[a-z-]+)( .*|$)/\2/p'
}

# _cgcontact_files ENDING...: files with one of these endings, and folders.
_cgcontact_files() {
  local endings="${*}" IFS=$'\n'
  compopt -o filenames 2>/dev/null
  COMPREPLY=($(compgen -f -- "$current" | grep -iE "\.(${endings// /|})$") $(compgen -d -- "$current"))
}

_cgcontact_words() {
  COMPREPLY=($(compgen -W "$1" -- "$current"))
}

_cgcontact() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} program=${COMP_WORDS[0]}
  local command=${COMP_WORDS[1]} scene= word
  COMPREPLY=()
  # "=" divides words: KEY=VALUE comes as three.
  [[ $previous != "=" && $current != "=" ]] || return 0
  if ((COMP_CWORD == 1)); then
    local commands
    commands=$("$program" --help 2>/dev/null | sed -nE '/^Subcommands:/,/^$/s/^  ([a-z]+) .*/\1/p')
    _cgcontact_words "$commands $(_cgcontact_options "$program")"
    return
  fi
  for word in "${COMP_WORDS[@]:2}"; do
    [[ $word != *.toml || ! -f $word ]] || scene=$word
  done
  case $previous in
    --set | --vary)
      compopt -o nospace 2>/dev/null
      _cgcontact_words "$(_cgcontact_keys "$scene")"
      COMPREPLY=("${COMPREPLY[@]/%/=}") ;;
    -o | --out) compopt -o filenames 2>/dev/null; COMPREPLY=($(compgen -d -- "$current")) ;;
    --stl) _cgcontact_files stl obj ply off ;;
    --cad) _cgcontact_files step stp iges igs brep ;;
    --unit) _cgcontact_words "$("$program" init --help 2>/dev/null | sed -nE 's/.*Unit of the surface: //p' | tr -d ,)" ;;
    --preconditioner) _cgcontact_words "multigrid muelu" ;;
    -t | --threads) _cgcontact_words "$(seq 1 "$(nproc 2>/dev/null || echo 1)")" ;;
    --zoom) _cgcontact_words "contact" ;;
    --refine | --repeat | --cells | --field | --section | --range | --step | --body | --deformed) ;;
    --backend) compopt -o nospace 2>/dev/null ;;
    *)
      if [[ $current == -* ]]; then
        _cgcontact_words "$(_cgcontact_options "$program" "$command")"
      elif [[ $command == compare || $command == plot ]]; then
        compopt -o filenames 2>/dev/null; COMPREPLY=($(compgen -d -- "$current"))
      else
        _cgcontact_files toml
      fi ;;
  esac
}

complete -F _cgcontact cgcontact
