# e2lf live.

part live
# The instrument: light fields of a source that plays at its own speed, without a page.
"$E2LF" demo -o demo --width 64 --height 48 --quiet
model=$SOURCES/models/e2lf-n4.safetensors
"$E2LF" simulate demo/scene -m "$model" --cycles 6 --seed 2 -o six.raw --quiet
"$E2LF" reconstruct six.raw -m "$model" --format npy -o six --quiet

# --last is also written if the duration or a signal ends the session.
"$E2LF" live 'replay:six.raw?repeat=50' -m "$model" --no-page --seconds 1.5 --last ended.npy --quiet
[ -s ended.npy ] || fail "the last light field is missing after --seconds"

# Each cycle becomes a light field or is counted as skipped; the last one is that of `e2lf reconstruct` to the bit.
"$E2LF" live replay:six.raw -m "$model" --no-page --json --size full --record -o out --last last.npy >lines.json
cat >totals.py <<'PY'
import json, sys
import numpy as np
*fields, totals = [json.loads(line) for line in open("lines.json")]
totals = totals["totals"]
assert totals["fields"] == len(fields) > 0, totals
assert totals["cycles"] == totals["fields"] + totals["skipped_cycles"] == 6, totals
assert [f["field"] for f in fields] == list(range(1, len(fields) + 1)), fields
assert [f["cycle"] for f in fields] == sorted({f["cycle"] for f in fields}), fields
assert fields[-1]["cycle"] == 5, "the newest cycle is shown"
latencies = sorted(f["latency_s"] for f in fields)
for name, share in ("median", 0.5), ("p90", 0.9):
    rank = max(0, int(np.ceil(share * len(latencies))) - 1)
    assert abs(totals["latency_s"][name] - latencies[rank]) < 1e-9, (name, totals["latency_s"], latencies)
assert all(f["latency_s"] >= f["reconstruct_s"] > 0 and f["size"] == "full" for f in fields), fields
PY
py totals.py
cmp last.npy six/cycle_00005/lightfield.npy || fail "the last light field is not that of reconstruct"

# What makes the disparities doubtful is said, too.
other_codes other.npy
"$E2LF" simulate demo/scene --codes other.npy --cycles 2 -o other.raw --quiet
"$E2LF" live replay:other.raw --depth-model e2lf-n4-depth --no-page >out.txt 2>err.txt
grep -q "than e2lf-n4-depth was trained for" err.txt || fail "$(cat err.txt)"

# The recording is what was sent, byte for byte; a second one does not replace it.
cmp out/recording_000.raw six.raw || fail "the recording is not the input"
"$E2LF" live replay:six.raw -m "$model" --no-page --record -o out --invert-polarity --max-cycles 2 --quiet >quiet.txt 2>/dev/null
[ ! -s quiet.txt ] || fail "--quiet says: $(cat quiet.txt)"
cmp out/recording_000.raw six.raw || fail "the first recording was replaced"
exists out/recording_001.raw out/run.json
check "$(json out/run.json 'j["notes"]["totals"]["cycles"]') == 2"
"$E2LF" live --config out -o repeated --quiet
exists repeated/recording_000.raw

# Half the size, and the sum of several cycles.
"$E2LF" live replay:six.raw -m "$model" --no-page --json --size half --average 3 --last half.npy >half.json
py - <<'PY'
import json
import numpy as np
*fields, totals = [json.loads(line) for line in open("half.json")]
assert all(f["size"] == "half" for f in fields) and fields[-1]["cycles"] == 3, fields
assert np.load("half.npy").shape == (8, 8, 24, 32)
PY

# Pixels that stand still are averaged: the last light field is that of `e2lf reconstruct --fuse`, to the bit, also turned
# and of whole cycles, and without --fuse it fuses as many as is stated. With --average, or a network that is not told
# the number of cycles, it fuses none.
for network in e2lf-n4-live e2lf-n4-cycle-camera; do
  told=$SOURCES/models/$network.safetensors
  "$E2LF" simulate demo/scene -m "$told" --camera evk4-lcos --cycles 6 -o still.raw --quiet --overwrite
  "$E2LF" reconstruct still.raw -m "$told" --fuse 16 --gain 1 --format npy --turn-views -o still --quiet --overwrite
  for flags in "" "--fuse 1" "--average 2"; do
    [ "$network" = e2lf-n4-live ] || [ -z "$flags" ] || continue
    # shellcheck disable=SC2086  # several words
    "$E2LF" live replay:still.raw -m "$told" --no-page --json --size full --gain 1 --turn-views $flags --last still.npy --overwrite >still.json
    fused=$(tail -n 2 still.json | head -n 1 | py -c 'import json, sys; print(json.load(sys.stdin)["fused_cycles"])')
    case $flags in
      "")
        check "4 < $fused <= 6"
        # --last is upright.
        py -c 'import numpy as np; assert (np.load("still.npy")[::-1, ::-1] == np.load("still/cycle_00005/lightfield.npy")).all()' ||
          fail "$network $flags: the last light field is not that of reconstruct"
        ;;
      *) check "$fused == 0" ;;
    esac
  done
done
"$E2LF" live replay:six.raw -m "$model" --no-page --json >plain.json 2>plain.txt
grep -q "cycles are not fused: e2lf-n4 is not conditioned" plain.txt || fail "it does not say why nothing is fused: $(cat plain.txt)"
fails 1 "e2lf-n4-camera" "$E2LF" live replay:six.raw -m "$model" --no-page --fuse 4
fails 1 "--average" "$E2LF" live replay:still.raw -m "$told" --no-page --fuse 4 --average 4

