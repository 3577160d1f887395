# SPDX-License-Identifier: Apache-2.0
# Completion of delfront's commands, options and their words in bash (in zsh after `autoload -U bashcompinit && bashcompinit`).
# All of them are asked of the program's own help.
_delfront() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} program=${COMP_WORDS[0]} words=
  if ((COMP_CWORD == 1)); then
    words=$("$program" --help 2>/dev/null | sed -n '/^Subcommands:/,/^$/s/^  \([a-z]\+\) .*/\1/p')
  elif [[ $word == -* ]]; then
    words=$("$program" "${COMP_WORDS[1]}" --help 2>/dev/null | grep -E '^  -' | cut -c-30 | grep -oE -- '--[a-z-]+')
  elif [[ $before == --* ]]; then
    words=$("$program" "${COMP_WORDS[1]}" --help 2>/dev/null | grep -E -- "^  (-[a-z],)?(--[a-z]+,)?$before[, ]" |
      grep -oE -- " [a-z-]+(\|[a-z-]+)+" | head -n 1 | tr '|' ' ')
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
  ((${#COMPREPLY[@]})) || mapfile -t COMPREPLY < <(compgen -f -- "$word")
}
complete -o filenames -F _delfront delfront
