# Tables of events with oddities that people have: the size of the sensor in names and attributes, arrays in another
# order, folders of arrays, long headers; and what is read but is hardly meant so.
py - <<'PY'
import os
import h5py, numpy as np
rng = np.random.default_rng(1)
n = 1000
t = np.sort(rng.integers(1038, 31382, n))
x, y, p = rng.integers(0, 64, n), rng.integers(0, 48, n), rng.integers(0, 2, n)
columns = dict(x=x, y=y, p=p, t=t)
np.savez("truth.npz", **columns)
lines = ["%d,%d,%d,%d\n" % row for row in zip(t, x, y, p)]
def text(name, head="t,x,y,p\n", rows=lines):
    open(name, "w").write(head + "".join(rows))
# The size of the sensor.
text("two_lines.csv", "# width: 128\n# height: 96\nt,x,y,p\n")
np.savez("size.npz", width=np.array(128), height=np.array(96), **columns)
np.savez("resolution.npz", sensor_resolution=np.array([96, 128]), **columns)
for name, place in (("group", "events/"), ("top", "")):
    with h5py.File("size_%s.h5" % name, "w") as f:
        for key, column in columns.items():
            f["events/" + key] = column
        f[place + "width"], f[place + "height"] = 128, 96
with h5py.File("size_attributes.h5", "w") as f:
    for key, column in columns.items():
        f["events/" + key] = column
    f["events"].attrs["width"], f["events"].attrs["height"] = 128, 96
with h5py.File("size_e2vid.h5", "w") as f:
    for key, column in columns.items():
        f["events/" + key + "s"] = column
    f.attrs["sensor_resolution"] = np.array([96, 128])
# Arrays in another order, and folders of them.
rows = np.stack([t, x, y, p], 1)
np.save("fortran.npy", np.asfortranarray(rows))
np.save("flat.npy", rows.T.copy())
np.save("flat_fortran.npy", np.asfortranarray(rows.T))
np.savez("flat.npz", events=rows.T)
np.savez("with_images.npz", events=rows, images=np.zeros((2, 4, 5), np.uint8))
os.mkdir("evimo")
np.save("evimo/dataset_events_t.npy", t * 1e-6)
np.save("evimo/dataset_events_xy.npy", np.stack([x, y], 1).astype(np.uint16))
np.save("evimo/dataset_events_p.npy", p.astype(np.uint8))
os.mkdir("columns")
for key, column in columns.items():
    np.save("columns/%s.npy" % key, column)
text("long_header.csv", "".join("# setting %d of the camera, whatever it may mean\n" % i for i in range(1000)) + "t,x,y,p\n")
text("text.npy")
# Read as they are, with a word.
text("late.csv", rows=lines + ["1000000000000,3,3,1\n"])
text("late_three.csv", rows=lines[:500] + ["%d,3,3,1\n" % (4294967290 + i) for i in range(3)] + lines[500:])
text("early.csv", rows=["0,3,3,1\n"] + ["%d,%d,%d,%d\n" % (1.7e15 + a, b, c, d) for a, b, c, d in zip(t, x, y, p)])
np.savez("one_time.npz", x=x, y=y, p=p, t=(1.7e9 + t * 1e-6).astype(np.float32))
np.savez("coarse.npz", x=x, y=y, p=p, t_s=(5000 + t * 1e-6).astype(np.float32))
np.savez("fractions.npz", x=x * 480, y=y * 400, timestamp=t, polarity=p)
# No events.
np.save("objects.npy", np.array(dict(x=x), object), allow_pickle=True)
np.save("five.npy", np.stack([t, x, y, p, p], 1))
boxes = np.zeros(9, [("ts", "u8"), ("x", "f4"), ("y", "f4"), ("w", "f4"), ("h", "f4"), ("class_id", "u1")])
np.save("boxes.npy", boxes)
text("dates.csv", rows=["2024-01-31 12:30:59.%06d,%d,%d,%d\n" % row for row in zip(t, x, y, p)])
open("pointer.raw", "w").write("version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 12345\n")
open("list.json", "w").write(str(rows.tolist()))
open("table.feather", "wb").write(b"ARROW1" + bytes(300))
os.mkdir("other")
open("other/images.txt", "w").write("0 a.png\n")
PY
for input in two_lines.csv size.npz resolution.npz size_group.h5 size_top.h5 size_attributes.h5 size_e2vid.h5; do
  "$E2LF" info "$input" --json >info.json
  [ "$(json info.json "j['width'], j['height'], j['events']")" = "(128, 96, 1000)" ] || fail "$input: $(cat info.json)"
done
for input in two_lines.csv size.npz fortran.npy flat.npy flat_fortran.npy flat.npz with_images.npz evimo columns \
  long_header.csv text.npy; do
  "$E2LF" convert "$input" out.npz --overwrite --strict 2>stderr.txt || fail "$input: $(cat stderr.txt)"
  py -c 'import numpy as n, sys; a, b = n.load("truth.npz"), n.load("out.npz"); assert all((a[k] == b[k]).all() for k in "xypt")' ||
    fail "$input was read differently"
  if grep -q warning stderr.txt; then fail "$input: $(cat stderr.txt)"; fi
