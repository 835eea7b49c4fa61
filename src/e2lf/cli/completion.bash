# Completion of e2lf for bash, which asks the program. For zsh, run `autoload -U bashcompinit && bashcompinit` before.
_e2lf() {
  local IFS=$'\n'
  COMPREPLY=($("$1" complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null))
}
complete -o default -F _e2lf e2lf
