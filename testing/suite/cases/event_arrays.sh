# Events as people have them in numpy and HDF5: columns under other names, arrays [events, 4], times in seconds.
py - <<'PY'
import h5py, numpy as np
rng = np.random.default_rng(1)
n = 5000
t = np.cumsum(rng.integers(0, 20, n)) + 1000
x, y, p = rng.integers(0, 64, n), rng.integers(0, 48, n), rng.integers(0, 2, n)
np.savez("truth.npz", x=x.astype(np.uint16), y=y.astype(np.uint16), p=p.astype(np.uint8), t=t.astype(np.int64))
rows = np.stack([t * 1e-6, x, y, 2 * p - 1], 1)
np.save("seconds.npy", rows)
np.savez("rows.npz", events=rows, images=np.zeros((2, 4, 5), np.uint8))
np.save("whole.npy", np.stack([x, y, p, t], 1).astype(">i8"))
titled = np.zeros(n, [(("column", "x"), "u2"), (("row", "y"), "u2"), ("p", "u1"), ("t", "i8")])
for key, column in dict(x=x, y=y, p=p, t=t).items():
    titled[key] = column
np.save("titled.npy", titled)
np.savez("whole_floats.npz", x=x, y=y, p=p, t=t.astype(np.float64))
np.savez("seconds.npz", x=x, y=y, p=p, t=t * 1e-6)
np.savez("names.npz", xs=x, ys=y, ps=2 * p - 1, ts=t)
np.savez("ns.npz", x=x, y=y, p=p, t=t * 1000)
with h5py.File("names.h5", "w") as f:
    for key, column in (("xs", x), ("ys", y), ("ts", t * 1e-6), ("ps", p)):
        f["events/" + key] = column
with h5py.File("whole_floats.h5", "w") as f:
    for key, column in (("xs", x), ("ys", y), ("ts", t.astype(np.float64)), ("ps", p)):
        f["events/" + key] = column
with h5py.File("plain.h5", "w") as f:
    for key, column in (("x", x), ("y", y), ("t", t), ("p", p.astype(bool))):
        f[key] = column
with h5py.File("v2e.h5", "w") as f:
    f.create_dataset("events", data=np.stack([t, x, y, p], 1).astype(np.uint32), chunks=(1000, 4), compression="gzip")
import os
for folder, columns in dict(split=dict(events_t=t * 1e-6, events_xy=np.stack([x, y], 1).astype(np.uint16), events_p=p),
                            apart=dict(t=t, x=x, y=y, p=2 * p - 1)).items():
    os.makedirs(folder)
    for key, column in columns.items():
        np.save(f"{folder}/{key}.npy", column)
# What cannot be read as it stands.
np.save("flat.npy", rows.T.copy())
np.savez("decimal.npz", x=x + 0.25, y=y, p=p, t=t)
np.savez("half.npz", x=x, y=y, p=p, t=(30 + t * 1e-6).astype(np.float16))
np.savez("two.npz", x=x, y=y, p=p + 1, t=t)
np.save("objects.npy", np.array(dict(x=x), object), allow_pickle=True)
np.save("boxes.npy", np.zeros(9, [("ts", "u8"), ("x", "f4"), ("y", "f4"), ("w", "f4"), ("class_id", "u1")]))
PY
same() {
  py - "$1" <<'PY'
import sys
import numpy as np
a, b = np.load("truth.npz"), np.load(sys.argv[1])
assert all(np.array_equal(a[k], b[k]) for k in "xypt"), sys.argv
PY
}
for input in seconds.npy rows.npz "whole.npy --columns xypt" titled.npy seconds.npz names.npz \
  names.h5 plain.h5 "v2e.h5 --columns txyp" whole_floats.npz whole_floats.h5 "ns.npz --time-unit ns" split apart; do
  # shellcheck disable=SC2086
  "$E2LF" convert $input out.npz --overwrite --strict 2>stderr.txt || fail "$input: $(cat stderr.txt)"
  same out.npz
  [ ! -s stderr.txt ] || ! grep -q warning stderr.txt || fail "$input: $(cat stderr.txt)"
  # shellcheck disable=SC2086
  "$E2LF" info $input --json >info.json 2>/dev/null
  check "$(json info.json "j['kind'] == 'recording' and j['events'] == 5000")"
