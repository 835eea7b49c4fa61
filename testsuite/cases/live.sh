# The instrument: light fields of a source that plays at its own speed, without a page.
"$E2LF" demo -o demo --width 64 --height 48 --quiet
model=$TESTSUITE/../models/e2lf-n4.safetensors
"$E2LF" simulate demo/scene -m "$model" --cycles 6 --seed 2 -o six.raw --quiet
"$E2LF" reconstruct six.raw -m "$model" --format npy -o six --quiet

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

# The recording is what was sent, byte for byte; a second one does not replace it.
cmp out/recording_000.raw six.raw || fail "the recording is not the input"
"$E2LF" live replay:six.raw -m "$model" --no-page --record -o out --invert-polarity --max-cycles 2 --quiet >quiet.txt 2>/dev/null
[ ! -s quiet.txt ] || fail "--quiet says: $(cat quiet.txt)"
cmp out/recording_000.raw six.raw || fail "the first recording was replaced"
exists out/recording_001.raw out/run.json
check "$(json out/run.json 'j["notes"]["totals"]["cycles"]') == 2"

# Half the size, and the sum of several cycles.
"$E2LF" live replay:six.raw -m "$model" --no-page --json --size half --average 3 --last half.npy >half.json
py - <<'PY'
import json
import numpy as np
*fields, totals = [json.loads(line) for line in open("half.json")]
assert all(f["size"] == "half" for f in fields) and fields[-1]["cycles"] == 3, fields
assert np.load("half.npy").shape == (8, 8, 24, 32)
PY

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
fails 1 "nothing" "$E2LF" live 'replay:six.raw?faster=2' --no-page

# It ends after the time that is given, though the source goes on, and says what went wrong.
mkfifo pipe
(cat six.raw; exec sleep 60) >pipe 2>/dev/null &
writer=$!
"$E2LF" live pipe -m "$model" --no-page --json --seconds 4 >pipe.json
kill "$writer" 2>/dev/null || true
check "$(tail -n 1 pipe.json | py -c 'import json, sys; j = json.load(sys.stdin)["totals"]; print(j["cycles"] >= 5 and j["seconds"] < 30)')"
fails 1 "give replay:FILE" "$E2LF" live six.raw --no-page
fails 1 "-o" "$E2LF" live replay:six.raw --no-page --record
fails 1 "model" "$E2LF" live replay:six.raw --no-page -m "$TESTSUITE/../models/e2lf-n8.safetensors" --patterns 4
fails 1 "complete pattern" "$E2LF" live replay:six.raw --no-page -m "$model" --source triggers --channel 7
mkdir mine && touch mine/notes.txt
fails 1 "was not written by e2lf live" "$E2LF" live replay:six.raw --no-page -o mine
