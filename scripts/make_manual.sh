#!/usr/bin/env bash
# make_manual.sh <e2lf> <folder>: writes the manual pages of the program and its verbs with help2man.
set -euo pipefail
e2lf=$1 folder=$2
version=$("$e2lf" --version | head -n 1)
mkdir -p "$folder"
page() { # <words of the verb...>
  local command="$e2lf $*" name="e2lf${*:+-$*}" summary
  name=${name// /-}
  summary=$(${command% } --help | sed -n '1{s/^e2lf [0-9.]*: //; s/\. .*//; s/\.$//; p}')
  help2man --no-info --help-option=--help-all --no-discard-stderr --version-string "${version#* }" --output "$folder/$name.1" "${command% }"
  # whatis(1) finds a page by one word: the name of its file.
  sed -i "/^\.SH NAME/{n;s|.*|$name \\\\- $summary|}" "$folder/$name.1"
}
page
"$e2lf" complete "" | grep -v -- --help | while read -r verb; do
  page "$verb"
  [[ $("$e2lf" "$verb" --help) == *"<verb>"* ]] || continue
  "$e2lf" complete "$verb" "" | grep -v -- --help | while read -r word; do page "$verb" "$word"; done
done
