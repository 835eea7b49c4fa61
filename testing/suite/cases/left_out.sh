# No event is left out in silence: what is dropped is counted by reason on stderr (with --quiet too), in --json and in the record; --strict refuses it.
py - <<'PY'
import random
random.seed(1)
t = 1000
rows = []
for i in range(50000):
    t += random.randint(0, 3)
    rows.append((random.randrange(64), random.randrange(48), random.randrange(2), t))
open("sorted.csv", "w").write("# x,y,p,t\n" + "".join("%d,%d,%d,%d\n" % r for r in rows))
random.shuffle(rows)
open("shuffled.csv", "w").write("# x,y,p,t\n" + "".join("%d,%d,%d,%d\n" % r for r in rows))
near = sorted(rows, key=lambda r: r[3] + random.randint(-1, 1))
open("jitter.csv", "w").write("# x,y,p,t\n" + "".join("%d,%d,%d,%d\n" % r for r in near))
PY
# Slight disorder: every event is there, in order of time. A recording without order is refused.
py - <<'PY'
import numpy as np
for order in ("jitter", "shuffled"):
    a = np.loadtxt(order + ".csv", delimiter=",", dtype=np.int64)
    np.savez(order + ".npz", x=a[:, 0].astype(np.uint16), y=a[:, 1].astype(np.uint16), p=a[:, 2].astype(np.uint8), t=a[:, 3])
    records = np.zeros(len(a), dtype=[("x", "u2"), ("y", "u2"), ("p", "i2"), ("t", "i8")])
    for i, name in enumerate("xypt"):
        records[name] = a[:, i]
    np.save(order + ".npy", records)
PY
for input in shuffled.csv shuffled.npz shuffled.npy; do
  fails 1 "$input" "$E2LF" convert "$input" out.npz
done
absent out.npz
for input in jitter.csv jitter.npz jitter.npy; do
  "$E2LF" convert "$input" out.npz --overwrite --strict --json >out.json
  check "$(json out.json "j['events'] == 50000 and j['left_out'] == [] and j['sorted'] > 0")"
  py - <<'PY'
import numpy as np
a, b = np.load("out.npz"), np.loadtxt("sorted.csv", delimiter=",", dtype=np.int64)
columns = np.stack([a[k].astype(np.int64) for k in "xypt"], 1)
assert (np.diff(columns[:, 3]) >= 0).all()
order = lambda m: m[np.lexsort(m.T)]
assert np.array_equal(order(columns), order(b))
PY
done
"$E2LF" convert - out.npz --overwrite --json --event-format csv <jitter.csv >out.json
check "$(json out.json "j['events']") == 50000"
cat jitter.csv | "$E2LF" convert - out.npz --overwrite --json --event-format csv >out.json
check "$(json out.json "j['events']") == 50000"

# What is outside the sensor is said, with the count and the remedy.
"$E2LF" convert sorted.csv small.npz --sensor-width 32 --sensor-height 48 --quiet 2>stderr.txt
grep -qE "left out [0-9]+ events outside the sensor; if the sensor is larger than the size that the file states or that was given" stderr.txt || fail "$(cat stderr.txt)"
"$E2LF" convert sorted.csv small.npz --sensor-width 32 --sensor-height 48 --overwrite --json >out.json 2>stderr.txt
check "$(json out.json "j['left_out'][0]['reason'] == 'out_of_range' and j['left_out'][0]['count'] + j['events'] == 50000")"
fails 1 "strict" "$E2LF" convert sorted.csv strict.npz --sensor-width 32 --sensor-height 48 --strict
absent strict.npz
"$E2LF" info sorted.csv --sensor-width 32 --sensor-height 48 --json >out.json
check "$(json out.json "j['left_out'][0]['count'] + j['events'] == 50000")"

# Zeros in a chunk of HDF5, as an interrupted copy leaves them, are no events, and all lost events are counted.
"$E2LF" convert sorted.csv whole.hdf5 --sensor-width 64 --sensor-height 48 --quiet
py - <<'PY'
import h5py
with h5py.File("whole.hdf5") as f:
    chunks = [f["CD/events"].id.get_chunk_info(i) for i in range(3)]
