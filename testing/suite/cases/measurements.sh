# Intensity images beside event images: simulated, described, taken by networks that were trained for them and by no other.
"$E2LF" demo -o demo --width 64 --height 48 --quiet
check_info() { # file, expression on the answer of info
  "$E2LF" info "$1" --json >info.json
  check "$(json info.json "$2")"
}
"$E2LF" simulate demo/scene --measurement coded-images -o coded.npz --quiet
"$E2LF" simulate demo/scene --measurement hybrid --sigma-i 0 -o hybrid.npz --seed 4 --quiet --json >hybrid.json
"$E2LF" simulate demo/scene --measurement lens-array --sigma-i 0 -o lens.npz --quiet
"$E2LF" simulate demo/scene -o events.npz --seed 4 --quiet --json >events.json
check_info coded.npz "(j['measurement'], j['images'], j['transitions'], j['codes']) == ('coded-images', 4, 0, True)"
check "$(json hybrid.json "(j['measurement'], j['images'], j['height'], j['width']) == ('hybrid', 1, 48, 64)")"
check "$(json hybrid.json "{**j, 'measurement': 'event-images', 'images': 0} == __import__('json').load(open('events.json'))")"
check_info hybrid.npz "(j['measurement'], j['images'], j['transitions']) == ('hybrid', 1, 3)"
check_info lens.npz "(j['measurement'], j['images'], j['height'], j['width']) == ('lens-array', 1, 48, 64)"

# What the arrays hold, from the views and the patterns.
py - <<'PY'
import json, pathlib
import numpy as np
hybrid, events, coded = np.load("hybrid.npz"), np.load("events.npz"), np.load("coded.npz")
lens = np.load("lens.npz")["lens_array"][0]
assert (hybrid["events"] == events["events"]).all(), "the same seed makes the same events"
ideal = coded["images"][0].sum(0)
error = hybrid["images"][0, 0] - ideal
assert abs(error.mean()) < 0.002 and abs(error.std() - 2 * 0.005) < 0.001, (error.mean(), error.std())
# Under each lens the views: their mean is that of the coded image of an open aperture.
assert lens.shape == (48, 64) and 0 <= lens.min() and lens.max() <= 1
PY

fails 1 "network" "$E2LF" reconstruct coded.npz -o no
fails 1 "network" "$E2LF" reconstruct hybrid.npz --method inversion -o no
fails 1 "e2lf-n4 takes event-images" "$E2LF" reconstruct hybrid.npz -m "$SOURCES/models/e2lf-n4.safetensors" -o no
fails 1 "stream" "$E2LF" simulate demo/scene --measurement hybrid -o rec.raw
fails 1 "event images" "$E2LF" simulate demo/scene --sigma-i 0.1 -o no.npz
for unused in "--measurement coded-images --tau 0.2" "--measurement lens-array --event-model quantised" "--event-model esim --sigma-w 0.1" "--event-model v2e --eps 0.02"; do
  option=${unused% *}
  fails 1 "${option##* }: has no effect" "$E2LF" simulate demo/scene $unused -o no.npz
done
fails 1 "measurement \"picture\"" "$E2LF" simulate demo/scene --measurement picture -o no.npz
fails 1 "requires event images" "$E2LF" calibrate coded.npz -o no.json
fails 1 "measurements" "$E2LF" view coded.npz --export no.html
absent no no.npz rec.raw no.json no.html

# A network for each measurement: trained for a moment, it takes what it was trained for, in `compare`, too.
[ -x "$(dirname "$E2LF")/e2lf-train" ] || skip "e2lf was built without torch"
cat >tiny.json <<'JSON'
{
  "data": {"synthetic_share": 1, "pool": 4, "synthesiser": {"size": 32}},
  "patterns": {"begin_step": 1, "learn_steps": 3}, "network": {"widths": [8], "blocks": [1], "head_width": 8},
  "train": {"patch": 32, "batch": 2, "steps": 4, "warmup_steps": 1, "evaluate_steps": 4, "checkpoint_steps": 4}
}
JSON
train() { # name, input, further settings
  local name=$1 input=$2
  shift 2
  "$E2LF" train tiny.json -o "run_$name" --quiet --set "name=$name" --set "input=$input" --set patterns.black_first=false "$@"
  "$E2LF" simulate demo/scene -m "run_$name/$name.safetensors" -o "own_$name.npz" --quiet
  "$E2LF" reconstruct "own_$name.npz" -m "run_$name/$name.safetensors" --gain 1 --precision float32 --format npy -o "lf_$name" --quiet
  "$E2LF" eval demo/scene "lf_$name" --json >"$name.json"
}
train ca1 '[{"kind": "images", "scale": 4}]' --set patterns.num_patterns=1
train hybrid '[{"kind": "counts", "scale": 0.125}, {"kind": "image-sum", "scale": 1}]' --set patterns.complementary=true
train lens '[{"kind": "lens-array", "scale": 1}]' --set patterns.num_patterns=1
"$E2LF" model info run_hybrid/hybrid.safetensors >info.txt
grep -Eq "^measurement +hybrid" info.txt || fail "model info"
fails 1 "takes lens-array" "$E2LF" reconstruct own_ca1.npz -m run_lens/lens.safetensors -o no
fails 1 "exported networks" "$E2LF" model export run_lens/lens.safetensors -o no.onnx
cat >c.json <<'JSON'
{"methods": [{"name": "ca1", "model": "run_ca1/ca1.safetensors"}, {"name": "hybrid", "model": "run_hybrid/hybrid.safetensors"},
             {"name": "lens", "model": "run_lens/lens.safetensors"}],
 "scenes": [{"name": "g", "scenes": ["demo/scene"]}], "seeds": [1]}
JSON
"$E2LF" compare c.json -o compared --json --quiet >compared.json
py - <<'PY'
import json
for row in json.load(open("compared.json"))["results"]:
    other = json.load(open(row["method"] + ".json"))
    assert abs(row["psnr_db"] - other["psnr_db"]) < 1e-4, (row["method"], row["psnr_db"], other["psnr_db"])
    assert (row["events_per_pixel"] > 0) == (row["method"] == "hybrid"), row
PY
