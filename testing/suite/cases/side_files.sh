# A result and its side files are one thing: checked together, replaced together, never taken from another result.
"$E2LF" demo -o demo --width 48 --height 32 --quiet
"$E2LF" simulate demo/scene -o with.raw --cycles 2 --quiet
"$E2LF" simulate demo/scene -o without.raw --cycles 2 --no-triggers --quiet
triggers() { "$E2LF" info "$1" --json >info.json && json info.json "j['triggers']"; }
for name in o.csv; do
  side=o_triggers.csv
  "$E2LF" convert with.raw "$name" --quiet 2>warnings.txt
  all=$(triggers "$name")
  check "$all > 0"
  # The triggers of the old result are not those of the new one.
  "$E2LF" convert without.raw "$name" --overwrite --quiet
  absent "$side"
  [ "$(triggers "$name")" = 0 ] || fail "$name has triggers of the result that it replaced"
  "$E2LF" convert with.raw "$name" --overwrite --quiet 2>warnings.txt
  [ "$(triggers "$name")" = "$all" ] || fail "$name: triggers"
  rm "$name"
  fails 1 "would belong to $name" "$E2LF" convert without.raw "$name"
  absent "$name"
  exists "$side"
done
"$E2LF" convert with.raw d.dat --quiet
exists d_trigger.dat
"$E2LF" convert without.raw d.dat --overwrite --quiet
absent d_trigger.dat
# Files of the user with such names are not touched, asked to overwrite or not.
for pair in "p.csv p_triggers.csv" "p_cd.dat p_trigger.dat"; do
  # shellcheck disable=SC2086
  set -- $pair
  echo "my notes" >"$2"
  fails 1 "$2" "$E2LF" convert with.raw "$1"
  fails 1 "replaced" "$E2LF" convert with.raw "$1"
  fails 1 "e2lf did not write it" "$E2LF" convert with.raw "$1" --overwrite
  [ "$(cat "$2")" = "my notes" ] || fail "$2 was overwritten"
  absent "$1"
done
for name in s.npz s.raw; do
  echo '{"mine": 1}' >"$name.run.json"
  fails 1 "$name.run.json" "$E2LF" simulate demo/scene -o "$name"
  fails 1 "$name.run.json" "$E2LF" simulate demo/scene -o "$name" --overwrite
  [ "$(cat "$name.run.json")" = '{"mine": 1}' ] || fail "$name.run.json was overwritten"
  absent "$name"
done
[ -z "$(find . -name '*.part')" ] || fail "temporary files were left behind"

# The name of a record is no name for a result, asked to overwrite or not: it would be read as the other's.
"$E2LF" convert with.raw in.csv --quiet 2>warnings.txt
"$E2LF" convert with.raw x_cd.dat --quiet
"$E2LF" codes show --json >patterns.json
mkdir far && ln -s "$PWD/in.csv" far/link.csv && cp in_triggers.csv far/kept.csv && ln -s kept.csv far/link_triggers.csv
find . -type f ! -name stdout.txt ! -name stderr.txt ! -name before.txt -print0 | sort -z | xargs -0 sha256sum >before.txt
refused() { # <text> <command...>
  fails 1 "$@"
  sha256sum --quiet -c before.txt || fail "a file changed after: $*"
}
for flag in "" --overwrite; do
  # shellcheck disable=SC2086
  {
    refused "input" "$E2LF" convert in.csv in_triggers.csv $flag
    refused "input" "$E2LF" convert x_cd.dat x_trigger.dat $flag
    refused "record of in.csv" "$E2LF" eval demo/scene demo/scene -o in.csv.run.json $flag
    refused "record of d.dat" "$E2LF" codes show -o d.dat.run.json $flag
    refused "record of demo" "$E2LF" codes show -o demo/run.json $flag
  }
done
refused "is an input" "$E2LF" convert far/link.csv far/kept.csv --overwrite
mkdir links && ln -s ../in.csv links/in.csv && ln -s ../x_cd.dat links/other.dat
refused "is an input" "$E2LF" convert links/in.csv in_triggers.csv --overwrite
"$E2LF" convert without.raw bb.csv --quiet
# A recording that has such a name is not read as triggers, and not replaced as them.
cp in.csv bb_triggers.csv
fails 1 "triggers of bb.csv" "$E2LF" info bb.csv
"$E2LF" convert without.raw y_cd.dat --quiet
cp x_cd.dat y_trigger.dat
fails 1 "write" "$E2LF" convert with.raw y_cd.dat --overwrite
cmp x_cd.dat y_trigger.dat

# A link leads to the side files of its target: outputs through it are written there.
for name in links/in.csv links/other.dat; do
  [ "$(triggers "$name")" = "$all" ] || fail "$name: triggers"
done
"$E2LF" convert with.raw turned.npz --turn-views --quiet 2>warnings.txt
ln -s ../turned.npz links/turned.npz
"$E2LF" accumulate links/turned.npz -o images.npz --source triggers --quiet
[ "$(py -c 'import numpy as np; print(bytes(np.load("images.npz")["views"]).decode())')" = turned ] ||
  fail "the orientation of the views in the record of a link's target"
