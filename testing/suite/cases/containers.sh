# Containers of recordings: several streams in one file, bags of ROS 2, and files that are no recordings.
grep -q -- "--stream" <("$E2LF" info --help-all) || fail "no --stream"

# What is no recording is named by its first bytes, by every verb, and nothing is written.
py - <<'PY'
import bz2, gzip, lzma, zipfile
open("a.csv", "w").write("%x,y,p,t\n" + "".join("%d,%d,%d,%d\n" % (i % 64, i % 48, i % 2, 1000 + 3 * i) for i in range(1000)))
open("gzip.raw", "wb").write(gzip.compress(b"x" * 1000))
with zipfile.ZipFile("zip.raw", "w") as z:
    z.writestr("a.raw", b"% evt 3.0\n")
open("bzip2.raw", "wb").write(bz2.compress(b"x" * 1000))
open("xz.raw", "wb").write(lzma.compress(b"x" * 1000))
open("ROS 1.raw", "wb").write(b"#ROSBAG V2.0\n" + bytes(100))
open("Event Stream.raw", "wb").write(b"Event Stream" + bytes(100))
PY
for kind in zip gzip bzip2 xz "ROS 1" "Event Stream"; do
  fails 1 "$kind" "$E2LF" info "$kind.raw"
  fails 1 "; " "$E2LF" convert "$kind.raw" foreign.csv
  fails 1 "$kind" "$E2LF" accumulate "$kind.raw" -o foreign.npz
  fails 1 "$kind" "$E2LF" reconstruct "$kind.raw" -o foreign
done
absent foreign.csv foreign.npz foreign
fails 1 "one stream" "$E2LF" info a.csv --stream 1

# A bag of ROS 2 with two cameras: the second is said to be left out, and can be chosen.
if "$E2LF" --version | grep -q "^sqlite: ON"; then
  py - <<'PY'
import os, sqlite3, struct
def message(number, x):
    head = struct.pack("<iI", 1700000000, 0) + struct.pack("<I", 4) + b"cam\0"
    head += struct.pack("<II", 480, 640)
    head += bytes(-len(head) % 8) + struct.pack("<QQ", number, 1700000000000000000 + 1000000 * number)
    head += struct.pack("<I", 5) + b"mono\0" + b"\0"
    head += bytes(-len(head) % 4)
    events = b"".join(struct.pack("<Q", i % 2 << 63 | 7 << 48 | x << 32 | i * 1000) for i in range(50))
    return b"\0\1\0\0" + head + struct.pack("<I", len(events)) + events
os.mkdir("bag")
c = sqlite3.connect("bag/bag_0.db3")
c.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, offered_qos_profiles TEXT)")
c.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)")
for i, name in enumerate(["/left/events", "/right/\x1b[31mevents"]):
    c.execute("INSERT INTO topics VALUES(?, ?, 'event_camera_msgs/msg/EventPacket', 'cdr', '')", (i + 1, name))
for n in range(4):
    c.execute("INSERT INTO messages VALUES(NULL, ?, 0, ?)", (1 + n % 2, message(n // 2, 10 + n % 2)))
c.commit()
open("bag/metadata.yaml", "w").write("rosbag2_bagfile_information:\n  relative_file_paths:\n    - bag_0.db3\n")
PY
  for input in bag bag/bag_0.db3; do
    "$E2LF" info "$input" --json >info.json
    check "$(json info.json "j['format'] == 'rosbag' and j['width'] == 640")"
    check "$(json info.json "j['left_out'] == [{'reason': 'other_stream', 'count': 2, 'first_byte': 0}]")"
    "$E2LF" info "$input" >info.txt
    grep -q "/left/events" info.txt || fail "$(cat info.txt)"
    grep -q "(--stream)" info.txt || fail "no advice: $(cat info.txt)"
    if grep -q $'\033' info.txt; then fail "a control character of the file reached the terminal"; fi
  done
  "$E2LF" convert bag --stream 1 right.csv --strict --quiet
  py -c 'rows = [l.split(",") for l in open("right.csv") if l[0] != "%"]; assert {r[0] for r in rows} == {"11"}, rows[:3]'
  fails 1 "(--stream)" "$E2LF" convert bag --stream nobody none.csv
  fails 1 "several streams" "$E2LF" convert bag none.csv --strict
  absent none.csv
fi

# HDF5 files of the DSEC data set are compressed by Blosc: where the filter is missing it is named, with the package that brings it.
py - <<'PY'
import h5py, numpy as np
def packed(name, number):
    with h5py.File(name, "w") as file:
        for key in "xypt":
            properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
            properties.set_chunk((16,))
            properties.set_filter(number, h5py.h5z.FLAG_OPTIONAL)
            links = h5py.h5p.create(h5py.h5p.LINK_CREATE)
            links.set_create_intermediate_group(True)
            data = h5py.h5d.create(file.id, b"events/" + key.encode(), h5py.h5t.NATIVE_UINT16, h5py.h5s.create_simple((16,)), properties, links)
            data.write_direct_chunk((0,), b"\1" * 20)
for name, number in (("blosc", 32001), ("lz4", 32004), ("bitshuffle", 32008), ("zstd", 32015), ("other", 40000)):
    packed(name + ".h5", number)
PY
HDF5_PLUGIN_PATH=$PWD fails 1 "32001 (Blosc)" "$E2LF" info blosc.h5
HDF5_PLUGIN_PATH=$PWD fails 1 "hdf5-filter-plugin-blosc-serial" "$E2LF" convert blosc.h5 blosc.csv
HDF5_PLUGIN_PATH=$PWD fails 1 "Debian package hdf5-filter-plugin" "$E2LF" info lz4.h5
HDF5_PLUGIN_PATH=$PWD fails 1 "Debian package bitshuffle" "$E2LF" info bitshuffle.h5
HDF5_PLUGIN_PATH=$PWD fails 1 "32015 (Zstandard)" "$E2LF" info zstd.h5
HDF5_PLUGIN_PATH=$PWD fails 1 "filter 40000" "$E2LF" info other.h5
absent blosc.csv
if dpkg -s hdf5-filter-plugin-blosc-serial >/dev/null 2>&1; then
  py - <<'PY'
import h5py, numpy as np
n = 1000
with h5py.File("dsec.h5", "w") as file:
    for key, values in (("x", np.arange(n, dtype="u2") % 640), ("y", np.arange(n, dtype="u2") % 480), ("p", np.arange(n, dtype="u1") % 2), ("t", np.arange(n, dtype="u4"))):
        file.create_dataset("events/" + key, data=values, chunks=(256,), compression=32001, compression_opts=(0, 0, 0, 0, 1, 1, 5))
PY
  "$E2LF" info dsec.h5 --json >dsec.json
  check "$(json dsec.json "j['events'] == 1000 and j['events_on'] == 500 and j['last_t_us'] == 999 and j['left_out'] == []")"
fi
