# The viewer in a browser: every picture against known numbers, and what its server must not do.
viewer=$SOURCES/viewer
grep -q "This build has no viewer" <<<"$("$E2LF" view --help)" && skip "this build has no viewer (npm or libcpp-httplib-dev was not found)"
command -v chromium >/dev/null || skip "chromium is not installed"

py "$viewer/test/inputs.py" .
mkdir -p cycles/cycle_00000 cycles/cycle_00001 linked
cp light.npy cycles/cycle_00000/lightfield.npy
cp other.npy cycles/cycle_00001/lightfield.npy
cp light.npy linked/lightfield.npy
echo treasure >secret.txt
ln -s ../secret.txt linked/secret.txt

"$E2LF" demo -o demo --width 64 --height 48 --quiet
"$E2LF" depth demo/recon -o depth --quiet
"$E2LF" view demo/recon --disparity depth --export depth.html --quiet
"$E2LF" view depth --export depth_alone.html --quiet
cp -r depth gone && sed -i 's/"demo.recon"/"nowhere"/' gone/run.json
"$E2LF" view gone --export map_alone.html --quiet
"$E2LF" view demo/scene demo/recon --export truth.html --quiet
"$E2LF" eval demo/scene demo/recon --json >quality.json 2>eval.log
"$E2LF" eval demo/scene demo/recon --fit-gain --json >fitted.json 2>eval.log
"$E2LF" simulate demo/scene -m "$SOURCES/models/e2lf-n4.safetensors" -o capture.raw --quiet
"$E2LF" view light.npy --export light.html --quiet
exists light.html light.html.run.json
fails 1 "(--overwrite)" "$E2LF" view light.npy --export light.html
mkdir empty
fails 1 "neither event" "$E2LF" view empty --export none.html
fails 1 "nowhere" "$E2LF" view nowhere
absent none.html
"$E2LF" view light.npy other.npy --export compare.html --quiet
"$E2LF" view light.npy --disparity disparity.npy --export disparity.html --quiet
"$E2LF" view light.npy --disparity true_disparity.npy --export between.html --quiet
"$E2LF" view light.npy --disparity planes --export surface.html --quiet
py - <<'PY'
import numpy as np
np.save("small.npy", np.zeros((4, 5), np.float32))
PY
fails 1 "small.npy: has 5x4 px" "$E2LF" view light.npy --disparity small.npy --export none.html
fails 1 "nowhere.npy" "$E2LF" view light.npy --disparity nowhere.npy --export none.html
fails 1 "--disparity" "$E2LF" view events.npz --disparity disparity.npy --export none.html
absent none.html
"$E2LF" view colour.npy --export colour.html --quiet
"$E2LF" view fine.npy --export fine.html --quiet
"$E2LF" view cycles --export cycles.html --quiet
# A map for each cycle, of the view that the record of e2lf depth names.
"$E2LF" depth cycles -o cycle_depth --view-row 3 --view-column 2 --quiet
"$E2LF" view cycles --disparity cycle_depth --export cycle_depth.html --quiet
"$E2LF" view cycle_depth/cycle_00001 --export depth_of_cycle.html --quiet
py - <<'PY'
import json, re
text = re.search(r'id="e2lf-document"[^>]*>(.*?)</script>', open("cycle_depth.html").read(), re.S).group(1)
disparity = json.loads(text)["items"][0]["disparity"]
assert len(disparity["maps"]) == 2 and disparity["view"] == [3, 2], disparity
PY
"$E2LF" view events.npz --export events.html --quiet
"$E2LF" view capture.raw --frames 20 --export recording.html --quiet
"$E2LF" view "$SOURCES/models/e2lf-n4.safetensors" --export model.html --quiet
"$E2LF" view light.npy other.npy events.npz "$SOURCES/models/e2lf-n4.safetensors" --export all.html --quiet

"$E2LF" simulate demo/scene -m "$SOURCES/models/e2lf-n4.safetensors" --cycles 40 -o long.raw --quiet
"$E2LF" reconstruct long.raw -m "$SOURCES/models/e2lf-n4.safetensors" --format npy -o long --quiet

E2LF=$E2LF E2LF_MODEL=$SOURCES/models/e2lf-n4.safetensors node "$viewer/test/run.mjs"
