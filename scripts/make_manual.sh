#!/usr/bin/env bash
# make_manual.sh <e2lf> <folder>: writes the manual pages of the program and its verbs with help2man.
set -euo pipefail
e2lf=$1 folder=$2
version=$("$e2lf" --version | head -n 1)
mkdir -p "$folder"
page() { # <words of the verb...>
  local command="$e2lf $*" name="e2lf${*:+ $*}"
  help2man --no-info --no-discard-stderr --version-string "${version#* }" --name "${name}" \
    --output "$folder/${name// /-}.1" "${command% }"
}
page
"$e2lf" complete "" | grep -v -- --help | while read -r verb; do
  page "$verb"
  "$e2lf" "$verb" --help | grep -q "<verb>" || continue
  "$e2lf" complete "$verb" "" | grep -v -- --help | while read -r word; do page "$verb" "$word"; done
done
