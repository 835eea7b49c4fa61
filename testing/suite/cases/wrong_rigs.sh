# Recordings of rigs that are set up wrongly: inverted polarity, triggers out of step, other edges, channels and schedules.
"$E2LF" demo -o demo --width 96 --height 64 --quiet
network="$SOURCES/models/e2lf-n4.safetensors"
"$E2LF" simulate demo/scene -m "$network" --camera evk4-lcos --cycles 6 --seed 3 -o rig.raw --quiet
# As the camera gives it.
"$E2LF" accumulate rig.raw -o right.npz --json >right.json 2>err.txt
[ ! -s err.txt ] || fail "$(cat err.txt)"
check "$(json right.json "j['least_confidence']") > 0.8 and $(json right.json "j['findings']") == []"
"$E2LF" accumulate rig.raw -o line.npz >line.txt
grep -q "channel 0 has .* rising and .* falling edges" line.txt || fail "$(cat line.txt)"
# B3: inverted polarity is said and not certain, and the option gives the events back.
"$E2LF" convert rig.raw rig.csv --quiet
py - <<'PY'
lines = open("rig.csv").read().splitlines()
first = next(i for i, line in enumerate(lines) if line[:1].isdigit())
columns = [name.strip() for name in lines[first - 1].lstrip("#% ").split(",")] if first else ["x", "y", "p", "t"]
p = columns.index("p") if "p" in columns else 2
out = lines[:first]
for line in lines[first:]:
    cells = line.split(",")
    cells[p] = "0" if cells[p].strip() == "1" else "1"
    out.append(",".join(cells))
open("inverted.csv", "w").write("\n".join(out) + "\n")
PY
cp rig_triggers.csv inverted_triggers.csv
"$E2LF" accumulate inverted.csv -o inverted.npz --sensor-width 96 --sensor-height 64 --json >inverted.json 2>err.txt
grep -q "polarity is inverted" err.txt || fail "$(cat err.txt inverted.json)"
grep -q -- "--invert-polarity" err.txt || fail "$(cat err.txt)"
check "$(json inverted.json "j['least_confidence']") == 0"
"$E2LF" accumulate inverted.csv -o mended.npz --sensor-width 96 --sensor-height 64 --invert-polarity --quiet 2>err.txt
[ ! -s err.txt ] || fail "$(cat err.txt)"
py -c 'import numpy as n; assert n.array_equal(n.load("mended.npz")["events"], n.load("right.npz")["events"])' || fail "the events differ"
# B4: one trigger 500 us late.
cp rig.csv late.csv
py - <<'PY'
lines = open("rig_triggers.csv").read().splitlines()
out, rising = [], 0
for line in lines:
    cells = line.split(",")
    if cells[0].strip().lstrip("-").isdigit():
        p = [c for c in cells if c.strip() in ("0", "1")]
        rising += 1
        if rising in (43, 44):  # the rising and the falling edge of the 22nd pulse
            time = max(range(len(cells)), key=lambda i: int(cells[i]))
            cells[time] = str(int(cells[time]) + 500)
    out.append(",".join(cells))
open("late_triggers.csv", "w").write("\n".join(out) + "\n")
PY
"$E2LF" accumulate late.csv -o late.npz --sensor-width 96 --sensor-height 64 --json >late.json 2>err.txt
grep -q "500 us late" err.txt || fail "$(cat err.txt late.json)"
[ "$(json late.json "[len(f['figures']['triggers']) for f in j['findings'] if f['code'] == 'triggers-late']")" = "[1]" ] || fail "$(cat late.json)"
check "$(json late.json "j['least_confidence']") == 0"
# B4: all triggers late by the same time, as those of the other edge are.
cp rig.csv delayed.csv
py - <<'PY'
out = []
for line in open("rig_triggers.csv").read().splitlines():
    cells = line.split(",")
    if cells[0].strip().lstrip("-").isdigit():
        time = max(range(len(cells)), key=lambda i: int(cells[i]))
        cells[time] = str(int(cells[time]) + 1500)
    out.append(",".join(cells))
