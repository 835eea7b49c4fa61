# Cameras: simulation with physical pixels, bundled names, and what does not go together.
"$E2LF" demo -o demo --width 64 --height 48 --quiet
cp -r demo/scene scene
"$E2LF" simulate scene --camera evk4-lcos --seed 3 -o real.npz
"$E2LF" simulate scene --camera evk4-lcos --seed 3 -o again.npz
"$E2LF" simulate scene --camera paper --seed 3 -o named.npz
"$E2LF" simulate scene --seed 3 -o paper.npz
cat >compare.py <<'PY'
import numpy as np
events = {name: np.load(name + ".npz")["events"] for name in ("real", "again", "named", "paper")}
assert (events["real"] == events["again"]).all(), "the same seed gives the same events"
assert (events["named"] == events["paper"]).all(), "the paper's camera is the default"
assert (events["real"] != events["paper"]).any(), "physical pixels make other events"
assert np.abs(events["real"]).sum() > 0
PY
py compare.py
[ "$(json real.npz.run.json 'j["notes"]["camera"]["name"]')" = evk4-lcos ] || fail "the record names the camera"

# The thresholds of pixels stay from cycle to cycle: a camera without noise repeats itself.
py - <<PY
import json, re
text = re.sub(r"^//.*$", "", open("$TESTSUITE/../cameras/evk4-lcos.json").read(), flags=re.M)
camera = json.loads(text)
for key in ("noise", "shot_noise", "reset_span", "dark_off", "dark_on"):
    camera["constants"][key]["value"] = 0
json.dump(camera, open("still.json", "w"))
camera["constants"]["leek"] = camera["constants"].pop("leak")
json.dump(camera, open("wrong.json", "w"))
PY
"$E2LF" simulate scene --camera still.json --cycles 2 -o still.npz
py -c 'import numpy as np; e = np.load("still.npz")["events"]; assert (e[0] == e[1]).all() and np.abs(e).sum() > 0'

fails 1 'evk4-lcos' "$E2LF" simulate scene --camera nobodys -o x.npz
fails 1 'leak' "$E2LF" simulate scene --camera wrong.json -o x.npz
fails 1 'leave them out' "$E2LF" simulate scene --camera evk4-lcos --tau 0.2 -o x.npz
fails 1 'leave --camera out' "$E2LF" reconstruct paper.npz -m "$TESTSUITE/../models/e2lf-n4.safetensors" --camera paper -o x
absent x.npz x
