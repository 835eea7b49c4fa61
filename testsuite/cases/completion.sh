# Completion scripts and manual pages are made of what the verbs declare.
"$E2LF" --version >version.txt
grep -qx "e2lf [0-9.]*" version.txt || fail "$(cat version.txt)"
grep -q "^zstd: O" version.txt || fail "no features: $(cat version.txt)"
grep -q "^instructions: [a-z0-9]*$" version.txt || fail "$(cat version.txt)"

for shell in bash zsh fish; do "$E2LF" completion $shell >"e2lf.$shell"; done
fails 2 "bash, zsh and fish" "$E2LF" completion tcsh
"$E2LF" completion --help | grep -q "^  zsh " || fail "no list of shells"
"$E2LF" --help | grep -q "^  completion " || fail "completion is no verb of the list"
for shell in bash zsh fish; do
  # A shell that is not here cannot check its script.
  ! command -v $shell >/dev/null || $shell -n "e2lf.$shell" || fail "$shell does not read its script"
done

# complete WORDS...: what bash offers for the last word.
complete_words() {
  bash -c '
    source e2lf.bash
    COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
    _e2lf 2>/dev/null
    printf "%s\n" "${COMPREPLY[@]}"' bash "$@"
}
# offers <expected words> <words so far...>
offers() {
  local expected=$1
  shift
  [ "$(complete_words "$@" | sort | tr '\n' ' ')" = "$expected " ] || fail "$*: $(complete_words "$@" | tr '\n' ' ')"
}
offers "simulate" e2lf sim
offers "--time-unit" e2lf convert --time
offers "auto ms ns s us" e2lf convert --time-unit ""
offers "bfloat16" e2lf reconstruct in.npz --precision b
offers "render" e2lf codes re
offers "--rotate" e2lf codes render --rot
offers "" e2lf convert --sensor-width ""
offers "--help bash fish zsh" e2lf completion ""
offers "--json" e2lf info rec.raw --js
# Names of bundled files beside files, behind a flag, behind "=" and alone.
offers "e2lf-n4-camera" e2lf reconstruct in.npz -m e2lf-n4-cam
offers "e2lf-n4-camera" e2lf reconstruct in.npz --model = e2lf-n4-cam
offers "evk4-lcos" e2lf simulate scene --camera evk
offers "evk4-lcos" e2lf simulate scene --camera = evk
offers "e2lf-n8 e2lf-n8-camera" e2lf simulate scene --codes e2lf-n8
offers "e2lf-n8-camera" e2lf model info e2lf-n8-
offers "e2lf-n8-camera" e2lf info e2lf-n8-
# Every verb of the list, and every flag of a help text.
"$E2LF" --help | sed -n 's/^  \([a-z]*\) .*/\1/p' >verbs.txt
[ "$(wc -l <verbs.txt)" -gt 10 ] || fail "no list of verbs"
complete_words e2lf "" >offered.txt
grep -qx reconstruct offered.txt || fail "no verbs"
while read -r verb; do grep -qx -- "$verb" offered.txt || fail "$verb is not offered"; done <verbs.txt
"$E2LF" reconstruct --help | grep -o -- '^ .*--[a-z-]*' | grep -o -- '--[a-z-]*' | sort -u >flags.txt
complete_words e2lf reconstruct -- >offered.txt
while read -r flag; do grep -qx -- "$flag" offered.txt || fail "$flag is not offered"; done <flags.txt

"$E2LF" shell-texts .
cmp bash/e2lf e2lf.bash
exists man1/e2lf.1 man1/e2lf-reconstruct.1 man1/e2lf-codes-render.1 man1/e2lf-model-info.1
while read -r verb; do exists "man1/e2lf-$verb.1"; done <verbs.txt
grep -q '^.SH EXAMPLE' man1/e2lf-simulate.1
while read -r flag; do
  grep -qF -- "$(sed 's/-/\\-/g' <<<"$flag")" man1/e2lf-reconstruct.1 || fail "$flag is not in the manual"
done <flags.txt
if command -v groff >/dev/null; then
  for page in man1/*.1; do
    groff -man -Tutf8 -ww "$page" >text.txt 2>problems.txt
    [ ! -s problems.txt ] || fail "$page: $(cat problems.txt)"
    grep -q "User Commands" text.txt || fail "$page is empty"
  done
fi