open("delayed_triggers.csv", "w").write("\n".join(out) + "\n")
PY
"$E2LF" accumulate delayed.csv -o delayed.npz --sensor-width 96 --sensor-height 64 --json >delayed.json 2>err.txt
grep -q "before the trigger of each pattern.*other edge.*--trigger-delay-us" err.txt || fail "$(cat err.txt delayed.json)"
check "0 <= $(json right.json "j['event_delay_us']") < 1000"
check "abs($(json right.json "j['event_delay_us']") - $(json delayed.json "j['event_delay_us']") - 1500) < 250"
# The delay of the triggers gives back the events.
"$E2LF" accumulate delayed.csv -o in_step.npz --sensor-width 96 --sensor-height 64 --trigger-delay-us -1500 --quiet 2>err.txt
[ ! -s err.txt ] || fail "$(cat err.txt)"
py -c 'import numpy as n; assert n.array_equal(n.load("in_step.npz")["events"], n.load("right.npz")["events"])' || fail "the events differ"
# Findings travel with the event images.
"$E2LF" reconstruct inverted.npz --codes e2lf-n4 -m e2lf-n4-camera -o fog --json >fog.json 2>err.txt
grep -q "polarity-inverted.*--invert-polarity" err.txt || fail "$(cat err.txt)"
[ "$(json fog.json "j['cycles'][0]['check']['verdict'] in ('doubtful', 'unconfirmed')")" = True ] || fail "$(cat fog.json)"
# The schedule of the display states the patterns, so that nothing has to be stated twice.
"$E2LF" codes render --codes e2lf-n4 -o shown --quiet
"$E2LF" accumulate delayed.csv -o stated.npz --sensor-width 96 --sensor-height 64 --trigger-delay-us -1500 --schedule shown/schedule.json --quiet 2>/dev/null
py -c 'import numpy as n; assert n.load("stated.npz")["codes"].shape == (4, 8, 8)' || fail "the patterns of the schedule"
"$E2LF" accumulate delayed.csv -o given.npz --sensor-width 96 --sensor-height 64 --trigger-delay-us -1500 --codes e2lf-n4 --quiet 2>/dev/null
py -c 'import numpy as n; assert n.array_equal(n.load("given.npz")["codes"], n.load("stated.npz")["codes"])' || fail "the patterns of --codes"
# A network for the whole cycle says what it needs, and takes the four patterns as those of its cycle.
fails 1 "--transitions" "$E2LF" reconstruct right.npz -m e2lf-n4-cycle-camera -o out
"$E2LF" reconstruct rig.raw -m e2lf-n4-cycle-camera --codes e2lf-n4 -o cycle --quiet 2>err.txt
if grep -q "patterns-" err.txt; then fail "$(cat err.txt)"; fi
# B3: what is inverted by the option alone is said to be so.
"$E2LF" accumulate rig.raw -o twice.npz --invert-polarity --quiet 2>err.txt
grep -q "do not exchange.*(--invert-polarity)" err.txt || fail "$(cat err.txt)"
# B5: options that do not fit are named, and triggers that are there.
fails 1 "--first-pattern" "$E2LF" accumulate rig.raw -o out.npz --first-pattern 1
fails 1 "--source" "$E2LF" accumulate rig.raw -o out.npz --source bursts
"$E2LF" accumulate rig.raw -o once.npz --one-trigger-per-cycle --quiet 2>err.txt
if grep -q "polarity is inverted" err.txt; then fail "$(cat err.txt)"; fi
grep -q "triggers-of-patterns" err.txt || fail "$(cat err.txt)"
# B3: event images with inverted signs, where their file names the patterns.
network=e2lf-n4-camera
"$E2LF" simulate demo/scene -m e2lf-n4 --cycles 2 -o paper.npz --quiet
py - <<'PY'
import numpy as n
arrays = dict(n.load("right.npz"))
arrays["events"] = -arrays["events"]
n.savez("negative.npz", **arrays)
PY
"$E2LF" check negative.npz -m "$network" --json >negative.json 2>err.txt
[ "$(json negative.json "'polarity-inverted' in [f['code'] for f in j['findings']]")" = True ] || fail "$(cat negative.json)"
[ "$(json negative.json "j['verdict']")" = doubtful ] || fail "$(cat negative.json)"
"$E2LF" reconstruct negative.npz -m "$network" -o turned --invert-polarity --format npy --quiet 2>err.txt
if grep -q inverted err.txt; then fail "$(cat err.txt)"; fi
"$E2LF" reconstruct right.npz -m e2lf-n4-camera -o plain --format npy --quiet 2>err.txt
if grep -q inverted err.txt; then fail "$(cat err.txt)"; fi
# Files without stored findings whose signs or order were changed by hand: told by each verb, and right ones are not.
py - <<'PY'
import numpy as n
for name, camera in (("physical", "right.npz"), ("paper", "paper.npz")):
    arrays = dict(n.load(camera))
    arrays.pop("findings", None)
    events = arrays["events"][:1]
    for change, changed in (("right", events), ("negated", -events), ("swapped", events[:, [1, 0, 2]])):
        n.savez(f"{name}_{change}.npz", **arrays | {"events": changed})
