# Exported models in ONNX Runtime: the same views as our engine's, of images of any size.
command -v node >/dev/null || skip "node is not installed"
# Exact versions are in package.json; npm fetches them once into the build folder.
if [ "$TESTSUITE/onnx/package.json" -nt "$E2LF_BUILD/onnx/.installed" ]; then
  mkdir -p "$E2LF_BUILD/onnx"
  cp "$TESTSUITE/onnx/package.json" "$E2LF_BUILD/onnx"
  (cd "$E2LF_BUILD/onnx" && timeout 300 npm install --no-package-lock --ignore-scripts --silent) ||
    skip "npm could not fetch onnxruntime-node"
  touch "$E2LF_BUILD/onnx/.installed"
fi
models=$SOURCES/models

cat >inputs.py <<'PY'
import json, sys
import numpy as np
events, about = sys.argv[1:]
about = json.load(open(about))
inputs = {"events": np.load(events)["events"].astype(np.float32)}
inputs["events"] = inputs["events"].reshape(-1, *inputs["events"].shape[-3:])
if "traits" in about:
    inputs["traits"] = np.tile(np.float32(about["traits"]), (len(inputs["events"]), 1))
for name, values in inputs.items():
    values.tofile(name + ".f32")
json.dump({name: {"shape": values.shape, "file": name + ".f32"} for name, values in inputs.items()}, open("inputs.json", "w"))
PY
cat >compare.py <<'PY'
import sys
import numpy as np
ours = np.stack([np.load(folder + "/lightfield.npy") for folder in sys.argv[2:]])
theirs = np.fromfile("views.f32", np.float32).reshape(ours.shape)
error = np.abs(ours - theirs).max()
print(sys.argv[1], ours.shape, "largest difference from ONNX Runtime:", error, "deviation:", ours.std())
assert error < 1e-4 and ours.std() > 0.005
PY

# same_views <model> <events.npz> <folders of light fields...>: what e2lf made of the events, against ONNX Runtime.
same_views() {
  local model=$1 events=$2
  shift 2
  "$E2LF" model export "$model" -o model.onnx --json --overwrite "${camera[@]}" >about.json
  py inputs.py "$events" about.json
  ONNX_PACKAGES=$E2LF_BUILD/onnx node "$TESTSUITE/onnx/run.mjs" model.onnx inputs.json views.f32
  py compare.py "$(basename "$model")" "$@"
}
network_output=(--gain 1 --format npy --precision float32 --quiet)

