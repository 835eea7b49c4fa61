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
text = re.sub(r"^//.*$", "", open("$SOURCES/cameras/evk4-lcos.json").read(), flags=re.M)
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
fails 1 '--camera' "$E2LF" reconstruct paper.npz -m "$SOURCES/models/e2lf-n4.safetensors" --camera paper -o x
absent x.npz x

# Events say which camera recorded them, in every format and through every step; a network that asks is told that one.
told="$SOURCES/models/e2lf-n4-capture.safetensors"
stated_by() { "$E2LF" reconstruct "$@" -m "$told" -o told --overwrite --quiet 2>/dev/null; json told/run.json 'j["notes"]["camera_stated_by"], j["notes"]["camera"]["name"]'; }
[ "$(stated_by paper.npz)" = "(\"the events' file\", 'paper')" ] || fail "the paper's pixels: $(stated_by paper.npz)"
[ "$(stated_by real.npz --camera paper)" = "('--camera', 'paper')" ] || fail "--camera: $(stated_by real.npz --camera paper)"
py - <<'EOF'
import numpy as np
np.savez("bare.npz", events=np.load("real.npz")["events"])
EOF
[ "$(stated_by bare.npz)" = "('the model', 'evk4-lcos')" ] || fail "no camera: $(stated_by bare.npz)"
"$E2LF" simulate scene --tau 0.25 -o rec.raw --quiet
"$E2LF" simulate scene --tau 0.25 -o rec.csv --quiet 2>/dev/null
"$E2LF" convert rec.raw rec.dat --quiet
for recording in rec.raw rec.csv rec.dat; do
  "$E2LF" accumulate "$recording" -o acc.npz --overwrite --quiet 2>/dev/null
  py - <<'EOF' || fail "the camera of $recording"
import json
import numpy as np
camera = json.loads(np.load("acc.npz")["camera"].tobytes())
assert camera["event_model"] == "reference-aware" and camera["constants"]["tau"]["value"] == 0.25, camera
EOF
done

# Which network fits: that of the patterns and the kind of pixels, where none is named; another one is warned of.
models=$SOURCES/models
for camera in paper evk4-lcos; do
  "$E2LF" simulate scene --camera $camera -m "$models/e2lf-n4.safetensors" --seed 3 -o "own-$camera.npz" --quiet
  "$E2LF" reconstruct "own-$camera.npz" -o "chosen-$camera" --quiet
done
[ "$(json chosen-paper/run.json 'j["inputs"][-1]["path"].split("/")[-1], j["inputs"][0]["path"].split("/")[-1]')" = "('own-paper.npz', 'e2lf-n4-geometry.safetensors')" ] || fail "a network for the paper's pixels"
[ "$(json chosen-evk4-lcos/run.json 'j["inputs"][0]["path"].split("/")[-1]')" = e2lf-n4-geometry-camera.safetensors ] || fail "a network for physical pixels"
[ "$(json chosen-paper/run.json '[i["path"].split("/")[-1] for i in j["inputs"]].count("e2lf-n4-depth.safetensors")')" = 1 ] || fail "the record names the parts"
# Events of a camera that nothing states are those of physical pixels with the default profile.
py -c 'import numpy as np; e = np.load("own-evk4-lcos.npz"); np.savez("unstated.npz", **{k: e[k] for k in e if k != "camera"})'
"$E2LF" reconstruct unstated.npz -o unstated 2>unstated.txt
[ "$(json unstated/run.json 'j["options"]["model"], j["notes"]["camera_stated_by"], j["notes"]["camera"]["name"]')" = "('e2lf-n4-geometry-camera', 'the model', 'evk4-lcos')" ] || fail "a network for an unknown sensor: $(json unstated/run.json 'j["options"], j["notes"]["camera_stated_by"]')"
grep -q "no sensor is stated" unstated.txt || fail "it is not said: $(cat unstated.txt)"
cmp unstated/cycle_00000/00_00.png chosen-evk4-lcos/cycle_00000/00_00.png 2>/dev/null || cmp unstated/00_00.png chosen-evk4-lcos/00_00.png || fail "another light field"
"$E2LF" simulate scene -m "$models/e2lf-n8.safetensors" -o eight.npz --quiet
"$E2LF" reconstruct eight.npz -o eight --quiet
[ "$(json eight/run.json 'j["inputs"][0]["path"].split("/")[-1]')" = e2lf-n8.safetensors ] || fail "a network for eight patterns"
"$E2LF" reconstruct own-evk4-lcos.npz -m "$models/e2lf-n4.safetensors" -o never_seen 2>warned.txt
grep -q "pixels-foreign" warned.txt || fail "no warning: $(cat warned.txt)"
# The check simulates that camera: the right network explains the events better.
error_of() { json "$1/run.json" 'j["notes"]["cycles"][0]["event_error"]'; }
check "$(error_of chosen-evk4-lcos) < 0.6 * $(error_of never_seen)"
"$E2LF" reconstruct own-evk4-lcos.npz --method inversion -o inverted 2>warned.txt
grep -q "event.*model" warned.txt || fail "no warning: $(cat warned.txt)"
other_codes other.npy
"$E2LF" simulate scene --codes other.npy --camera evk4-lcos -o other.npz --quiet
"$E2LF" reconstruct other.npz -o adapted 2>err.txt
grep -q "e2lf-any, adapted to these patterns, for physical pixels" err.txt || fail "$(cat err.txt)"
fails 1 "bare.npz" "$E2LF" reconstruct bare.npz -o x
py - <<'EOF'
import numpy as np
np.savez("odd.npz", events=np.load("real.npz")["events"], camera=np.frombuffer(b"{}", np.uint8))
EOF
fails 1 'odd.npz: camera' "$E2LF" reconstruct odd.npz -m "$told" -o x
absent x
