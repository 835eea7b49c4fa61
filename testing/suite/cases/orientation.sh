# The orientation of views: options, records of events, schedules and cameras, and what heeds them.
cat >scene.py <<'PY'
import numpy as np
# A square that moves by -1 px from view to view before a wall that moves by +1 px.
rng = np.random.default_rng(5)
def texture(height, width):
    coarse = np.kron(rng.random((height // 2, width // 2)), np.ones((2, 2)))
    return (0.2 + 0.6 * coarse).astype(np.float32)
wall, square = texture(152, 188), texture(64, 80)
field = np.empty((8, 8, 128, 160), np.float32)
for row in range(8):
    for column in range(8):
        y, x = row - 4, column - 4
        field[row, column] = wall[12 - y : 140 - y, 14 - x : 174 - x]
        field[row, column, 32 - y : 96 - y, 40 - x : 120 - x] = square
np.save("scene.npy", field)
np.save("turned.npy", field[::-1, ::-1])
np.save("flipped.npy", field[:, ::-1])
PY
py scene.py

# Options on a light field: the pictures stay, the views change places.
"$E2LF" convert turned.npy back.npy --turn-views --quiet
cmp back.npy scene.npy
"$E2LF" convert flipped.npy back.npy --flip-x --overwrite --quiet
cmp back.npy scene.npy
"$E2LF" convert turned.npy back.npy --flip-x --flip-y --overwrite --quiet
cmp back.npy scene.npy
"$E2LF" convert scene.npy back.npy --turn-views --flip-x --flip-y --overwrite --quiet
cmp back.npy scene.npy

# Occlusion tells which of two light fields is turned; nothing is done about it.
"$E2LF" depth scene.npy -o upright --json >upright.json 2>upright.txt
[ "$(json upright.json "j['maps'][0]['occlusion']['views']")" = upright ] || fail "the scene is upright"
if grep -q turned upright.txt; then fail "a warning of an upright scene"; fi
"$E2LF" depth turned.npy -o turned --json >turned.json 2>turned.txt
[ "$(json turned.json "j['maps'][0]['occlusion']['views']")" = turned ] || fail "the scene is turned"
grep -q 'turned by 180 degrees (confidence .*give --turn-views' turned.txt || fail "no warning of a turned scene"
"$E2LF" depth turned.npy -o mended --turn-views --quiet 2>mended.txt
cmp mended/disparity.npy upright/disparity.npy
cmp mended/points.ply upright/points.ply
if grep -q turned mended.txt; then fail "a warning of a scene that was turned back"; fi
"$E2LF" refocus turned.npy --turn-views --disparity=-1 -o mended.png --quiet
"$E2LF" refocus scene.npy --disparity=-1 -o upright.png --quiet
cmp mended.png upright.png

# A recording, told by a schedule, an option, or both: event images keep it.
"$E2LF" codes render -o display --quiet
"$E2LF" simulate scene.npy -o rec.raw --seed 3 --quiet
py -c 'import json; j = json.load(open("display/schedule.json")); j["views"] = "turned"; json.dump(j, open("rig.json", "w"))'
orientation() { "$E2LF" info "$1" --json >info.json && json info.json "j['orientation']"; }
"$E2LF" accumulate rec.raw -o plain.npz --quiet
[ "$(orientation plain.npz)" = None ] || fail "nobody told"
"$E2LF" accumulate rec.raw -o told.npz --schedule rig.json --quiet
[ "$(orientation told.npz)" = turned ] || fail "the schedule tells"
"$E2LF" accumulate rec.raw -o both.npz --schedule rig.json --flip-x --quiet
[ "$(orientation both.npz)" = flipped-y ] || fail "the schedule and an option"
"$E2LF" convert plain.npz asked.npz --turn-views --quiet
[ "$(orientation asked.npz)" = turned ] || fail "an option of convert"
"$E2LF" convert rec.raw asked.hdf5 --flip-y --quiet
"$E2LF" accumulate asked.hdf5 -o asked.npz --overwrite --quiet
[ "$(orientation asked.npz)" = flipped-y ] || fail "another format of recordings"

# Reconstruction: lightfield.npy is the same to the bit, its record says how it lies, whoever reads it heeds that.
reconstruct() { "$E2LF" reconstruct "$1" -o "$2" --method inversion --gain 1 --quiet "${@:3}"; }
reconstruct plain.npz plain --format npy
reconstruct told.npz told --format npy
cmp plain/lightfield.npy told/lightfield.npy
[ "$(json told/run.json "j['notes']['views']['stored']")" = turned ] || fail "the record of a reconstruction"
"$E2LF" convert told read.npy 2>read.txt
py -c 'import numpy as np; assert np.array_equal(np.load("read.npy"), np.load("plain/lightfield.npy")[::-1, ::-1])'
grep -q 'its views are turned, as run.json states' read.txt || fail "nothing said"
"$E2LF" convert told/lightfield.npy again.npy --quiet
cmp again.npy read.npy
"$E2LF" convert told same.npy --turn-views --quiet
cmp same.npy plain/lightfield.npy
# Pictures are upright at once.
reconstruct plain.npz pictures
reconstruct plain.npz asked --turn-views
for view in 00_00 03_05; do
  mirror=$(printf '%02d_%02d' $((7 - 10#${view%_*})) $((7 - 10#${view#*_})))
  cmp "pictures/$view.png" "asked/$mirror.png"
done
[ "$(json asked/run.json "j['notes']['views']['capture']")" = turned ] || fail "the capture of pictures"
[ "$(json asked/run.json "j['notes']['views']['stored']")" = upright ] || fail "pictures are upright"
reconstruct rec.raw cycles --format npy --schedule rig.json
[ "$(json cycles/cycle_00000/run.json "j['notes']['views']['stored']")" = turned ] || fail "the record of a cycle"
# Pictures that are made of it, too.
for field in told read.npy; do "$E2LF" refocus "$field" --disparity=-1 -o "focus_${field%.npy}.png" --quiet; done
cmp focus_told.png focus_read.png

# A camera file tells, too: its simulation sees the scene turned, its reconstruction turns it back.
py -c 'import json, sys; j = json.loads("".join(l for l in open(sys.argv[1]) if not l.startswith("//"))); j["views"] = "turned"; json.dump(j, open("rig_camera.json", "w"))' \
  "$SOURCES/cameras/paper.json"
"$E2LF" simulate scene.npy -o seen.npz --camera rig_camera.json --seed 3 --quiet
"$E2LF" simulate turned.npy -o turned.npz --camera paper --seed 3 --quiet
py -c 'import numpy as np; assert np.array_equal(np.load("seen.npz")["events"], np.load("turned.npz")["events"])'
reconstruct seen.npz seen --format npy
[ "$(json seen/run.json "j['notes']['views']['stored']")" = turned ] || fail "the camera in the events' file"
py -c 'import json; j = json.load(open("rig_camera.json")); j["views"] = "sideways"; json.dump(j, open("bad.json", "w"))'
fails 1 'flipped-x' "$E2LF" simulate scene.npy -o x.npz --camera bad.json
