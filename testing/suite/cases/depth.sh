# e2lf depth: the disparity of a plane that is known, in every format; cycles; what is refused.
cat >plane.py <<'PY'
import sys
import numpy as np
# A sum of waves, so that views shifted by fractions of a pixel are exact; a point at x moves to x + d in the next view.
def views(d, height=48, width=64):
    v, u, y, x = np.meshgrid(*(np.arange(n, dtype=float) for n in (8, 8, height, width)), indexing="ij")
    y, x = y - d * (v - 4), x - d * (u - 4)
    rng, sum = np.random.default_rng(3), 0
    for _ in range(24):
        fy, fx, phase = *rng.uniform(-0.9, 0.9, 2), rng.uniform(0, 6.3)
        sum = sum + np.sin(fy * y + fx * x + phase)
    return (0.5 + sum / 24).clip(0, 1).astype(np.float32)
np.save(sys.argv[2], views(float(sys.argv[1])))
PY
py plane.py -1.37 plane.npy
"$E2LF" depth plane.npy -o out --json >out.json
exists out/run.json out/disparity.npy out/disparity.pfm out/disparity.png out/points.ply out/confidence.npy \
  out/confidence.png out/colour.png
[ "$(json out.json "j['maps'][0]['view']")" = "[4, 4]" ] || fail "the reference view"
for format in npy pfm png ply; do "$E2LF" depth plane.npy -o "one.$format" --quiet; exists "one.$format.run.json"; done
convert one.png -depth 16 -endian LSB gray:one.gray
cat >compare.py <<'PY'
import numpy as np
d = np.load("out/disparity.npy")
assert d.dtype == np.float32 and d.shape == (48, 64)
assert np.abs(d[8:-8, 8:-8] + 1.37).max() < 0.02, np.abs(d[8:-8, 8:-8] + 1.37).max()
c = np.load("out/confidence.npy")
assert c.min() >= 0 and c.max() <= 1 and np.median(c) > 0.5, np.median(c)
header, data = open("one.pfm", "rb").read().split(b"-1.0\n", 1)
assert header == b"Pf\n64 48\n"
assert np.array_equal(np.frombuffer(data, "<f4").reshape(48, 64)[::-1], -d)
samples = np.fromfile("one.gray", "<u2").reshape(48, 64)
assert np.abs((samples - 32768.0) / 4096 - d).max() <= 0.5 / 4096 + 1e-6
text, points = open("one.ply", "rb").read().split(b"end_header\n", 1)
points = np.frombuffer(points, "<f4,<f4,<f4,u1,<f4")
assert f"element vertex {len(points)}\n".encode() in text and 0.9 * 48 * 64 < len(points) <= 48 * 64
infinity = float(text.split(b"infinity at ")[1].split()[0])
z = np.median(points["f2"])
assert abs(z - 1 / (1 + 1.37 / infinity)) < 0.01 * z, (z, infinity)
PY
py compare.py

# Another view; a range that is given; the run is made again from its record.
"$E2LF" depth plane.npy -o corner --view-row 0 --view-column 7 --min-disparity=-2 --max-disparity=-1 --quiet
py -c 'import numpy as np; d = np.load("corner/disparity.npy"); assert np.abs(d[16:-16, 16:-16] + 1.37).max() < 0.02'
"$E2LF" depth --config corner/run.json -o again --quiet
cmp corner/disparity.npy again/disparity.npy

# A folder of cycles: a map for each.
mkdir -p cycles/cycle_00000 cycles/cycle_00001
cp plane.npy cycles/cycle_00000/lightfield.npy
py plane.py 0.6 cycles/cycle_00001/lightfield.npy
"$E2LF" depth cycles -o maps --json >maps.json
exists maps/run.json maps/cycle_00000/run.json maps/cycle_00001/points.ply
[ "$(json maps.json "len(j['maps'])")" = 2 ] || fail "two maps"
cmp maps/cycle_00000/disparity.npy out/disparity.npy
py -c 'import numpy as np; d = np.load("maps/cycle_00001/disparity.npy"); assert np.abs(d[8:-8, 8:-8] - 0.6).max() < 0.02'

