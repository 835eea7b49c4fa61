# The virtual rig: a light field before a display and physical pixels, event by event, to a recording and back to a light field.
"$E2LF" demo -o demo --width 96 --height 64 --quiet
other_codes other.npy
network="$SOURCES/models/e2lf-n4.safetensors"
simulate=("$E2LF" simulate demo/scene -m "$network" --camera evk4-lcos --scene-gain 4 --cycles 3 --seed 2 --quiet)
"${simulate[@]}" -o rec.raw
"$E2LF" info rec.raw --json >info.json
[ "$(json info.json "(j['format'], j['triggers'])")" = "('evt3', 48)" ] || fail "info: $(cat info.json)"
[ "$(json rec.raw.run.json "j['notes']['events']")" = "$(json info.json "j['events']")" ] || fail "the record counts the events"
# What is accumulated is what the simulation sums up itself, to the last event.
"$E2LF" accumulate rec.raw -o events.npz --source triggers --json >found.json 2>warnings.txt
# The events of slow pixels confirm the triggers, and no other times.
check "$(json found.json "j['least_confidence']") > 0.8"
[ ! -s warnings.txt ] || fail "$(cat warnings.txt)"
for origin_us in 102000 105000 110592 147368; do
  "$E2LF" accumulate rec.raw -o wrong.npz --overwrite --source schedule --origin-us $origin_us --json >wrong.json 2>/dev/null
  check "$(json wrong.json "j['least_confidence']") < 0.3"
done
"${simulate[@]}" --stream -o summed.npz
"${simulate[@]}" --stream --threads 1 -o one_thread.npz
"${simulate[@]}" --rise-us 2000 --refractory-us 200 --leak-rate-hz 1 --shot-rate-hz 2 --hot-pixels 0.01 --readout-limit 2e6 -o worn.raw
"$E2LF" accumulate worn.raw -o worn.npz --source triggers --quiet
py - <<'PY'
import numpy as np
load = lambda name: np.load(name + ".npz")["events"].astype(int)
events, summed = load("events"), load("summed")
assert events.shape == (3, 3, 64, 96), events.shape
assert np.array_equal(events, summed)
assert np.array_equal(load("one_thread"), summed)
assert not np.array_equal(events[1], events[2]), "noise is new in each cycle"
assert np.corrcoef(events[1, 0].ravel(), events[2, 0].ravel())[0, 1] > 0.75, "and the scene is not"
worn = load("worn")
assert worn.shape == events.shape and not np.array_equal(worn, events)
PY
# From the recording to light fields; the scene comes back.
"$E2LF" reconstruct rec.raw --source triggers --gain 0.25 -o fields --quiet
"$E2LF" eval demo/scene fields/cycle_00001 --json >eval.json
check "$(json eval.json "j['psnr_db']") > 14.5"
# Other models, event by event.
for model in quantised reference-aware esim v2e; do
  "$E2LF" simulate demo/scene --codes other.npy --event-model $model --stream -o $model.raw --quiet
  "$E2LF" accumulate $model.raw -o $model.npz --source triggers --quiet
done
"$E2LF" simulate demo/scene --event-model esim --refractory-us 100 -o blind.npz --quiet
"$E2LF" simulate demo/scene --event-model v2e --v2e-preset noisy -o noisy.npz --quiet
py - <<'PY'
import numpy as np
sums = {name: np.abs(np.load(name + ".npz")["events"].astype(int)).sum()
        for name in ("quantised", "reference-aware", "esim", "v2e", "blind", "noisy")}
assert min(sums.values()) > 0, sums
assert sums["blind"] < sums["esim"], sums
PY
# A table that turns, and light fields that follow on each other.
"$E2LF" simulate --turntable 1.75 --width 64 --height 48 --cycles 2 --camera evk4-lcos -o turning.raw --quiet
"$E2LF" simulate --turntable 40 --width 64 --height 48 --cycles 2 --event-model reference-aware --sigma-w 0 --sigma-z 0 -o fast.npz --quiet
"$E2LF" accumulate turning.raw -o turning.npz --source triggers --quiet
mkdir sequence
cp -r demo/scene sequence/0
cp -r demo/scene sequence/1
still=("$E2LF" simulate --event-model reference-aware --sigma-w 0 --sigma-z 0 --cycles 2 --quiet)
"${still[@]}" sequence --field-us 33333 -o sequence.npz
"${still[@]}" demo/scene --stream -o still.npz
py - <<'PY'
import numpy as np
fast, sequence, still = (np.load(name + ".npz")["events"] for name in ("fast", "sequence", "still"))
assert not np.array_equal(fast[0], fast[1]), "the table turns"
assert np.array_equal(sequence, still), "a scene that stays is a scene that stands still"
PY
fails 2 "input" "$E2LF" simulate -o none.raw
fails 2 "--turntable" "$E2LF" simulate demo/scene --turntable 1 -o none.raw
fails 1 "give --camera evk4-lcos" "$E2LF" simulate demo/scene --leak-rate-hz 1 -o none.raw
fails 1 "--residue" "$E2LF" simulate demo/scene --stream --residue 0.5 -o none.raw
echo '{"patterns": [{"name": "b1", "duration_us": 1000, "image": 0}]}' >other.json
fails 1 "codes" "$E2LF" simulate demo/scene --schedule other.json -o none.raw
absent none.raw