# Twice the recording at four times its speed, and a quarter of the size.
"$E2LF" live 'replay:six.raw?repeat=2&speed=4' -m "$model" --no-page --json --size quarter --last quarter.npy >twice.json
py - <<'PY'
import json
import numpy as np
*fields, totals = [json.loads(line) for line in open("twice.json")]
assert all(f["size"] == "quarter" for f in fields), fields
assert 10 <= totals["totals"]["cycles"] <= 12, totals
assert np.load("quarter.npy").shape == (8, 8, 12, 16)
PY
fails 1 "faster" "$E2LF" live 'replay:six.raw?faster=2' --no-page

# It ends after the time that is given, though the source goes on, and says what went wrong.
mkfifo pipe
(cat six.raw; exec sleep 60) >pipe 2>/dev/null &
writer=$!
"$E2LF" live pipe -m "$model" --no-page --json --seconds 4 >pipe.json
kill "$writer" 2>/dev/null || true
check "$(tail -n 1 pipe.json | py -c 'import json, sys; j = json.load(sys.stdin)["totals"]; print(j["cycles"] >= 5 and j["seconds"] < 30)')"
fails 1 "give replay:FILE" "$E2LF" live six.raw --no-page
fails 2 "65535" "$E2LF" live replay:six.raw --port 70000
fails 1 "-o" "$E2LF" live replay:six.raw --no-page --record
fails 1 "e2lf-n8" "$E2LF" live replay:six.raw --no-page -m "$SOURCES/models/e2lf-n8.safetensors" --patterns 4
fails 1 "complete pattern" "$E2LF" live replay:six.raw --no-page -m "$model" --source triggers --channel 7
mkdir mine && touch mine/notes.txt
fails 1 "was not written by e2lf live" "$E2LF" live replay:six.raw --no-page -o mine

part live_outputs
# The outputs of live inputs: wrong inputs, names that are taken, inputs as outputs, and a disk that is full.
"$E2LF" demo -o demo --width 64 --height 48 --quiet
model=$SOURCES/models/e2lf-n4-live.safetensors
"$E2LF" simulate demo/scene -m "$model" --cycles 3 -o three.raw --quiet
"$E2LF" simulate demo/scene -m "$model" --cycles 120 -o long.raw --quiet
limited() ( # <KiB> <command...>
  ulimit -f "$1"
  shift
  "$@"
)
head -c 1000 /dev/urandom >junk.raw
mkdir folder folder/mine
echo mine >taken.raw
echo mine >taken.npy
cp "$SOURCES/models/e2lf-n4.safetensors" fine.npy
sha256sum three.raw taken.raw taken.npy fine.npy >before.txt

record=("$E2LF" record replay:three.raw -o)
fails 1 "live input" "$E2LF" record three.raw -o x.raw
fails 1 "live input" "$E2LF" record nowhere -o x.raw
fails 1 "nowhere.raw" "$E2LF" record replay:nowhere.raw -o x.raw
fails 1 "junk.raw" "$E2LF" record replay:junk.raw -o x.raw
fails 1 "(--overwrite)" "${record[@]}" taken.raw
fails 1 "folder" "${record[@]}" folder
fails 1 "three.raw" "${record[@]}" three.raw --overwrite
fails 1 "cannot write" "${record[@]}" /dev/full
mkfifo pipe
fails 1 "pipe" timeout 60 "$E2LF" record pipe -o pipe
absent x.raw x.bias
# What had been written when the disk was full cannot be repeated: it is kept, with its record.
fails 1 "cannot write" limited 16 "$E2LF" record replay:long.raw -o part.raw
cmp <(head -c 16384 long.raw) part.raw
[ "$(json part.raw.run.json 'j["notes"]["header"] is not None')" = True ] || fail "the record of a full disk"

live=("$E2LF" live replay:three.raw -m "$model" --no-page --size half)
fails 1 "taken.raw" "${live[@]}" -o taken.raw
fails 1 "was not written by e2lf live" "${live[@]}" -o folder
fails 1 "three.raw" "${live[@]}" -o three.raw
fails 1 "(--overwrite)" "${live[@]}" --last taken.npy
fails 1 "fine.npy" "${live[@]}" --fine fine.npy --last fine.npy --overwrite
fails 1 "written as .npy" "${live[@]}" --last last.png
fails 1 "device" "${live[@]}" --last /dev/full
fails 1 "model file" "${live[@]}" --fine nowhere -o new --record
fails 1 "nowhere.raw" "$E2LF" live replay:nowhere.raw -m "$model" --no-page -o new --last x.npy
fails 1 "complete pattern" "${live[@]}" -o new --source triggers --channel 7
absent new x.npy last.png
fails 1 "cannot write" limited 64 "${live[@]}" --last full.npy
absent full.npy full.npy.run.json
# A recording that stops where the disk is full does not stop the light fields, but the exit code says it.
fails 1 "the recording is incomplete: $PWD/new/recording_000.raw: cannot write" limited 64 "$E2LF" live replay:long.raw -m "$model" --no-page --size half --record -o new --seconds 5
[ "$(wc -c <new/recording_000.raw)" -eq 65536 ] || fail "$(wc -c <new/recording_000.raw) bytes of the recording"
check "$(json new/run.json 'j["notes"]["totals"]["fields"]') > 5"
sha256sum --quiet -c before.txt
[ -z "$(find . -name '*.part')" ] || fail "left behind: $(find . -name '*.part')"
