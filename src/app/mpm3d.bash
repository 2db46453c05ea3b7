# Completion of the command mpm3d for bash: options, files, roles and classes.

_mpm3d() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}
  local program=${COMP_WORDS[0]} options
  options='-c --config -r --restart --check --estimate --list --describe --describe-run --version --help --threads
           --max-memory --set -q -v'
  COMPREPLY=()
  case $previous in
    -c | --config)
      mapfile -t COMPREPLY < <(compgen -f -X '!*.cfg' -- "$current"; compgen -d -- "$current")
      compopt -o filenames
      ;;
    -r | --restart)
      mapfile -t COMPREPLY < <(compgen -f -X '!*.h5' -- "$current"; compgen -d -- "$current")
      compopt -o filenames
      ;;
    --describe-run)
      mapfile -t COMPREPLY < <(compgen -f -- "$current")
      compopt -o filenames
      ;;
    --list)
      # Roles stand at the start of a line, their classes are indented.
      mapfile -t COMPREPLY < <(compgen -W "$("$program" --list 2>/dev/null | sed '/^ /d')" -- "$current")
      ;;
    --describe)
      mapfile -t COMPREPLY < <(compgen -W \
        "$("$program" --list 2>/dev/null | sed -n '/  not available /d;s/^  \([^ ][^ ]*\) .*/\1/p')" -- "$current")
      ;;
    --threads)
      mapfile -t COMPREPLY < <(compgen -W "$(seq "$(nproc 2>/dev/null || echo 1)")" -- "$current")
      ;;
    --max-memory)
      mapfile -t COMPREPLY < <(compgen -W '1G 2G 4G 8G 16G' -- "$current")
      ;;
    --set)
      mapfile -t COMPREPLY < <(compgen -W 'job. serializer. driver. solver. grid. body. contact. probe.' \
        -- "$current")
      compopt -o nospace
      ;;
    *)
      mapfile -t COMPREPLY < <(compgen -W "$options" -- "$current")
      ;;
  esac
}

complete -F _mpm3d mpm3d
