# The demo makes its pictures, says how good they are, and refuses to overwrite them unasked.
"$E2LF" demo -o demo --width 96 --height 64 --json >result.json
exists demo/scene/00_00.png demo/scene/07_07.png demo/events.npz demo/events.png demo/recon/07_07.png demo/recon/contact_sheet.png \
  demo/recon/epi.png demo/refocus_near.png demo/refocus_far.png demo/run.json
if "$E2LF" --version | grep "^viewer: ON" >/dev/null; then
  grep -q "reconstruction" demo/index.html || fail "the page"
fi
check "$(json result.json "j['psnr_db']") > 15"
fails 1 "(--overwrite)" "$E2LF" demo -o demo --width 96 --height 64
"$E2LF" demo -o demo --width 96 --height 64 --overwrite --quiet >quiet.txt
[ ! -s quiet.txt ] || fail "--quiet printed something"

# The demo's own files go through the other verbs, with the same figures.
"$E2LF" eval demo/scene demo/recon --json >eval.json
check "abs($(json eval.json "j['psnr_db']") - $(json result.json "j['psnr_db']")) < 0.2"
if [ -f demo/index.html ]; then
  # The page fits the brightness of the pictures that the files contain.
  "$E2LF" eval demo/scene demo/recon --fit-gain --json >fitted.json
  py - <<'PY'
import json, re
text = re.search(r'id="e2lf-document"[^>]*>(.*?)</script>', open("demo/index.html").read(), re.S).group(1)
gain, black = json.loads(text)["comparisons"][0]["cycles"][0]["tone"]
fitted = json.load(open("fitted.json"))
assert abs(gain - fitted["fitted_gain"]) < 1e-3 and abs(black - fitted["fitted_black"]) < 1e-3, (gain, black, fitted["fitted_gain"])
PY
fi
"$E2LF" info demo/scene --json >info.json
[ "$(json info.json "j['views']")" = "[8, 8]" ] || fail "info on the scene"
"$E2LF" info demo/events.npz --json >info.json
[ "$(json info.json "(j['height'], j['width'])")" = "(64, 96)" ] || fail "info on the events"

# The camera is the one that the model was trained for.
"$E2LF" demo -m e2lf-n4-camera -o physical --width 96 --height 64 --json >physical.json
check "$(json physical.json "j['psnr_db']") > 15"
py -c 'import numpy as np; assert b"evk4-lcos" in np.load("physical/events.npz")["camera"].tobytes()'

# A model without patterns has no camera to simulate.
fails 1 "e2lf-n4-capture" "$E2LF" demo -m "$SOURCES/models/e2lf-n4-capture.safetensors" -o none
absent none
