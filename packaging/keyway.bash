# Completion of bash for keyway: options, keywords, fields and messages come from the program.

_keyway_options() {
  "$1" --help 2>/dev/null | sed -n 's/^  \(-[-a-z0-9]*\).*/\1/p'
}

# Keywords with a backslash before each blank, so that they stay one word each.
_keyway_keywords() {
  "$1" --keywords 2>/dev/null | sed -n 's/^  \*\([A-Z][A-Z ]*[A-Z]\)  *.*/\1/p' | sed 's/  .*//' |
    sort -u
}

_keyway_fields() {
  "$1" --fields 2>/dev/null | sed -n '2,$s/^\([A-Z][A-Z0-9_]*\) .*/\1/p'
}

_keyway_messages() {
  "$1" --explain 2>/dev/null | sed -n '/^$/q; s/^\([a-z][-a-z0-9]*\) .*/\1/p'
}

_keyway_files() {
  local pattern=$1 word=$2
  compopt -o filenames 2>/dev/null
  mapfile -t COMPREPLY < <(compgen -f -X "!$pattern" -- "$word"; compgen -d -- "$word")
}

_keyway() {
  local program=$1 word=$2 before=$3 names
  COMPREPLY=()
  case $before in
    -o)
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -d -- "$word")
      return
      ;;
    -j)
      mapfile -t COMPREPLY < <(compgen -W "$(seq "$(nproc)")" -- "$word")
      return
      ;;
    --keywords)
      mapfile -t names < <(_keyway_keywords "$program")
      local IFS=$'\n'
      mapfile -t COMPREPLY < <(compgen -W "${names[*]}" -- "${word^^}")
      COMPREPLY=("${COMPREPLY[@]// /\\ }")
      return
      ;;
    --fields)
      mapfile -t COMPREPLY < <(compgen -W "$(_keyway_fields "$program")" -- "${word^^}")
      return
      ;;
    --explain)
      mapfile -t COMPREPLY < <(compgen -W "$(_keyway_messages "$program")" -- "$word")
      return
      ;;
    --umat | --umat-library)
      _keyway_files '*.@(f|for|ftn|f77|f90|f95|so|o|a)' "$word"
      return
      ;;
  esac
  if [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_keyway_options "$program")" -- "$word")
  else
    _keyway_files '*.inp' "$word"
  fi
}

complete -F _keyway keyway
