# Light fields in colour; grids other than 8x8.
model=$SOURCES/models/e2lf-n4.safetensors
"$E2LF" demo -o demo --width 64 --height 48 --quiet
"$E2LF" convert demo/scene grey.npy --quiet
py - <<'PY'
import numpy as np
grey = np.load("grey.npy").astype(np.float32)
grey /= 255 if grey.max() > 1 else 1
np.save("scene.npy", np.stack([grey, 0.2 + 0.6 * grey, 0.9 - 0.7 * grey], axis=-1))
PY
# A grey reconstruction of the same scene is compared in grey.
"$E2LF" simulate scene.npy -m "$model" -o grey.npz --quiet
"$E2LF" reconstruct grey.npz -m "$model" -o plain --quiet
"$E2LF" eval scene.npy plain --json --quiet >plain.json
[ "$(json plain.json "j['channels']")" = 1 ] || fail "grey is compared in grey"
"$E2LF" convert scene.npy colour --colour --quiet
"$E2LF" depth colour -o points.ply --quiet
grep -aq "property uchar blue" points.ply || fail "points without colour"
"$E2LF" view colour --export colour.html --quiet
exists colour.html

# Grids of 5x5, 7x7 and 9x9: the patterns say how many views there are.
py - <<'PY'
import json, numpy as np
rng = np.random.default_rng(3)
for n in (5, 7, 9):
    codes = [np.zeros((n, n), int)] + [(rng.random((n, n)) < 0.5).astype(int) for _ in range(3)]
    json.dump({"patterns": [["".join(map(str, row)) for row in code] for code in codes]}, open(f"codes{n}.json", "w"))
    scene = np.load("grey.npy").astype(np.float32)
    scene /= 255 if scene.max() > 1 else 1
    shift = [[np.roll(scene[0, 0], (r - n // 2, c - n // 2), (0, 1)) for c in range(n)] for r in range(n)]
    np.save(f"scene{n}.npy", np.array(shift, np.float32))
PY
for n in 5 7 9; do
  "$E2LF" simulate scene$n.npy --codes codes$n.json -o events$n.npz --quiet
  "$E2LF" reconstruct events$n.npz --method inversion -o inversion$n --quiet 2>warnings.txt
  exists inversion$n/0$((n - 1))_0$((n - 1)).png
  "$E2LF" eval scene$n.npy inversion$n --json --quiet >eval$n.json
  [ "$(json eval$n.json "len(j['views'])")" = $((n * n)) ] || fail "$n x $n views"
  check "$(json eval$n.json "j['psnr_db']") > 8"
  "$E2LF" view inversion$n --export view$n.html --quiet
  "$E2LF" refocus inversion$n -o refocus$n.png --disparity 1 --quiet
done
fails 1 "scene5.npy" "$E2LF" simulate scene5.npy --codes codes9.json -o x.npz