whole = open("whole.hdf5", "rb").read()
for name, begins in dict(half=[(chunks[1], chunks[1].size // 2)], all=[(chunks[1], 0)],
                         both=[(chunks[0], chunks[0].size // 2), (chunks[2], 0)]).items():
    damaged = bytearray(whole)
    for chunk, begin in begins:
        damaged[chunk.byte_offset + begin : chunk.byte_offset + chunk.size] = bytes(chunk.size - begin)
    open(name + ".hdf5", "wb").write(damaged)
    open(name + ".txt", "w").write(str(begins[0][0].byte_offset))
PY
for name in half all both; do
  "$E2LF" info $name.hdf5 --json >info.json 2>/dev/null
  check "$(json info.json "j['events'] + sum(l['count'] for l in j['left_out']) == 50000")"
  check "$(json info.json "j['left_out'][0]['first_byte'] == $(cat $name.txt) or j['left_out'][-1]['first_byte'] == $(cat $name.txt)")"
  "$E2LF" convert $name.hdf5 out.npz --overwrite --quiet 2>/dev/null
  py -c "
import numpy as np
a = np.load('out.npz')
assert ((a['x'] == 0) & (a['y'] == 0) & (a['p'] == 0)).sum() < 40, 'zeros became events'" || fail "$name"
done
check "$(json info.json "{l['reason'] for l in j['left_out']} == {'zero_words', 'bad_record'}")"
"$E2LF" info all.hdf5 --json >info.json 2>/dev/null
check "$(json info.json "j['left_out'][0]['reason'] == 'bad_record' and j['left_out'][0]['count'] == 16384")"
fails 1 "zeros" "$E2LF" convert half.hdf5 strict.npz --strict
absent strict.npz

# Exact duplicates are counted.
py -c "
rows = open('sorted.csv').read().splitlines()
open('twice.csv', 'w').write('\n'.join(r for row in rows for r in [row] * (2 if row[0] == '5' else 1)) + '\n')"
"$E2LF" info sorted.csv --json >info.json
before=$(json info.json "j['duplicates']")
"$E2LF" info twice.csv --json >info.json
check "$(json info.json "j['duplicates'] - $before == j['events'] - 50000 and j['duplicates'] > 8000")"
"$E2LF" info twice.csv | grep -q "% of the events are exact duplicates" || fail "duplicates are not told"

# Damage in RAW is in the JSON of convert and accumulate, and --strict refuses it.
"$E2LF" demo -o demo --width 96 --height 64 --quiet
"$E2LF" simulate demo/scene -o recording.raw --quiet
py - <<'PY'
data = bytearray(open("recording.raw", "rb").read())
middle = len(data) // 2
del data[middle:middle + 3]
open("damaged.raw", "wb").write(data)
PY
"$E2LF" convert damaged.raw damaged.npz --json --quiet >out.json 2>stderr.txt
check "$(json out.json "sum(l['count'] for l in j['left_out'])") > 0"
grep -q "damaged.raw: left out" stderr.txt || fail "convert says nothing: $(cat stderr.txt)"
fails 1 "strict" "$E2LF" convert damaged.raw strict.npz --strict
absent strict.npz
fails 1 "strict" "$E2LF" accumulate damaged.raw -o strict.npz --strict
absent strict.npz strict.npz.run.json

# No event is no result; a range is of the recording's clock, or with --relative since its first event.
printf '%%geometry:64,48\n' >empty.csv
fails 1 "empty.csv" "$E2LF" convert empty.csv empty.npz
fails 1 "is empty" "$E2LF" convert sorted.csv range.npz --from-us 2 --to-us 1
fails 1 "sorted.csv" "$E2LF" convert sorted.csv range.npz --from-us 900000000
absent empty.npz range.npz
"$E2LF" convert sorted.csv range.npz --from-us 11000 --to-us 21000 --json >absolute.json
first=$(sed -n 2p sorted.csv | cut -d, -f4)
"$E2LF" convert sorted.csv range.npz --from-us $((11000 - first)) --to-us $((21000 - first)) --relative --shift-time --overwrite --json >relative.json
"$E2LF" convert sorted.csv range.npz --from-us 11000 --to-us 21000 --shift-time --overwrite --json >shifted.json
check "$(json absolute.json "j['events']") == $(json relative.json "j['events']") == $(json shifted.json "j['events']") > 0"

# A text whose columns are not known is no recording without events.
printf 'frame,time,row,column,sign\n1,2,3,4,5\n' >unknown.csv
fails 1 "--columns" "$E2LF" info unknown.csv
fails 1 "--columns" "$E2LF" convert unknown.csv unknown.npz
absent unknown.npz
# Event images of another size are not those of a light field.
"$E2LF" simulate demo/scene -o demo.npz --quiet
"$E2LF" demo -o small --width 80 --height 64 --quiet
fails 1 "light field" "$E2LF" eval small/scene small/scene --events demo.npz
# What info tells of triggers, of a sensor of unknown size, and of packed data.
"$E2LF" info recording.raw --json >info.json
check "$(json info.json "j['trigger_channels'][0]['rising'] > 0 and j['trigger_channels'][0]['rising_period_us'] > 0 and j['extents']['width'] <= 96")"
"$E2LF" info sorted.csv >info.txt
grep -Eq "^extents width +64$" info.txt || fail "$(cat info.txt)"
"$E2LF" pack demo/scene -o packed.safetensors --quiet
"$E2LF" info packed.safetensors --json >info.json
check "$(json info.json "j['kind'] == 'training data' and len(j['light_fields']) == 1")"
fails 1 "strict" "$E2LF" reconstruct damaged.raw --method inversion -o strict --strict
absent strict
# Maps that were finished before the damage are written without --strict, and not with it.
"$E2LF" simulate demo/scene --cycles 4 -o cycles.raw --quiet
py - <<'PY'
data = bytearray(open("cycles.raw", "rb").read())
del data[len(data) * 7 // 8:len(data) * 7 // 8 + 3]
open("late.raw", "wb").write(data)
PY
"$E2LF" depth late.raw -m e2lf-n4-depth -o maps --quiet 2>stderr.txt
exists maps/cycle_00000/disparity.npy
fails 1 "strict" "$E2LF" depth late.raw -m e2lf-n4-depth -o strict --strict
absent strict

# A simulated recording says where its format has no place for triggers.
"$E2LF" simulate demo/scene -o simulated.csv --quiet 2>stderr.txt
grep -q "cannot hold triggers" stderr.txt || fail "triggers vanished: $(cat stderr.txt)"
for flags in "-o simulated.raw" "-o again.csv --no-triggers"; do
  "$E2LF" simulate demo/scene $flags --quiet 2>stderr.txt
  [ ! -s stderr.txt ] || fail "$flags: $(cat stderr.txt)"
done

# The counts of event images are of 16 bits: events of a pixel beyond that are counted like other losses.
py - <<'PY'
rows = ["%geometry:8,8", "0,0,1,0"] + ["1,1,1,%d" % (100000 + i) for i in range(40000)] + ["0,0,1,400000"]
open("hot.csv", "w").write("\n".join(rows) + "\n")
PY
echo '{"patterns": [{"duration_us": 100000}, {"duration_us": 100000, "image": 0}]}' >two.json
hot=("$E2LF" accumulate hot.csv --source schedule --origin-us 0 --schedule two.json --max-cycles 1)
"${hot[@]}" -o hot.npz --json >out.json 2>stderr.txt
check "$(json out.json "[(l['reason'], l['count']) for l in j['left_out']]") == [('saturated', 40000 - 32767)]"
grep -q "hot.csv: left out 7233 events of pixels with more than 32,767 in an event image" stderr.txt || fail "$(cat stderr.txt)"
[ "$(json hot.npz.run.json "j['notes']['left_out'][0]['count']")" = 7233 ] || fail "the record"
check "$(py -c 'import numpy as np; print(np.load("hot.npz")["events"].max())') == 32767"
fails 1 "cannot count 7233 events" "${hot[@]}" -o strict.npz --strict
absent strict.npz
py - <<'PY'
import numpy as np
events = np.zeros((2, 3, 48, 64), np.int16)
events[:, 1, 5, 6] = 20000
np.savez("sum.npz", events=events)
PY
sums=("$E2LF" reconstruct sum.npz -m "$SOURCES/models/e2lf-n4-capture.safetensors" --cycles-per-field 2 --gain 1)
"${sums[@]}" -o sum --json >out.json 2>stderr.txt
check "$(json out.json "[(l['reason'], l['count']) for l in j['left_out']]") == [('saturated', 40000 - 32767)]"
fails 1 "cannot count 7233 events" "${sums[@]}" -o strict --strict
absent strict

# What a replayed recording leaves out is accounted for as the file's is.
left_out() { json out.json "sorted((l['reason'], l['count']) for l in j['left_out'])"; }
"$E2LF" convert damaged.raw file.npz --json --quiet >out.json 2>stderr.txt
of_file=$(left_out)
"$E2LF" convert replay:damaged.raw replayed.npz --json --quiet >out.json 2>stderr.txt
[ "$(left_out)" = "$of_file" ] || fail "replayed: $(left_out), the file: $of_file"
grep -q "replay:damaged.raw: left out" stderr.txt || fail "$(cat stderr.txt)"
fails 1 "strict" "$E2LF" convert replay:damaged.raw strict.npz --strict
fails 1 "strict" "$E2LF" accumulate replay:damaged.raw -o strict.npz --strict
absent strict.npz
