# The times of patterns, and the transitions that are used.

part cycle_sources
# When patterns change is claimed by triggers or a schedule, and confirmed by the events.
"$E2LF" demo -o demo --width 96 --height 64 --quiet
"$E2LF" simulate demo/scene -o bursts.raw --cycles 4 --no-triggers --quiet
confidence() { json out.json "j['least_confidence']"; }
"$E2LF" accumulate bursts.raw -o right.npz --source schedule --origin-us 100000 --json >out.json 2>err.txt
check "$(confidence) > 0.5"
[ ! -s err.txt ] || fail "$(cat err.txt)"
for origin_us in 50000 52631 96000 104000; do
  "$E2LF" accumulate bursts.raw -o wrong.npz --overwrite --source schedule --origin-us "$origin_us" --json >out.json 2>err.txt
  check "$(confidence) < 0.05"
  grep -q "cycles.*patterns" err.txt || fail "origin $origin_us: $(cat err.txt)"
done
"$E2LF" reconstruct bursts.raw -o light_fields --method inversion --source schedule --origin-us 50000 >out.txt 2>err.txt
grep -q "cycles.*patterns" err.txt || fail "reconstruct: $(cat err.txt)"
fails 1 "--origin-us" "$E2LF" accumulate bursts.raw -o none.npz --source schedule
# What belongs to another source is not ignored.
fails 1 "(--channel)" "$E2LF" accumulate bursts.raw -o none.npz --source bursts --channel 0
fails 1 "(--one-trigger-per-cycle)" "$E2LF" accumulate bursts.raw -o none.npz --source schedule --origin-us 100000 --one-trigger-per-cycle
fails 1 "(--origin-us)" "$E2LF" accumulate bursts.raw -o none.npz --source bursts --origin-us 100000
echo '{}' >schedule.json
fails 2 "--schedule" "$E2LF" accumulate bursts.raw -o none.npz --schedule schedule.json --patterns 4
absent none.npz
# Triggers count in pipes and live recordings as in files; a recording that begins in the middle of a cycle loses that one.
"$E2LF" simulate demo/scene -o triggers.raw --cycles 4 --quiet
"$E2LF" convert triggers.raw cut.raw --from-us 140000 --quiet
for recording in triggers cut; do
  "$E2LF" accumulate $recording.raw -o $recording.npz --quiet
  "$E2LF" accumulate - -o $recording.piped.npz --quiet <$recording.raw
  "$E2LF" accumulate replay:$recording.raw -o $recording.live.npz --quiet
  cmp $recording.npz $recording.piped.npz
  cmp $recording.npz $recording.live.npz
  # How far live input fell behind is in its record.
  [ "$(json $recording.live.npz.run.json 'j["notes"]["live"]["pauses"]')" = 0 ] || fail "live: $(cat $recording.live.npz.run.json)"
  [ "$(json $recording.npz.run.json 'j["notes"]["live"]')" = None ] || fail "a file is not live"
done
py - <<'PY'
import numpy as np
whole, rest = np.load("triggers.npz")["events"], np.load("cut.npz")["events"]
assert whole.shape[0] == 4 and np.array_equal(rest, whole[1:]), rest.shape
PY
# Where neither intervals nor events tell the pattern of the first trigger, that is said.
if [ -n "${E2LF_DATA:-}" ]; then
  recording=$E2LF_DATA/events/evt3_vga_trigger_2khz_640x480.raw
  echo '{"patterns": [{"duration_us": 1000}, {"duration_us": 1000, "image": 0}, {"duration_us": 1000, "image": 1}, {"duration_us": 1000, "image": 2}]}' >alike.json
  for input in "$recording" - "replay:$recording"; do
    "$E2LF" accumulate "$input" -o alike.npz --overwrite --schedule alike.json --json <"$recording" >out.json 2>err.txt
    json out.json "j['complete']" >>alike.txt
    grep -q "pattern 0 of the schedule is assumed" err.txt || fail "$(cat err.txt)"
  done
  cat alike.txt
  [ "$(sort -u alike.txt)" = 519 ] || fail "cycles of a file, a pipe and a camera: $(cat alike.txt)"
fi

