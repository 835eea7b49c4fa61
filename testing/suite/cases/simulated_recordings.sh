# What simulate writes, accumulate reads: for each model, sensor and source of times, with the right counts and no false finding.
"$E2LF" demo -o demo --width 96 --height 64 --quiet
"$E2LF" codes show -m e2lf-n4 -o n4.json >/dev/null
"$E2LF" codes render --codes n4.json -o display --quiet
py - <<'PY'
import json
schedule = json.load(open("display/schedule.json"))
for pattern in schedule["patterns"]:
    pattern["duration_us"] = int(pattern["duration_us"] * 1.4)
json.dump(schedule, open("slow.json", "w"))
PY
# crossing <options of simulate> -- <options of accumulate>: the recording has the counts of the event images, without a word.
crossing() {
  local simulate=() word
  while [ "$1" != -- ]; do simulate+=("$1") && shift; done
  shift
  "$E2LF" simulate "${simulate[@]}" --cycles 3 --seed 5 -o rec.raw --overwrite --quiet
  "$E2LF" simulate "${simulate[@]/--no-triggers/--quiet}" --cycles 3 --seed 5 -o counts.npz --overwrite --quiet
  "$E2LF" accumulate rec.raw -o rec.npz --overwrite --json "$@" >rec.json 2>err.txt || fail "${simulate[*]}: accumulate $*: $(cat err.txt)"
  word=$(json rec.json "[f['code'] for f in j['findings'] if f['code'] != 'patterns-undecided']")
  [ "$word" = "[]" ] || fail "${simulate[*]}: accumulate $*: $(cat err.txt)"
  check "$(json rec.json "j['least_confidence']") > 0.5"
  py -c 'import numpy as n; a, b = (n.load(f)["events"] for f in ("rec.npz", "counts.npz")); assert a.shape == b.shape and (a == b).all(), (a.shape, b.shape)' ||
    fail "${simulate[*]}: accumulate $*: the counts differ"
}
by_schedule=(--source schedule --origin-us 100000)
crossing demo/scene -m e2lf-n4 --no-triggers -- "${by_schedule[@]}"
crossing demo/scene --schedule display/schedule.json -- --schedule display/schedule.json
for model in e2lf-n4 e2lf-n8 e2lf-n4-cycle-camera; do
  crossing demo/scene -m $model --
  crossing demo/scene -m $model --stream --
  crossing demo/scene -m $model --stream --no-triggers -- "${by_schedule[@]}"
done
for events in quantised reference-aware esim v2e; do
  crossing demo/scene --codes n4.json --event-model $events --stream --
  crossing demo/scene --codes n4.json --event-model $events --stream -- "${by_schedule[@]}"
done
crossing demo/scene -m e2lf-n4 --camera evk4-lcos --stream --
crossing demo/scene -m e2lf-n4 --camera evk4-lcos --stream -- "${by_schedule[@]}"
crossing demo/scene -m e2lf-n4 --camera ideal --stream --
crossing demo/scene -m e2lf-n4 --camera evk4-lcos --stream --rise-us 1000 --leak-rate-hz 1 --shot-rate-hz 1 --refractory-us 100 --readout-limit 2e7 --
crossing demo/scene -m e2lf-n4 --stream --rise-us 2000 --
crossing demo/scene -m e2lf-n4 --stream --schedule slow.json -- --schedule slow.json
crossing --turntable 1.75 --width 96 --height 64 -m e2lf-n4 --camera evk4-lcos --
fails 1 "(--origin-us)" "$E2LF" accumulate rec.raw -o x.npz "${by_schedule[@]}" --first-pattern 4
fails 1 "(--trigger-delay-us)" "$E2LF" accumulate rec.raw -o x.npz --one-trigger-per-cycle --first-pattern 4
# A recording for the lit transitions has those of the whole cycle as well, and ends with the lit patterns.
"$E2LF" simulate demo/scene -m e2lf-n4 --cycles 3 --seed 5 -o lit.raw --quiet
"$E2LF" accumulate lit.raw --transitions all -o lit_all.npz --quiet
"$E2LF" simulate demo/scene -m e2lf-n4-cycle --cycles 3 --seed 5 -o all.npz --quiet
py -c 'import numpy as n; a, b = (n.load(f)["events"] for f in ("lit_all.npz", "all.npz")); assert len(a) == 2 and (a == b[:2]).all(), (a.shape, b.shape)'
# The next step that simulate prints works, for what needs options of its own, too.
"$E2LF" simulate demo/scene --codes n4.json --stream --schedule slow.json --no-triggers --cycles 2 -o slow.raw >out.txt
step=$(grep -o "accumulate .*" out.txt)
# shellcheck disable=SC2086
"$E2LF" $step --quiet
exists slow.npz