PY
for events in physical paper; do
  for change in right:False:False negated:True:False swapped:False:True; do
    IFS=: read -r change inverted reordered <<<"$change"
    "$E2LF" reconstruct "${events}_$change.npz" -o judged --overwrite --quiet 2>err.txt
    "$E2LF" depth "${events}_$change.npz" -o judged.npy --overwrite --quiet 2>>err.txt
    for record in judged/run.json judged.npy.run.json; do
      codes="[f['code'] for f in j['notes']['findings']]"
      [ "$(json "$record" "'polarity-inverted' in $codes")" = $inverted ] || fail "$events $change $record: $(cat err.txt)"
      [ "$(json "$record" "'order-better-changed' in $codes")" = $reordered ] || fail "$events $change $record: $(cat err.txt)"
    done
  done
done
# In dim light, slow pixels make more OFF events than ON events after black.
"$E2LF" simulate demo/scene -m "$network" --camera evk4-lcos --scene-gain 0.1 -o dim.npz --quiet
"$E2LF" reconstruct dim.npz -m "$network" -o dim --format npy --quiet 2>err.txt
if grep -q inverted err.txt; then fail "$(cat err.txt)"; fi
cmp turned/cycle_00000/lightfield.npy plain/cycle_00000/lightfield.npy || fail "the light fields differ"
# B7: a method that does not know the camera says nothing about the polarity or the order of right events.
"$E2LF" reconstruct right.npz --method inversion -o rough --format npy >rough.txt 2>err.txt
if grep -q "explained much better\|probably wrong" err.txt; then fail "$(cat err.txt)"; fi
if grep -q "the difference that noise causes" rough.txt; then fail "$(cat rough.txt)"; fi
# B5: what is there against what the schedule expects, and the option that helps.
"$E2LF" codes render -m e2lf-n4 -o display --quiet
py - <<'PY'
import json
schedule = json.load(open("display/schedule.json"))
for name, scale in (("slow", 1.6), ("fast", 0.6)):
    scaled = json.loads(json.dumps(schedule))
    for pattern in scaled["patterns"]:
        pattern["duration_us"] = int(pattern["duration_us"] * scale)
        pattern["overhead_us"] = int(pattern.get("overhead_us", 0) * scale)
    json.dump(scaled, open(name + ".json", "w"))
