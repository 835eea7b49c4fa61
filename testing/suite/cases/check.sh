# One page on a rig: a right one, one in the dark, one with hot pixels, one without triggers, and one that is live.
"$E2LF" demo -o scene --width 160 --height 120 --quiet
rig=("$E2LF" simulate scene/scene --codes e2lf-n4 --camera evk4-lcos --seed 3 --quiet)
"${rig[@]}" --cycles 4 -o right.raw
"${rig[@]}" --cycles 4 --hot-pixels 0.003 -o hot.raw
"${rig[@]}" --cycles 2 --scene-gain 0.001 -o dark.raw
codes_of() { json "$1" "sorted(f['code'] for f in j['findings'] if f['severity'] != 'note')" | tr -d "[]',"; }

"$E2LF" check right.raw --json >right.json 2>err.txt
[ -z "$(codes_of right.json)" ] || fail "$(cat right.json)"
[ "$(json right.json "j['verdict'] in ('good', 'usual')")" = True ] || fail "$(cat right.json)"
[ "$(json right.json "(j['cycles'], j['width'], j['height'], j['fits'][0]['camera'])")" = "(4, 160, 120, 'evk4-lcos')" ] || fail "$(cat right.json)"
check "0.5 < $(json right.json "j['events_per_pixel']") < 20"
check "$(json right.json "min(j['changes'].values())") > 0.97"
check "abs($(json right.json "j['recording']['events']") - $("$E2LF" info right.raw --json | py -c "import json, sys; print(json.load(sys.stdin)['events'])")) == 0"
# The page says the same, and what to do next.
"$E2LF" check right.raw >page.txt 2>err.txt
for name in events light pixels triggers patterns order verdict; do grep -q "^$name " page.txt || fail "no $name: $(cat page.txt)"; done
grep -q "^next .*e2lf reconstruct right.raw" page.txt || fail "$(cat page.txt)"

# The next command keeps the options that decide what is read.
"$E2LF" check right.raw --seconds 3 --codes e2lf-n4 --source triggers --camera evk4-lcos --json >given.json 2>err.txt
[ "$(json given.json "j['next']")" = "e2lf reconstruct right.raw --codes e2lf-n4 --source triggers --camera evk4-lcos -o recon" ] || fail "$(cat given.json)"

# Patterns that are not stated are found among those of the bundled models.
"$E2LF" accumulate right.raw -o right.npz --quiet
py -c 'import numpy as n; n.savez("bare.npz", events=n.load("right.npz")["events"])'
"$E2LF" check bare.npz --json >bare.json 2>err.txt
[ "$(json bare.json "j['fits'][0]['patterns']")" = e2lf-n4 ] || fail "$(cat bare.json)"
[ "$(json bare.json "j['verdict'] in ('unconfirmed', 'doubtful')")" = True ] || fail "$(cat bare.json)"

"$E2LF" check hot.raw --json >hot.json 2>err.txt
check "40 <= $(json hot.json "j['hot_pixels']") <= 70"
grep -q pixels-hot <<<"$(codes_of hot.json)" || fail "$(cat hot.json)"
"$E2LF" check dark.raw --json >dark.json 2>err.txt
[ "$(json dark.json "j['verdict']")" = doubtful ] || fail "$(cat dark.json)"
"$E2LF" check right.raw --one-trigger-per-cycle --json >once.json 2>err.txt
grep -q triggers-of-patterns <<<"$(codes_of once.json)" || fail "$(cat once.json)"
# Without the page, findings are warnings.
"$E2LF" check dark.raw --quiet >page.txt 2>err.txt
[ ! -s page.txt ] && grep -q light-low err.txt || fail "$(cat page.txt err.txt)"
fails 1 "--transitions" "$E2LF" check right.npz --transitions lit
# No complete cycle is a page, too; live input ends by itself.
"$E2LF" check right.raw --relative --to-us 30000 --json >short.json 2>err.txt
[ "$(json short.json "(j['cycles'], j['verdict'])")" = "(0, 'doubtful')" ] || fail "$(cat short.json)"
"$E2LF" check replay:right.raw --seconds 0.2 --json >live.json 2>err.txt
check "$(json live.json "j['cycles']") < 4"
"$E2LF" check replay:right.raw --json >live.json 2>err.txt
check "$(json live.json "j['cycles']") == 4"
