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
fails 1 "cycle" "$E2LF" accumulate bursts.raw -o none.npz --source schedule
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