# A width and a height that no network takes as they are; the patterns are of no matter here, and the file shall not tell
# the camera.
"$E2LF" demo -m "$models/e2lf-n4.safetensors" -o demo --width 101 --height 67 --quiet
py -c 'import numpy as np; np.savez("events.npz", events=np.load("demo/events.npz")["events"])'
"$E2LF" simulate demo/scene -m "$models/e2lf-n8.safetensors" -o simulated.npz --quiet
py -c 'import numpy as np; np.savez("eight.npz", events=np.load("simulated.npz")["events"])'
py "$TESTSUITE/geometry_models.py" "$models/e2lf-n4.safetensors"
for model in any depth n4-capture-geometry; do "$E2LF" model store e2lf-$model --codes e2lf-n4 -o $model-adapted.safetensors --quiet; done
for model in "$models"/*.safetensors layers.safetensors any-adapted.safetensors n4-capture-geometry-adapted.safetensors; do
  camera=()
  name=$(basename "$model" .safetensors)
  [[ $name != *-depth && $name != *-depth-first ]] || continue  # see below
  [[ $name != e2lf-any && $name != e2lf-n4-capture-geometry ]] || continue  # take no patterns as they are
  events=events.npz
  [[ $name != e2lf-n8* ]] || events=eight.npz
  [[ $name != *cycle* ]] || continue  # of eight images, as that of e2lf-n8
  "$E2LF" reconstruct "$events" -m "$model" -o "$name" "${network_output[@]}"
  same_views "$model" "$events" "$name"
done

# Networks for disparities have a location and a logarithm of a scale.
for model in "$models"/e2lf-n4-depth.safetensors depth.safetensors depth-adapted.safetensors; do
  [ -e "$model" ] || continue
  "$E2LF" depth events.npz -m "$model" -o disparity.npy --precision float32 --quiet --overwrite
  "$E2LF" model export "$model" -o model.onnx --json --overwrite >about.json
  py inputs.py events.npz about.json
  ONNX_PACKAGES=$E2LF_BUILD/onnx node "$TESTSUITE/onnx/run.mjs" model.onnx inputs.json disparity.f32
  py - "$model" <<'PY'
import sys
import numpy as np
ours = np.load("disparity.npy")
theirs = np.fromfile("disparity.f32", np.float32).reshape(2, *ours.shape)[0]
error = np.abs(ours - theirs).max()
print(sys.argv[1], ours.shape, "largest difference from ONNX Runtime:", error, "deviation:", ours.std())
assert error < 1e-4 and ours.std() > 0.005
PY
done

# The camera is told, and is in what the graph makes of counts.
camera=(--camera paper)
model=$models/e2lf-n4-camera.safetensors
"$E2LF" reconstruct events.npz -m "$model" "${camera[@]}" -o told "${network_output[@]}"
same_views "$model" events.npz told
py -c 'import numpy as np; a, b = (np.load(f + "/lightfield.npy") for f in ("told", "e2lf-n4-camera")); assert abs(a - b).max() > 0.01'
fails 1 "single camera" "$E2LF" model export "$models/e2lf-n4.safetensors" -o other.onnx --camera paper

# The lines of docs/models.md.
"$E2LF" model export "$models/e2lf-n4.safetensors" -o e2lf-n4.onnx --quiet
ln -s "$E2LF_BUILD/onnx/node_modules" node_modules
py inputs.py events.npz about.json
{
  echo "import { readFileSync, writeFileSync } from 'node:fs';"
  echo "const [height, width, counts] = [67, 101, new Float32Array(readFileSync('events.f32').buffer)];"
  py "$TESTSUITE/documents/documents.py" block "$SOURCES/docs/models.md" onnxruntime-node
  echo "writeFileSync('views.f32', Buffer.from(views.data.buffer, views.data.byteOffset, views.data.byteLength));"
} >lines.mjs
node lines.mjs
py compare.py "docs/models.md" e2lf-n4

# Several cycles are a batch.
camera=()
py - <<'PY'
import numpy as np
events = np.load("demo/events.npz")["events"].reshape(3, 67, 101)
np.savez("two.npz", events=np.stack([events, events[:, ::-1, ::-1]]))
PY
"$E2LF" reconstruct two.npz -m "$models/e2lf-n4.safetensors" -o two "${network_output[@]}"
same_views "$models/e2lf-n4.safetensors" two.npz two/cycle_00000 two/cycle_00001

# An export is an output as any other.
exists model.onnx.run.json
fails 1 "--overwrite" "$E2LF" model export "$model" -o model.onnx
fails 1 ".onnx" "$E2LF" model export "$model" -o model.pt

# The paper's network, and its capture.
if [ -n "${E2LF_DATA:-}" ] && [ -e "$E2LF_DATA/official/Animals" ]; then
  "$E2LF" model import --release "$E2LF_DATA/official" -o release.safetensors --quiet
  py - "$E2LF_DATA/official/Animals" <<'PY'
import sys
import numpy as np
crop = [np.load(f"{sys.argv[1]}/event_image_{k:05d}.npy").squeeze()[328:392, 608:704] for k in range(3)]
np.savez("capture.npz", events=np.stack(crop).astype(np.int16))
PY
  for model in release.safetensors "$models/e2lf-n4-capture.safetensors"; do
    name=capture_$(basename "$model" .safetensors)
    "$E2LF" reconstruct capture.npz -m "$model" -o "$name" "${network_output[@]}"
    same_views "$model" capture.npz "$name"
  done
fi