done
# What is not declared is refused with the option that declares it.
for input in whole.npy v2e.h5; do
  fails 1 "--columns" "$E2LF" convert "$input" out2.npz
done
fails 1 "[events, 4]" "$E2LF" convert flat.npy out2.npz
fails 1 "polarities" "$E2LF" convert two.npz out2.npz
"$E2LF" convert two.npz out2.npz --polarities 1,2 --quiet
same out2.npz
rm out2.npz out2.npz.run.json
fails 1 "pixels" "$E2LF" convert decimal.npz out2.npz
fails 1 "64 bits" "$E2LF" convert half.npz out2.npz
fails 1 "numpy.savez" "$E2LF" convert objects.npy out2.npz
fails 1 "class_id" "$E2LF" convert boxes.npy out2.npz
absent out2.npz
"$E2LF" convert whole.npy out.npz --columns xypt --overwrite --quiet
check "$(json out.npz.run.json "j['notes']['read_as'] == {'columns': 'x, y, p, t', 'time_unit': 'us', 'polarity': '0 = OFF, 1 = ON'}")"
# Formats that fix the unit of their times refuse another one.
"$E2LF" convert out.npz fixed.raw --sensor-width 64 --sensor-height 48 --quiet
fails 1 "--time-unit" "$E2LF" info fixed.raw --time-unit ns
fails 1 "--columns" "$E2LF" convert ns.npz out2.npz --columns txyp
# MVSEC's layout, DSEC's with an offset in seconds, and names with units.
py - <<'PY'
import h5py, numpy as np
a = np.load("truth.npz")
x, y, p, t = (a[k] for k in "xypt")
with h5py.File("mvsec.h5", "w") as f:
    rows = np.stack([x, y, 1.5e9 + t * 1e-6, 2.0 * p - 1], 1)
    f["davis/left/events"] = rows
    f["davis/right/events"] = rows[:10]
with h5py.File("dsec.h5", "w") as f:
    for key, column in (("x", x), ("y", y), ("t", t.astype(np.uint32)), ("p", p)):
        f["events/" + key] = column
    f["t_offset"] = 57.92
for name, key, unit in (("units", "t_ns", ""), ("attributes", "t", "ns"), ("ticks", "t", "100 ns")):
    with h5py.File(name + ".h5", "w") as f:
        for other, column in ((key, t * 1000), ("x", x), ("y", y), ("p", p)):
            f["events/" + other] = column
        if unit:
            f["events/t"].attrs["units"] = unit
with h5py.File("size_group.h5", "w") as f:
    for other, column in (("t", t), ("x", x), ("y", y), ("p", p)):
        f["events/" + other] = column
    f["events"].attrs["width"], f["events"].attrs["height"] = 128, 96
with h5py.File("size_attribute.h5", "w") as f:
    for other, column in (("ts", t), ("xs", x), ("ys", y), ("ps", p)):
        f["events/" + other] = column
    f.attrs["sensor_resolution"] = np.array([96, 128])
np.savez("size.npz", width=np.array(128), height=np.array(96), **a)
np.savez("resolution.npz", sensor_resolution=np.array([96, 128]), **a)
PY
"$E2LF" convert mvsec.h5 mvsec.npz --columns xytp 2>stderr.txt
grep -q 'davis/right' stderr.txt || fail "the other camera is not named: $(cat stderr.txt)"
"$E2LF" convert dsec.h5 dsec.npz 2>stderr.txt
py - <<'PY'
import numpy as np
a, b, c = (np.load(name)["t"] for name in ("truth.npz", "mvsec.npz", "dsec.npz"))
assert np.abs(b - a - 1_500_000_000_000_000).max() <= 1
assert np.array_equal(c, a + 57_920_000)
PY
for input in units.h5 attributes.h5; do
  "$E2LF" convert "$input" out.npz --overwrite
  same out.npz
done
fails 1 "--time-unit" "$E2LF" convert ticks.h5 ticks.npz
for input in size_group.h5 size_attribute.h5 size.npz resolution.npz; do
  "$E2LF" info "$input" --json >info.json
  [ "$(json info.json "j['width'], j['height'], j['events']")" = "(128, 96, 5000)" ] || fail "$input: $(cat info.json)"
