# Light fields and event images that would be read wrongly are refused or warned of, with what to do.
model=$SOURCES/models/e2lf-n4.safetensors
"$E2LF" demo -o demo --width 64 --height 48 --quiet
"$E2LF" simulate demo/scene -m "$model" -o events.npz --cycles 2 --quiet
# warns <text> <command...>: the command does its work and says that.
warns() {
  local text=$1
  shift
  "$@" >stdout.txt 2>stderr.txt || fail "$*: $(cat stderr.txt)"
  grep -qF -- "$text" stderr.txt || fail "no \"$text\" from: $*: $(cat stderr.txt)"
}
# Views that are numbered one by one: the grid follows from their number or from an option.
for side in 6 8 15; do
  mkdir "flat$side"
  for ((i = 0; i < side * side; ++i)); do
    cp "demo/scene/0$((i / side % 8))_0$((i % side % 8)).png" "$(printf 'flat%d/input_Cam%03d.png' "$side" "$i")"
  done
  "$E2LF" info "flat$side" --json >info.json
  [ "$(json info.json "j['views']")" = "[$side, $side]" ] ||
    fail "flat$side: $(cat info.json)"
done
mkdir oblong
for ((i = 0; i < 24; ++i)); do cp demo/scene/00_00.png "$(printf 'oblong/input_Cam%03d.png' "$i")"; done
fails 1 "view columns" "$E2LF" info oblong
"$E2LF" info oblong --view-columns 6 --json >info.json
[ "$(json info.json "j['views']")" = "[4, 6]" ] || fail "$(cat info.json)"
# A view that is there twice.
cp -r demo/scene twice
convert twice/03_03.png twice/03_03.jpg
fails 1 "03_03" "$E2LF" info twice
# Numbers that are no light field, or hardly one.
py - <<'PY'
import numpy as np
rng = np.random.default_rng(1)
field = rng.random((8, 8, 48, 64)).astype(np.float32)
np.save("bool.npy", field > 0.5)
np.save("bits.npy", (field > 0.5).astype(np.uint8))
np.save("bytes16.npy", (255 * field).astype(np.uint16))
hole = field.copy()
hole[1, 2, 3, 4] = np.nan
np.save("hole.npy", hole)
PY
fails 1 "infinity" "$E2LF" convert hole.npy out
fails 1 "give the value that is white, e.g. 1" "$E2LF" convert bits.npy out
fails 1 "give the value that is white, e.g. 255" "$E2LF" convert bytes16.npy out
"$E2LF" convert bits.npy white1 --white 1 --quiet
"$E2LF" convert bool.npy bool --quiet
[ "$(identify -format '%[fx:maxima]' bool/00_00.png)" = 1 ] || fail "true is not white"
# Event images.
py - <<'PY'
import numpy as np
events = np.load("events.npz")["events"]
codes = np.load("events.npz")["codes"]
np.savez("zeros.npz", events=0 * events, codes=codes)
dead = events.copy()
dead[:, 1] = 0
np.savez("dead.npz", events=dead, codes=codes)
np.savez("unsigned.npz", events=events.astype(np.uint16), codes=codes)
np.savez("bytes.npz", events=events.astype(np.uint8), codes=codes)
part = events.astype(np.float32)
part[0, 0, 2, 3] = 1.5
np.savez("part.npz", events=part, codes=codes)
part[0, 0, 2, 3] = np.nan
np.savez("nan.npz", events=part, codes=codes)
PY
fails 1 "zeros.npz" "$E2LF" reconstruct zeros.npz -m "$model" -o out
warns "event image 1 has no events" "$E2LF" reconstruct dead.npz -m "$model" -o dead --format npy
fails 1 "1.5 at [0, 0, 2, 3] is not a whole number" "$E2LF" reconstruct part.npz -m "$model" -o out
fails 1 "NaN" "$E2LF" reconstruct nan.npz -m "$model" -o out
"$E2LF" reconstruct events.npz -m "$model" -o right --format npy --quiet
for kind in unsigned bytes; do
  if "$E2LF" reconstruct $kind.npz -m "$model" -o $kind --format npy >stdout.txt 2>stderr.txt; then
    cmp right/cycle_00001/lightfield.npy $kind/cycle_00001/lightfield.npy || fail "$kind is read wrongly"
  fi
done
# Things that a verb does not take.
"$E2LF" codes render -m "$model" -o display --quiet
fails 1 "aperture display" "$E2LF" reconstruct display -m "$model" -o out
"$E2LF" info display --json >info.json
mkdir run
echo '{}' >run/config.json
echo 'step' >run/log.csv
"$E2LF" info run >info.txt
grep -q "training run" info.txt || fail "$(cat info.txt)"
fails 1 "event images" "$E2LF" simulate events.npz -m "$model" -o out.npz
fails 1 "light field" "$E2LF" accumulate demo/scene -o out.npz
# A part of the cycles has the layout of all of them.
"$E2LF" reconstruct events.npz -m "$model" -o first --max-cycles 1 --format npy --quiet
exists first/cycle_00000/lightfield.npy