fails 1 'give one of them' "$E2LF" depth cycles -o x.ply
fails 1 'there is no view (8, 0)' "$E2LF" depth plane.npy -o x --view-row 8 --view-column 0
fails 2 'max-disparity' "$E2LF" depth plane.npy -o x --min-disparity 0
fails 1 'exceeds the image of 64x48 px' "$E2LF" depth plane.npy -o x --min-disparity=-1e9 --max-disparity=1e9
fails 1 'smaller one first' "$E2LF" depth plane.npy -o x --min-disparity 1 --max-disparity 0
fails 1 'single view' "$E2LF" depth plane.npy -o x --views 1
fails 1 'overwrite' "$E2LF" depth plane.npy -o out
fails 1 'recording' "$E2LF" depth one.ply -o x
absent x x.ply
# From events, by a depth network: a file, a folder for each cycle; what is refused.
py "$TESTSUITE/geometry_models.py" "$SOURCES/models/e2lf-n4.safetensors"
"$E2LF" simulate plane.npy -m depth.safetensors -o events.npz --quiet
"$E2LF" depth events.npz -m depth.safetensors -o from_events --json >events.json
exists from_events/run.json from_events/disparity.npy from_events/disparity.pfm from_events/points.ply from_events/confidence.npy \
  from_events/colour.png
[ "$(json events.json "j['maps'][0]['view']")" = "[4, 4]" ] || fail "the reference view"
"$E2LF" depth events.npz -m depth.safetensors -o turned.npy --turn-views --quiet
py -c 'import numpy as np; a, b = np.load("from_events/disparity.npy"), np.load("turned.npy"); assert a.shape == (48, 64) and np.array_equal(a, -b)'
py -c 'import numpy as np; e = np.load("events.npz"); np.savez("two.npz", events=np.stack([e["events"].reshape(3, 48, 64)] * 2))'
"$E2LF" depth two.npz -m depth.safetensors -o two --quiet
cmp two/cycle_00001/disparity.npy from_events/disparity.npy
# The view of the turned map is that of the upright light field.
"$E2LF" depth events.npz -m depth.safetensors -o turned --turn-views --quiet
[ "$(json turned/run.json "j['notes']['maps'][0]['view']")" = "[3, 3]" ] || fail "the view of turned views"
fails 1 '-: this is a zip archive' "$E2LF" depth - -m depth.safetensors -o x.npy < <(cat events.npz)
grep -q 'give event images as a file' stderr.txt || fail "$(cat stderr.txt)"
fails 1 'name a folder' "$E2LF" depth two.npz -m depth.safetensors -o x.npy --fuse 4
fails 1 'flipped' "$E2LF" depth events.npz -m depth.safetensors -o x.npy --flip-x
fails 1 'no disparities' "$E2LF" depth events.npz -m layers.safetensors -o x.npy
fails 1 'disparities' "$E2LF" reconstruct events.npz -m depth.safetensors -o x
fails 1 'no effect on events' "$E2LF" depth events.npz -m depth.safetensors -o x.npy --view-row 1 --view-column 1
fails 1 'no effect on light fields' "$E2LF" depth plane.npy -m depth.safetensors -o x
# Without a model, patterns that no bundled network was trained for get the one for any patterns.
other_codes other.npy
py plane.py -0.5 small.npy 64 80
py -c 'import numpy as np; np.save("wide.npy", np.load("small.npy").repeat(3, 2).repeat(3, 3))'  # at -1.5 px
"$E2LF" simulate wide.npy --codes other.npy -o own.npz --quiet
"$E2LF" depth own.npz -o own 2>err.txt
grep -q "patterns-adapted" err.txt || fail "$(cat err.txt)"
py -c 'import numpy as np; d = np.median(np.load("own/disparity.npy")); assert abs(d + 1.5) < 0.3, d'