done
# HDF5 events in any group; of two cameras one is named.
py - <<'PY'
import h5py, numpy as np
a = np.load("truth.npz")
columns = [a[k].astype(np.int64) for k in "xypt"]
records = np.zeros(5000, [("x", "u2"), ("y", "u2"), ("p", "u1"), ("t", "i8")])
for key, column in zip("xypt", columns):
    records[key] = column
with h5py.File("records.h5", "w") as f:
    f["events"] = records
with h5py.File("cameras.h5", "w") as f:
    for key, column in zip(("x", "y", "polarity", "timestamp"), columns):
        f["prophesee/left/" + key] = column[:10]
        f["prophesee/right/" + key] = column
# A damaged type of records: the field t lies beyond the record.
data = bytearray(open("records.h5", "rb").read())
data[data.index(b"t" + bytes(7) + (5).to_bytes(4, "little")) + 10] = 1
open("beyond.h5", "wb").write(data)
PY
"$E2LF" convert cameras.h5 --stream right out.npz --overwrite --quiet
same out.npz
fails 1 "shape" "$E2LF" info records.h5
fails 1 "overlap" "$E2LF" info beyond.h5
# Control characters of a file do not reach the terminal.
printf 'a\033[31mb,c,d,e\n1\033[0m,2,3,4\n' >hostile.csv
fails 1 '\x1b[' "$E2LF" info hostile.csv
! grep -q "$(printf '\033')" stderr.txt || fail "a control character"
# Float16 and other numbers as light fields; counts ask for their white.
py - <<'PY'
import numpy as np
rng = np.random.default_rng(2)
a = rng.integers(0, 256, (8, 8, 6, 7))
np.save("half.npy", (a / 255).astype(np.float16))
np.save("counts.npy", a.astype(np.float32))
np.save("int32.npy", a.astype(np.int32))
np.save("bytes.npy", a.astype(np.uint8))
np.save("large.npy", np.tile(a, (2, 2, 1, 1))[:10, :12].astype(np.uint8))
PY
"$E2LF" convert half.npy half
fails 1 "--white" "$E2LF" convert counts.npy counts
fails 1 "--white" "$E2LF" convert int32.npy counts
absent counts
"$E2LF" convert bytes.npy bytes
for input in counts int32; do
  "$E2LF" convert "$input.npy" "$input" --white 255
  cmp bytes/03_04.png "$input/03_04.png"
done
# Which views are taken of a larger grid.
"$E2LF" simulate large.npy -o large.npz 2>stderr.txt
grep -q "took view rows 1..8 of 10 and columns 2..9 of 12" stderr.txt || fail "$(cat stderr.txt)"
"$E2LF" convert large.npy step2 --views 4 --step 2 2>stderr.txt
grep -q "took view rows 1..7 in steps of 2 of 10" stderr.txt || fail "$(cat stderr.txt)"
[ "$(ls step2/*.png | wc -l)" -eq 16 ] || fail "--views"

# Events of AEDAT 2, as v2e writes them by default: refused with the converter, whose output is read.
py - <<'PY'
import numpy as np
rng = np.random.default_rng(3)
n = 2000
t, x, y, p = np.cumsum(rng.integers(1, 9, n)), rng.integers(0, 346, n), rng.integers(0, 260, n), rng.integers(0, 2, n)
np.savez("truth.npz", x=x, y=y, p=p, t=t)
address = (345 - x) << 12 | (259 - y) << 22 | p << 11
with open("v2e.aedat", "wb") as f:
    f.write(b"#!AER-DAT2.0\r\n# This is a raw AE data file\r\n# AEChip: eu.seebetter.ini.chips.davis.Davis346B\r\n")
    f.write(np.stack([address, t], 1).astype(">u4").tobytes())
PY
fails 1 "aedat2_to_csv.py" "$E2LF" info v2e.aedat
py "$SOURCES/examples/python/aedat2_to_csv.py" v2e.aedat v2e.csv
"$E2LF" convert v2e.csv out.npz --overwrite --strict --quiet
same out.npz
