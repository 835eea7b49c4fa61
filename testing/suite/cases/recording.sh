# A simulated recording gives back the event images that it was made from, by triggers, by bursts, and through a pipe.
"$E2LF" demo -o demo --width 96 --height 64 --quiet
"$E2LF" simulate demo/scene -o truth.npz --cycles 4 --quiet
"$E2LF" simulate demo/scene -o recording.raw --cycles 4 --quiet
"$E2LF" info recording.raw --json --report rate.svg >info.json
[ "$(json info.json "(j['format'], j['triggers'], j['num_violations'] if 'num_violations' in j else 0)")" = "('evt3', 64, 0)" ] || fail "info"
grep -q '^<svg' rate.svg || fail "no plot"
"$E2LF" accumulate recording.raw -o triggers.npz --source triggers --quiet
# The light of these patterns, and that of their inverses, differs so much that each change is a burst.
py -c 'import numpy as np; c = np.zeros((4, 64), np.float32); c[1, :24] = c[2, :44] = c[3, 44:] = 1; np.save("areas.npy", c.reshape(4, 8, 8))'
"$E2LF" simulate demo/scene --codes areas.npy -o areas.npz --cycles 4 --quiet
"$E2LF" simulate demo/scene --codes areas.npy -o areas.raw --cycles 4 --quiet
"$E2LF" accumulate areas.raw -o bursts.npz --source bursts --report cycles.svg --json >bursts.json
[ "$(json bursts.json "[cycle['number'] for cycle in j['each']]")" = "[0, 1, 2, 3]" ] || fail "the cycles found"
check "$(json bursts.json "min(cycle['confidence'] for cycle in j['each'])") == $(json bursts.json "j['least_confidence']") > 0.2"
[ "$(grep -o 'fill="#228833" fill-opacity' cycles.svg | wc -l)" -eq 12 ] || fail "the picture does not show four cycles of three images"
py -c 'import numpy as np; a, b = (np.load(f)["events"] for f in ("areas.npz", "bursts.npz")); assert a.shape == b.shape and (a == b).all()'
# Of eight patterns, too: the recording says how many.
"$E2LF" simulate demo/scene -m "$SOURCES/models/e2lf-n8.safetensors" -o eight.npz --cycles 2 --quiet
"$E2LF" simulate demo/scene -m "$SOURCES/models/e2lf-n8.safetensors" -o eight.raw --cycles 2 --quiet
"$E2LF" accumulate eight.raw -o eight_found.npz --source triggers --quiet
py -c 'import numpy as np; a, b = (np.load(f)["events"] for f in ("eight.npz", "eight_found.npz")); assert a.shape[1] == 7 and (a == b).all()'
"$E2LF" accumulate - -o piped.npz --source triggers --quiet <recording.raw
py - <<'PY'
import numpy as np
truth = np.load("truth.npz")["events"]
for name in ("triggers", "piped"):
    found = np.load(name + ".npz")["events"]
    assert found.shape == truth.shape, (name, found.shape)
    assert np.array_equal(found, truth), name
PY
# Straight from the recording to light fields, one folder per cycle as they come.
"$E2LF" reconstruct recording.raw --method inversion -o light_fields --quiet
exists light_fields/cycle_00000/07_07.png light_fields/cycle_00003/epi.png light_fields/run.json
# Live, at the speed of the recording: the same light fields, and how long each came after its cycle.
"$E2LF" reconstruct replay:recording.raw --source triggers --method inversion -o live --json >live.json
cmp live/cycle_00001/03_04.png light_fields/cycle_00001/03_04.png
check "all(0 < cycle['latency_s'] and cycle['latency_s'] > cycle['reconstruct_s'] for cycle in $(json live.json "j['cycles']"))"
"$E2LF" info replay:recording.raw --json >replayed.json
[ "$(json replayed.json "(j['events'], j['triggers'])")" = "$(json info.json "(j['events'], j['triggers'])")" ] || fail "replay"
cat recording.raw | "$E2LF" accumulate camera://pipe -o camera.npz --source triggers --quiet
cmp camera.npz piped.npz
fails 1 "no camera plugin \"nosuch\"" "$E2LF" info camera://nosuch
# The same from a socket. Python itself, not a shell around it: what is killed at the end must be the sender.
/usr/bin/python3 - recording.raw <<'PY' &
import socket, sys
server = socket.socket()
server.bind(("127.0.0.1", 0))
server.listen(1)
open("port", "w").write(str(server.getsockname()[1]))
connection, _ = server.accept()
connection.sendall(open(sys.argv[1], "rb").read())
connection.close()
PY
sender=$!
trap 'kill "$sender"; remove_folder' EXIT
wait_for port "$sender"
"$E2LF" accumulate "tcp://127.0.0.1:$(cat port)" -o socket.npz --source triggers --quiet
cmp socket.npz piped.npz
wait "$sender"
trap remove_folder EXIT
fails 1 "cannot connect" "$E2LF" accumulate tcp://127.0.0.1:1 -o none.npz
fails 1 "write tcp://127.0.0.1:PORT" "$E2LF" accumulate tcp://localhost -o none.npz
fails 1 "complete pattern" "$E2LF" accumulate recording.raw -o none.npz --source triggers --channel 5
absent none.npz
fails 1 "nothing.raw" "$E2LF" reconstruct nothing.raw --method inversion -o nothing
fails 1 ".npz" "$E2LF" accumulate recording.raw -o images.raw
# A recording in which nothing is found replaces nothing and leaves nothing.
"$E2LF" reconstruct truth.npz --method inversion -o kept --quiet
none=("$E2LF" reconstruct recording.raw --method inversion --source triggers --channel 5)
fails 1 "complete pattern" "${none[@]}" -o kept --overwrite
exists kept/cycle_00003/07_07.png # the old result
fails 1 "recording.raw" "${none[@]}" -o new
absent new
[ -z "$(find . -name '*.part')" ] || fail "temporary files were left behind"
