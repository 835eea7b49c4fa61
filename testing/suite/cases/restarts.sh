# Recordings whose clock starts again, since two were joined: no event is lost or mixed in any format, and --restart decides.
py - <<'PY'
import h5py, numpy as np
rng = np.random.default_rng(5)
n = 3000
t = np.sort(rng.integers(1000, 90000, n))
t[0], t[-1] = 1000, 90000
x, y, p = rng.integers(0, 64, n), rng.integers(0, 48, n), rng.integers(0, 2, n)
twice = {k: np.r_[v, v] for k, v in dict(x=x, y=y, p=p, t=t).items()}
np.savez("one.npz", x=x, y=y, p=p, t=t)
np.savez("joined.npz", **twice)
np.savez("truth.npz", **{**twice, "t": np.r_[t, t + 89001]})
with h5py.File("joined.h5", "w") as f:
    for k, v in twice.items():
        f["events/" + k] = v
PY
for format in evt2 evt2.1 evt3; do
  "$E2LF" convert one.npz "$format.raw" --format "$format" --sensor-width 64 --sensor-height 48 --quiet
  cat "$format.raw" "$format.raw" >"joined.$format.raw"
done
"$E2LF" convert one.npz one.dat --sensor-width 64 --sensor-height 48 --quiet
cat one.dat one.dat >joined.dat
"$E2LF" convert one.npz one.csv --sensor-width 64 --sensor-height 48 --quiet
cat one.csv one.csv >joined.csv
for input in joined.*; do
  "$E2LF" convert "$input" out.npz --overwrite --json >out.json 2>stderr.txt || fail "$input: $(cat stderr.txt)"
  grep -q "the clock starts again" stderr.txt || fail "$input: the restart is not stated: $(cat stderr.txt)"
  check "$(json out.json "j['left_out'] == [] and [r['shift_us'] for r in j['restarts']] == [89001]")"
  py - <<PY
import numpy as np
a, b = np.load("truth.npz"), np.load("out.npz")
assert all(np.array_equal(a[k], b[k]) for k in "xypt"), "$input"
PY
  fails 1 "clock" "$E2LF" convert "$input" refused.npz --restart refuse
  absent refused.npz
  rm -f part*.npz
  "$E2LF" convert "$input" part.npz --restart split --quiet
  py - <<PY
import numpy as np
one = np.load("one.npz")
for part in (np.load("part.npz"), np.load("part_2.npz")):
    assert all(np.array_equal(one[k], part[k]) for k in "xypt"), "$input"
PY
done
# A part that an earlier run left is not taken for one of this recording.
"$E2LF" convert one.npz part.npz --restart split --overwrite --quiet 2>stderr.txt
grep -q "part_2.npz is not a part of this recording" stderr.txt || fail "$(cat stderr.txt)"
# The header of a recording without events lies between them: the times still go on.
py -c 'd = open("evt3.raw", "rb").read(); i = d.index(b"% end\n") + 6; open("headers.raw", "wb").write(d + d[:i] + d)'
"$E2LF" convert headers.raw out.npz --overwrite --quiet 2>stderr.txt || fail "$(cat stderr.txt)"
grep -q "clock starts again once" stderr.txt || fail "$(cat stderr.txt)"
py -c 'import numpy as n; a, b = n.load("truth.npz"), n.load("out.npz"); assert all(n.array_equal(a[k], b[k]) for k in "xypt")' ||
  fail "the events differ"
