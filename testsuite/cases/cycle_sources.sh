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
  grep -q "cycles do not change when the patterns should have" err.txt || fail "origin $origin_us: $(cat err.txt)"
done
"$E2LF" reconstruct bursts.raw -o light_fields --method inversion --source schedule --origin-us 50000 >out.txt 2>err.txt
grep -q "cycles do not change when the patterns should have" err.txt || fail "reconstruct: $(cat err.txt)"
fails 1 "does not say when a cycle began" "$E2LF" accumulate bursts.raw -o none.npz --source schedule
absent none.npz
