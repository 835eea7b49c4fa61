# Recordings survive every format that can hold them; light fields too.
"$E2LF" demo -o demo --width 96 --height 64 --quiet
"$E2LF" simulate demo/scene -o recording.raw --quiet
count() { "$E2LF" info "$1" --json >count.json && json count.json "(j['events'], j['events_on'], j['triggers'], j['first_t_us'], j['last_t_us'])"; }
truth=$(count recording.raw)
for output in a.hdf5 a.npz b.raw a.dat a.csv; do
  "$E2LF" convert recording.raw "$output" --quiet 2>warnings.txt
  [ "$(count "$output")" = "$truth" ] || fail "$output: $(count "$output") instead of $truth"
done
exists a_triggers.csv
fails 1 "orientation" "$E2LF" convert recording.raw - --format evt3 --turn-views
# A recording with other patterns does not continue one.
other_codes other.npy
"$E2LF" simulate demo/scene --codes other.npy -o other.raw --quiet
cat recording.raw other.raw >joined.raw
fails 1 "split the file here" "$E2LF" convert joined.raw joined.csv
absent joined.csv
# Back from each container to RAW: the same events, byte for byte what the first encoder wrote.
for input in a.hdf5 b.raw; do
  "$E2LF" convert "$input" back.raw --quiet --overwrite
  "$E2LF" convert back.raw back.npz --quiet --overwrite
  py - <<'PY'
import numpy as np
a, b = np.load("a.npz"), np.load("back.npz")
assert all(np.array_equal(a[k], b[k]) for k in "xypt"), a.files
PY
done
"$E2LF" convert recording.raw shifted.csv --shift-time --quiet 2>warnings.txt
"$E2LF" info shifted.csv --json >shifted.json
[ "$(json shifted.json "min(j['first_t_us'], 1000)")" -lt 1000 ] || fail "the time was not shifted"
# A slice of time, from any format and from a pipe.
"$E2LF" info recording.raw --json >whole.json
from=$(json whole.json "j['first_t_us'] + 20000") to=$(json whole.json "j['first_t_us'] + 60000")
"$E2LF" info recording.raw --from-us "$from" --to-us "$to" --json >slice.json
check "0 < $(json slice.json "j['events']") < $(json whole.json "j['events']") and $(json slice.json "j['first_t_us']") >= $from and $(json slice.json "j['last_t_us']") < $to"
for input in recording.raw a.hdf5 a.npz a.dat a.csv; do
  "$E2LF" info "$input" --from-us "$from" --to-us "$to" --json >other.json
  [ "$(json other.json "(j['events'], j['triggers'])")" = "$(json slice.json "(j['events'], j['triggers'])")" ] || fail "slice of $input"
done
# The slice ends before the recording does, and so may the pipe.
{ cat recording.raw || true; } | "$E2LF" convert - slice.csv --from-us "$from" --to-us "$to" --quiet 2>warnings.txt
[ "$("$E2LF" info slice.csv --json | py -c "import json, sys; print(json.load(sys.stdin)['events'])")" = "$(json slice.json "j['events']")" ] || fail "piped slice"
fails 1 "(--overwrite)" "$E2LF" convert recording.raw a.csv
fails 1 "nothing.raw" "$E2LF" convert nothing.raw x.csv
fails 1 "extension" "$E2LF" convert demo/scene scene.tif
absent scene.tif

"$E2LF" convert demo/scene scene.npy
"$E2LF" convert scene.npy scene_back --format png
cmp demo/scene/03_04.png scene_back/03_04.png
# Other programs' formats, and back: the same 8 bits.
mkdir stanford hci
for file in demo/scene/0?_0?.png; do
  name=$(basename "$file" .png)
  cp "$file" "stanford/out_${name}_-1.5_-2.5_.png"
  cp "$file" "hci/input_Cam$(printf '%03d' $((8 * ${name:1:1} + ${name:4:1}))).png"
done
for input in stanford hci; do
  "$E2LF" convert "$input" again --format png --quiet --overwrite
  cmp demo/scene/03_04.png again/03_04.png
done

fails 1 ".npz" "$E2LF" convert demo/events.npz events.csv
fails 1 "--shift-time" "$E2LF" convert demo/events.npz other.npz --shift-time