part transitions
# Event images of the lit patterns alone or of all transitions of the whole cycle.
"$E2LF" demo -o demo --width 96 --height 64 --quiet
network="$SOURCES/models/e2lf-n4.safetensors"
"$E2LF" codes show -m "$network" -o codes.json --quiet
py - <<'PY'
import json, numpy as np
codes = np.array([[[float(c) for c in row] for row in p] for p in json.load(open("codes.json"))["patterns"]], np.float32)
np.save("whole.npy", np.concatenate([codes, 1 - codes, codes[:1]]))
PY
# Counts of all eight transitions go through a recording unchanged, whoever says that all are meant.
"$E2LF" simulate demo/scene --codes whole.npy --cycles 3 -o whole.raw --quiet
"$E2LF" simulate demo/scene --codes whole.npy --cycles 3 -o counts.npz --quiet
"$E2LF" accumulate whole.raw -o auto.npz --json >found.json 2>err.txt
[ ! -s err.txt ] || fail "$(cat err.txt)"
check "$(json found.json "j['least_confidence']") > 0.5"
"$E2LF" accumulate whole.raw -o lit_of_whole.npz --transitions lit --quiet
# The rig's recording says a1 to a4; slow pixels. One whole cycle fewer than the display's repetitions.
"$E2LF" simulate demo/scene --codes codes.json --camera evk4-lcos --cycles 4 --seed 2 -o rig.raw --quiet
"$E2LF" accumulate rig.raw -o lit.npz --quiet
for source in "--source triggers" "--source schedule --origin-us 100000"; do
  "$E2LF" accumulate rig.raw -o all.npz --overwrite --transitions all $source --json >found.json
  [ "$(json found.json "j['complete']")" = 3 ] || fail "$source: $(cat found.json)"
done
check "$(json found.json "j['least_confidence']") > 0.8"
py - <<'PY'
import numpy as np
load = lambda name: np.load(name + ".npz")
whole = np.load("whole.npy")
assert np.array_equal(load("auto")["events"], load("counts")["events"])
assert np.array_equal(load("auto")["codes"], whole)
assert np.array_equal(load("lit_of_whole")["events"], load("counts")["events"][:, :3])
assert np.array_equal(load("lit_of_whole")["codes"], whole[:4])
lit, all_ = load("lit")["events"].astype(int), load("all")["events"].astype(int)
assert all_.shape == (3, 8, 64, 96), all_.shape
assert np.array_equal(all_[:, :3], lit[:3]), "the lit transitions are the same"
assert np.array_equal(load("all")["codes"], whole)
sums = all_.sum((0, 2, 3))
# To white and from black it gets brighter, to black darker. After white slow pixels still follow the step before.
assert sums[0] > 0 and sums[3] > 0 and sums[7] < 0 and abs(sums[4]) < 0.1 * sums[3], sums
PY
# Reconstruction takes what the patterns that are named are for.
"$E2LF" reconstruct rig.raw --codes whole.npy --method inversion -o whole_field --json >whole.json 2>/dev/null
"$E2LF" reconstruct rig.raw --codes codes.json --method inversion -o lit_field --json >lit.json 2>/dev/null
[ "$(json whole.json "len(j['cycles'])")/$(json lit.json "len(j['cycles'])")" = 3/4 ] || fail "cycles: $(cat whole.json lit.json)"
"$E2LF" codes render --codes whole.npy -o display --quiet
[ "$(ls display/frame_*.png | wc -l)" = 8 ] || fail "$(ls display)"
# A cycle during which the scene moves too much is reconstructed from its lit transitions, unless all are wanted.
transitions_of() { json "$1/run.json" "' '.join(c.get('transitions', '-') for c in j['notes']['cycles'])"; }
for rpm in 1 40; do
  "$E2LF" simulate --turntable $rpm --width 96 --height 64 -m e2lf-n4-cycle-camera --camera evk4-lcos --cycles 2 -o turn.npz --overwrite --quiet
  "$E2LF" reconstruct turn.npz -m e2lf-n4-cycle-camera -o turn$rpm >out.txt 2>err.txt
done
[ "$(transitions_of turn1)" = "all all" ] || fail "slow: $(cat turn1/run.json)"
[ "$(transitions_of turn40)" = "lit lit" ] || fail "moving: $(cat turn40/run.json)"
grep -q "the scene moved during 2 of 2 cycles" err.txt || fail "$(cat err.txt)"
"$E2LF" reconstruct turn.npz -m e2lf-n4-cycle-camera --transitions all -o whole_of_moving --quiet
[ "$(transitions_of whole_of_moving)" = "- -" ] || fail "$(cat whole_of_moving/run.json)"
# Another camera is compared with the network's own by the whole cycle alone.
"$E2LF" reconstruct turn.npz -m e2lf-n4-cycle-camera --camera ideal -o other --quiet
[ "$(transitions_of other)" = "lit lit" ] || fail "$(cat other/run.json)"