done
# warns <text> <input>: the input is read, with this word.
warns() {
  "$E2LF" convert "$2" out.npz --overwrite 2>stderr.txt || fail "$2: $(cat stderr.txt)"
  grep -qF -- "$1" stderr.txt || fail "$2: $(cat stderr.txt)"
}
warns "the last 1 of 1001 events are" late.csv
end_us=$(sed -n 's/.*end at \([0-9]*\) us.*/\1/p' stderr.txt)
"$E2LF" convert late.csv out.npz --overwrite --to-us "$end_us" --quiet 2>stderr.txt
[ ! -s stderr.txt ] || fail "$(cat stderr.txt)"
check "$(py -c 'import numpy as n; print(len(n.load("out.npz")["t"]))') == 1000"
warns "the last 3 of 1003 events are" late_three.csv
warns "the first 1 of 1001 events are" early.csv
warns "all 1000 events have the time" one_time.npz
warns "are 488.281 us apart" coarse.npz
warns "divide them first" fractions.npz
fails 1 "with numpy.savez" "$E2LF" convert objects.npy out2.npz
fails 1 "nor a list of events" "$E2LF" convert five.npy out2.npz
fails 1 "(ts, x, y, w, h, class_id)" "$E2LF" convert boxes.npy out2.npz
fails 1 "are dates" "$E2LF" convert dates.csv out2.npz
fails 1 "git lfs pull" "$E2LF" convert pointer.raw out2.npz
fails 1 "this is JSON" "$E2LF" convert list.json out2.npz
fails 1 "Feather" "$E2LF" convert table.feather out2.npz
fails 1 "images.txt" "$E2LF" convert other out2.npz
absent out2.npz
# Units as people write them, and what they would hide.
py - <<'PY'
import numpy as np
a = np.load("truth.npz")
rows = list(zip(a["t"], a["x"], a["y"], a["p"]))
def text(name, head, per_us):
    open(name, "w").write(head + "\n" + "".join("%d,%d,%d,%d\n" % (t * per_us, x, y, p) for t, x, y, p in rows))
text("nanosec.csv", "t_nanosec,x,y,p", 1000)
text("power6.csv", "Timestamp [10^-6 s],x,y,p", 1)
text("power9.csv", "time (1e-9 s),x,y,p", 1000)
text("micro.csv", "t_micro,x,y,p", 1)
open("split.csv", "w").write("ts.sec,ts.nsec,x,y,p\n" + "".join("17,%d,%d,%d,%d\n" % (1000 * t, x, y, p) for t, x, y, p in rows))
import h5py
def hdf5(name, group={}, times={}, file={}):
    with h5py.File(name, "w") as f:
        for key in "xyp":
            f["events/" + key] = a[key]
        f["events/t"] = a["t"] * 1000
        f.attrs.update(file); f["events"].attrs.update(group); f["events/t"].attrs.update(times)
hdf5("group.h5", group=dict(time_unit="ns"))
hdf5("times.h5", times=dict(resolution="1ns"))
hdf5("scale.h5", times=dict(scale=1e-9))
hdf5("file.h5", file=dict(timestamp_unit="nanoseconds"))
hdf5("ticks.h5", times=dict(unit="100 ns"))
np.save("txpy.npy", np.stack([a[k] for k in "txpy"], 1).astype(np.int64))
head = b"% evt 2.0\n% format EVT2;height=48;width=64\n% end\n"
open("wrong.raw", "wb").write(head + np.full(4000, 0x6FFF6FFF, np.uint32).tobytes())
PY
for input in nanosec.csv power6.csv power9.csv micro.csv group.h5 times.h5 scale.h5 file.h5; do
  "$E2LF" convert "$input" out.npz --overwrite --strict 2>stderr.txt || fail "$input: $(cat stderr.txt)"
  py -c 'import numpy as n; assert (n.load("truth.npz")["t"] == n.load("out.npz")["t"]).all()' || fail "$input was read differently"
done
fails 1 "give their unit" "$E2LF" convert ticks.h5 out2.npz
fails 1 "the times are in two columns" "$E2LF" convert split.csv out2.npz
fails 1 "--columns" "$E2LF" convert txpy.npy out2.npz
fails 1 "--event-format" "$E2LF" convert wrong.raw out2.npz
# Polarities of 1 and 2 are read with a word, and exchanged if asked for.
py - <<'PY'
import numpy as np
a = np.load("truth.npz")
open("two.csv", "w").write("t,x,y,p\n" + "".join("%d,%d,%d,%d\n" % (t, x, y, 2 - p) for t, x, y, p in zip(*[a[k] for k in "txyp"])))
PY
warns "1 = OFF, 2 = ON; --invert-polarity exchanges them" two.csv
"$E2LF" convert two.csv out.npz --overwrite --invert-polarity --quiet 2>stderr.txt
py -c 'import numpy as n; assert (n.load("truth.npz")["p"] == n.load("out.npz")["p"]).all()' || fail "polarities were not exchanged"
