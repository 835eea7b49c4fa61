# The lens of a simulated rig, calibrated from events of a checkerboard, and depth in metres.
py -c "import cv2" 2>/dev/null || skip "there is no python3-opencv"
skip_sanitizers "the other cases run each verb with sanitizers"
mkdir bin
ln -s "$E2LF" bin/e2lf
ln -s /usr/bin/python3 bin/python3
PATH=$PWD/bin:$PATH "$SOURCES/examples/lens/try_calibration.sh" board >out.txt 2>err.txt || fail "$(cat out.txt err.txt)"
py - <<'PY'
import json
import numpy as np
found, true = (json.load(open(f"board/{name}.json")) for name in ("lens", "true_lens"))
assert abs(found["focal_px"][0] / true["focal_px"][0] - 1) < 0.01, found
assert abs(found["baseline_m"] / true["baseline_m"] - 1) < 0.05, found
assert abs(found["focus_m"] / true["focus_m"] - 1) < 0.02, found
metres = np.load("board/depth/metres.npy")
assert metres.shape == (240, 320) and abs(np.nanmedian(metres) - 0.58) < 0.03, np.nanmedian(metres)
PY
sed 's/"width": 320/"width": 321/' board/lens.json >other.json
fails 1 "321x240" "$E2LF" depth board/recon/pose_00 -o out.ply --lens other.json