PY
fails 1 "times" "$E2LF" accumulate rig.raw -o out.npz --schedule slow.json
fails 1 "the schedule expects 8" "$E2LF" accumulate rig.raw -o out.npz --schedule slow.json
fails 1 "times" "$E2LF" accumulate rig.raw -o out.npz --schedule fast.json
fails 1 "schedule-other" "$E2LF" accumulate rig.raw -o out.npz --patterns 7
fails 1 "channel 0 (--channel)" "$E2LF" accumulate rig.raw -o out.npz --channel 5
# B6: each trigger is drawn, the first one too, with its sign in every cycle.
"$E2LF" accumulate rig.raw -o plot.npz --report cycles.svg --quiet
py - <<'PY'
import re
svg = open("cycles.svg").read()
ticks = re.findall(r'stroke-width="1.5" stroke-opacity', svg)
assert len(ticks) >= 48, len(ticks)
PY
# Patterns that are exchanged or mirrored on the aperture, in a recording whose patterns are stated.
"$E2LF" demo -o scene --width 160 --height 120 --quiet
"$E2LF" codes show -m e2lf-n4 -o right_codes.npy >/dev/null
py - <<'PY'
import numpy as n
codes = n.load("right_codes.npy")
n.save("exchanged.npy", codes[[0, 1, 3, 2]])
n.save("mirrored.npy", n.ascontiguousarray(codes[:, :, ::-1]))
PY
for way in right_codes: exchanged:order-better-changed mirrored:orientation-better-changed; do
  "$E2LF" simulate scene/scene --codes "${way%%:*}.npy" --camera evk4-lcos --cycles 2 --seed 3 -o shown.raw --quiet --overwrite
  expected=${way#*:}
  "$E2LF" accumulate shown.raw --codes e2lf-n4 -o shown.npz --overwrite --json >shown.json 2>err.txt
  [ "$(json shown.json "[f['code'] for f in j['findings']]" | tr -d "[]'")" = "${expected:+$expected, patterns-contradicted}" ] || fail "$way: $(cat err.txt)"
  "$E2LF" check shown.raw --codes e2lf-n4 --json >page.json 2>err.txt
  [ "$(json page.json "[f['code'] for f in j['findings'] if f['code'].endswith('changed')]" | tr -d "[]'")" = "${way#*:}" ] || fail "check, $way: $(cat page.json)"
done
# A time that the recording does not contain.
fails 1 "recording-empty" "$E2LF" accumulate rig.raw -o none.npz --from-us 999999999
"$E2LF" codes show -m e2lf-n4 -o listed.json >/dev/null
fails 1 "schedule.json" "$E2LF" accumulate rig.raw -o none.npz --schedule listed.json
# Patterns that a file, the caller and the schedule state differently: which ones are used is said, in each direction.
other_codes other.npy
"$E2LF" codes render --codes other.npy -o other --quiet
fails 1 "these are 8 patterns" "$E2LF" accumulate rig.raw -o none.npz --codes e2lf-n8
for stated in "--codes other.npy" "--codes other.npy --schedule shown/schedule.json" "--codes e2lf-n4 --schedule other/schedule.json" "--schedule other/schedule.json"; do
  "$E2LF" accumulate rig.raw -o differing.npz --overwrite $stated --quiet 2>err.txt
  grep -q "patterns-contradicted" err.txt || fail "accumulate $stated: $(cat err.txt)"
done
"$E2LF" accumulate rig.raw -o agreeing.npz --codes e2lf-n4 --schedule shown/schedule.json --quiet 2>err.txt
[ ! -s err.txt ] || fail "$(cat err.txt)"
for stated in "--codes other.npy" "--codes e2lf-n4 --schedule other/schedule.json" "--schedule other/schedule.json"; do
  "$E2LF" reconstruct rig.raw -m e2lf-n4-camera $stated --max-cycles 1 -o contradicting --overwrite --quiet 2>err.txt
  grep -q "patterns-contradicted" err.txt || fail "reconstruct $stated: $(cat err.txt)"
done
# The patterns of a whole cycle are those of its event images.
"$E2LF" accumulate rig.raw -o whole.npz --transitions all --codes e2lf-n4 --quiet
"$E2LF" reconstruct whole.npz -m e2lf-n4-cycle-camera --codes e2lf-n4 -o of_whole --quiet 2>err.txt
if grep -q "patterns-" err.txt; then fail "$(cat err.txt)"; fi
# Too little light is named in place of a polarity, a delay and times that its events cannot tell; with light, never.
for light in 0.2 0.1 0.03 0.01; do
  "$E2LF" simulate demo/scene -m e2lf-n4-camera --camera evk4-lcos --cycles 6 --seed 3 --scene-gain $light -o "light$light.raw" --quiet
  "$E2LF" accumulate "light$light.raw" -o "light$light.npz" --json >light.json 2>err.txt
  found=$(json light.json "[f['code'] for f in j['findings']]")
  case "$light:$found" in
    0.03:*light-low* | 0.01:*light-low*) if grep -q "polarity-inverted\|trigger-delay\|cycles-unconfirmed" err.txt; then fail "$light: $found"; fi ;;
    0.0* | *light-low*) fail "$light: $found" ;;
  esac
done
# Leaks of dark pixels agree with the times by chance, and with an inverted polarity.
"$E2LF" simulate demo/scene -m e2lf-n4 --camera evk4-lcos --cycles 3 --scene-gain 0.01 --stream -o dark.raw --quiet
"$E2LF" accumulate dark.raw -o dark.npz --json >dark.json 2>err.txt
grep -q '"light-low"' dark.json && ! grep -q 'polarity-inverted\|trigger-delay\|cycles-unconfirmed' err.txt || fail "$(cat dark.json)"