part defects
# Hot pixels and duplicates are named, the filter removes the former, and right recordings have neither.
"$E2LF" demo -o demo --width 160 --height 120 --quiet
rig=("$E2LF" simulate demo/scene -m e2lf-n4 --camera evk4-lcos --cycles 3 --seed 3 --quiet --stream)
codes_of() { json "$1" "[f['code'] for f in j['findings']]"; }
for share in 0 0.001 0.01; do
  "${rig[@]}" --hot-pixels $share -o hot$share.raw
  "$E2LF" accumulate hot$share.raw -o hot$share.npz --json >hot$share.json 2>/dev/null
  "$E2LF" accumulate hot$share.raw -o filtered$share.npz --filter-pixels --json >filtered$share.json 2>/dev/null
  [ "$(codes_of filtered$share.json)" = "[]" ] || fail "filtered $share: $(cat filtered$share.json)"
  "$E2LF" info hot$share.raw --json >info$share.json
  "$E2LF" video hot$share.raw -o frames$share --json >video$share.json 2>/dev/null
done
[ "$(json info0.json "j['hot_pixels']")" = 0 ] || fail "$(cat info0.json)"
check "10 <= $(json info0.001.json "j['hot_pixels']") <= 30 and 100 <= $(json info0.01.json "j['hot_pixels']") <= 200"
[ "$(codes_of video0.json)/$(codes_of video0.01.json)" = "[]/['pixels-hot']" ] || fail "$(cat video0.json video0.01.json)"
[ "$(codes_of hot0.json)" = "[]" ] || fail "$(cat hot0.json)"
[ "$(codes_of hot0.001.json)/$(codes_of hot0.01.json)" = "['pixels-hot']/['pixels-hot']" ] || fail "$(cat hot0.001.json hot0.01.json)"
[ "$(json filtered0.json "j['silenced_pixels']")" = 0 ] || fail "$(cat filtered0.json)"
# Other verbs that read recordings say so, too.
"$E2LF" reconstruct hot0.01.raw -o field --max-cycles 1 --quiet 2>err.txt
grep -q "pixels-hot.*--filter-pixels" err.txt || fail "$(cat err.txt)"
# Dim and bright light.
for gain in 0.1 4; do
  "${rig[@]}" --scene-gain $gain -o light.raw --overwrite
  "$E2LF" accumulate light.raw -o light.npz --overwrite --filter-pixels --json >light.json 2>/dev/null
  check "$(json light.json "j['silenced_pixels']") <= 2"
  [ "$(json light.json "[f['code'] for f in j['findings'] if f['code'] in ('pixels-hot', 'events-duplicate')]")" = "[]" ] || fail "gain $gain: $(cat light.json)"
done
py - <<'PY'
import numpy as n
load = lambda name: n.load(name + ".npz")["events"].astype(int)
right = load("hot0")
for share in ("0.001", "0.01"):
    before, after = (n.abs(load(name + share) - right).mean() for name in ("hot", "filtered"))
    assert after < 0.2 * before, (share, before, after)
assert n.array_equal(load("filtered0"), right)
PY
# Every event of the right half twice.
"$E2LF" convert hot0.raw once.csv --quiet
py - <<'PY'
lines = open("once.csv").read().splitlines(True)
with open("twice.csv", "w") as out:
    for line in lines:
        out.write(line)
        if line[0].isdigit() and int(line.split(",")[0]) >= 80: out.write(line)
PY
cp once_triggers.csv twice_triggers.csv
"$E2LF" accumulate twice.csv --sensor-width 160 --sensor-height 120 -o twice.npz --json >twice.json 2>err.txt
[ "$(codes_of twice.json)" = "['events-duplicate']" ] || fail "$(cat err.txt)"
check "abs($(json twice.json "j['findings'][0]['figures']['share']") - 1 / 3) < 0.05"
