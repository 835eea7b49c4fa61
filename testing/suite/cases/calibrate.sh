# Calibration: a simulated camera is found again from even patches behind known open areas; the result is a camera file.
py - <<'PY'
import numpy as np
values = 0.01 * 1.35 ** (np.arange(15) * 7 % 15)
scene = np.kron(values.reshape(3, 5), np.ones((100, 100)))
np.save("scene.npy", np.broadcast_to(scene, (8, 8, 300, 500)).astype(np.float32))
np.save("codes.npy", np.multiply.outer([0, 0.125, 0.75, 0.25], np.ones((8, 8))).astype(np.float32))
PY
"$E2LF" simulate scene.npy --codes codes.npy --camera evk4-lcos --cycles 4 --seed 5 -o events.npz --quiet
py - <<PY
import json, re
camera = json.loads(re.sub(r"^ *//.*$", "", open("$SOURCES/cameras/evk4-lcos.json").read(), flags=re.M))
camera["constants"]["threshold_on"]["value"] *= 1.15
camera["constants"]["threshold_off"]["value"] *= 0.9
json.dump(camera, open("guess.json", "w"))
PY
"$E2LF" calibrate events.npz --even --camera guess.json --hold receptor_rate_hz,leak -o mine.json --json >report.json 2>messages.txt
# A constant that leaves the uncertainty of the starting camera is warned of by its name.
grep -q 'threshold_on went from' messages.txt || fail "no warning: $(cat messages.txt)"
cat >compare.py <<PY
import json, re
truth = json.loads(re.sub(r"^ *//.*$", "", open("$SOURCES/cameras/evk4-lcos.json").read(), flags=re.M))["constants"]
guess, found, report = (json.load(open(name + ".json")) for name in ("guess", "mine", "report"))
for key in ("threshold_on", "threshold_off"):
    value, true = found["constants"][key]["value"], truth[key]["value"]
    assert abs(value / true - 1) < 0.03, (key, value, true)
for key in ("receptor_rate_hz", "leak"):
    assert found["constants"][key]["value"] == guess["constants"][key]["value"], key
told = {each["key"]: each for each in report["constants"]}
assert told["threshold_on"]["is_determined"] and "leak" not in told
assert told["threshold_on"]["low"] < found["constants"]["threshold_on"]["value"] < told["threshold_on"]["high"]
assert found["name"] == "mine" and found["constants"]["threshold_on"]["source"] == "e2lf calibrate"
assert len(report["rows"]) >= 3 and all(row["total_variation"] < 0.1 for row in report["rows"]), report["rows"]
PY
py compare.py
exists mine.json.run.json
"$E2LF" simulate scene.npy --codes codes.npy --camera mine.json -o again.npz --quiet

# A whole cycle determines more than its lit transitions, and its constants are the same.
py - <<'PY'
import numpy as np
shares = [0, 0.125, 0.75, 0.25, 1, 0.875, 0.25, 0.75, 0]
np.save("whole.npy", np.multiply.outer(shares, np.ones((8, 8))).astype(np.float32))
PY
"$E2LF" simulate scene.npy --codes whole.npy --camera evk4-lcos --cycles 4 --seed 5 -o whole.npz --quiet
"$E2LF" calibrate whole.npz --even --camera guess.json --hold receptor_rate_hz,leak -o whole.json >report.txt 2>messages.txt
# The report explains its table and says which command uses the result.
grep -q "each row: places of one brightness" report.txt || fail "$(cat report.txt)"
grep -q "next: e2lf reconstruct whole.npz --camera whole.json -o whole" report.txt || fail "$(cat report.txt)"
"$E2LF" calibrate whole.npz --even --camera guess.json --hold receptor_rate_hz,leak --transitions lit -o lit.json --quiet
for name in whole lit; do
  check "abs($(json $name.json "j['constants']['threshold_on']['value']") / 0.405 - 1) < 0.05"
  [ "$(json $name.json.run.json "len(j['notes']['report']['rows'][0]['measured']['mean'])")" = $([ $name = whole ] && echo 8 || echo 3) ] || fail $name
done
check "$(json whole.json "j['constants']['threshold_on']['uncertainty']") < $(json lit.json "j['constants']['threshold_on']['uncertainty']")"

# The options of a recording belong to the next command, too.
"$E2LF" simulate scene.npy --codes codes.npy --camera evk4-lcos --cycles 4 -o rig.raw --no-triggers --quiet
"$E2LF" calibrate rig.raw --even --source schedule --origin-us 100000 --codes codes.npy -o rig.json --overwrite >report.txt 2>messages.txt
grep -q "next: e2lf reconstruct rig.raw --codes codes.npy --source schedule --origin-us 100000 --camera rig.json -o rig" report.txt || fail "$(cat report.txt)"

fails 1 'already' "$E2LF" calibrate events.npz --camera guess.json -o mine.json
fails 1 'name them once' "$E2LF" calibrate events.npz events.npz -o x.json
fails 1 'model pixel' "$E2LF" calibrate events.npz --camera paper -o x.json
fails 1 'threshold_on' "$E2LF" calibrate events.npz --hold threshold_onn -o x.json
py -c 'import numpy as np; np.save("bare.npy", np.load("events.npz")["events"])'
fails 1 '--codes' "$E2LF" calibrate bare.npy -o x.json
py -c 'import numpy as np; np.save("board.npy", np.repeat(4 * (np.indices((160, 160)) // 6).sum(0)[None] % 8, 3, 0).astype(np.int16))'
fails 1 'flat areas' "$E2LF" calibrate board.npy -m "$SOURCES/models/e2lf-n4.safetensors" -o x.json
absent x.json x.json.run.json
