# Completion asks the program, and manual pages are made of its help.
"$E2LF" --version >version.txt
grep -qx "e2lf [0-9.]*" version.txt || fail "$(cat version.txt)"
grep -q "^zstd: O" version.txt || fail "no features: $(cat version.txt)"
grep -q "^instructions: [a-z0-9]*$" version.txt || fail "$(cat version.txt)"

# complete WORDS...: what bash offers for the last word.
complete_words() {
  bash -c '
    source "$SOURCES/src/e2lf/cli/completion.bash"
    COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
    _e2lf "$E2LF"
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
offers "--json" e2lf info rec.raw --js
# Names of bundled files beside files, behind a flag, behind "=" and alone.
offers "e2lf-n4-camera" e2lf reconstruct in.npz -m e2lf-n4-cam
offers "e2lf-n4-camera" e2lf reconstruct in.npz --model = e2lf-n4-cam
offers "evk4-lcos" e2lf simulate scene --camera evk
offers "evk4-lcos" e2lf simulate scene --camera = evk
offers "e2lf-n8 e2lf-n8-camera e2lf-n8-geometry-camera" e2lf simulate scene --codes e2lf-n8
offers "e2lf-n8-camera e2lf-n8-geometry-camera" e2lf model info e2lf-n8-
offers "e2lf-n8-camera e2lf-n8-geometry-camera" e2lf info e2lf-n8-
offers "cameras" e2lf reconstruct --help = cam
# Every verb of the list, and every flag of a help text.
"$E2LF" --help | sed -n 's/^  \([a-z]*\) .*/\1/p' >verbs.txt
[ "$(wc -l <verbs.txt)" -gt 10 ] || fail "no list of verbs"
complete_words e2lf "" >offered.txt
grep -qx reconstruct offered.txt || fail "no verbs"
while read -r verb; do grep -qx -- "$verb" offered.txt || fail "$verb is not offered"; done <verbs.txt
"$E2LF" reconstruct --help-all | grep -o -- '^ .*--[a-z-]*' | grep -o -- '--[a-z-]*' | sort -u >flags.txt
complete_words e2lf reconstruct -- >offered.txt
while read -r flag; do grep -qx -- "$flag" offered.txt || fail "$flag is not offered"; done <flags.txt

# The manual, where help2man is installed.
command -v help2man >/dev/null || exit 0
"$SOURCES/scripts/make_manual.sh" "$E2LF" man1
exists man1/e2lf.1 man1/e2lf-reconstruct.1 man1/e2lf-codes-render.1 man1/e2lf-model-info.1
grep -q "^e2lf-codes-render .*images that an aperture display shows" man1/e2lf-codes-render.1 || fail "whatis finds no e2lf-codes-render"
while read -r verb; do exists "man1/e2lf-$verb.1"; done <verbs.txt
sed 's/\\-/-/g' man1/e2lf-reconstruct.1 >manual.txt
while read -r flag; do
  grep -qF -- "$flag" manual.txt || fail "$flag is not in the manual"
done <flags.txt
