# A live camera: the simulated HAL of testing/hal behind camera://metavision, in builds for tests.
# E2LF_REAL_HAL: the vendor's HAL with the simulated device of testing/hal/openeb (./run check camera).
[ -n "${E2LF_REAL_HAL:-}" ] || "$E2LF" --version | grep "^metavision: ON (.*simulated" >/dev/null || skip "this build has no simulated camera"
"$E2LF" demo -o demo --width 96 --height 64 --quiet
"$E2LF" simulate demo/scene -o sent.raw --cycles 4 --quiet
py -c 'b = open("sent.raw", "rb").read(); open("words", "wb").write(b[b.index(b"% end\n") + 6:])'
# words_of FILE: is what the camera sent, from its first word on, apart from the header; prints the number of bytes.
words_of() {
  py - "$1" <<'PY'
import sys
sent, kept = open("words", "rb").read(), open(sys.argv[1], "rb").read()
kept = kept[kept.index(b"% end\n") + 6:]
assert sent.startswith(kept), "not what was sent"
print(len(kept))
PY
}
camera() { E2LF_STAND_IN="serial=A1,B2;width=96;height=64;file=sent.raw;$1" "$E2LF" "${@:2}"; }
size=$(wc -c <words)

# None, one, several; busy and a second opener.
fails 1 "HAL" "$E2LF" camera list
[ "$(camera "" camera list --quiet | tr '\n' ' ')" = "camera://metavision/e2lf:stand_in:A1 camera://metavision/e2lf:stand_in:B2 " ] || fail "the list"
fails 1 "camera://metavision" "$E2LF" record camera://metavision -o x.raw
fails 1 "those connected are" camera "" record camera://metavision/C3 -o x.raw
fails 1 "busy" camera "busy" record camera://metavision -o x.raw
fails 1 "EVT4, which e2lf cannot read" camera "format=EVT4" convert camera://metavision x.csv
fails 1 "trigger input" camera "" record camera://metavision --trigger-channel 3 -o x.raw
fails 2 "--roi" camera "" record camera://metavision --roi 1,2,3 -o x.raw
fails 1 "camera settings" "$E2LF" info sent.raw --max-event-rate 5
absent x.raw x.csv x.bias

# Byte for byte, with the settings as they were read back.
printf '%s\n' '-20 % bias_diff_off' '30 % bias_diff_on' >low.bias
camera "period_us=200" record camera://metavision/B2 -o all.raw --seconds 3 --biases low.bias --max-event-rate 9000000 --roi 0,0,96,64 --json >all.json 2>log.txt
[ "$(words_of all.raw)" -eq "$size" ] || fail "$(words_of all.raw) of $size bytes"
grep -qxE "30 +% bias_diff_on" all.bias || fail "$(cat all.bias)"
[ "$(json all.raw.run.json 'j["notes"]["ended_by"], j["notes"]["biases"], j["options"]["max-event-rate"]')" = "('seconds', 'all.bias', '9000000')" ] || fail "$(cat all.raw.run.json)"
for key in serial_number=B2 sensor_name=IMX636 max_events_per_s=9000000 regions=0,0,96,64 "trigger_channels=main=0, aux=6"; do
  [ "$(json all.raw.run.json "j['notes']['header']['${key%%=*}']")" = "${key#*=}" ] || fail "$key in the record"
  name=${key%%=*}
  "$E2LF" info all.raw >info.txt
  grep -qE "^header ${name//_/ } +${key#*=}$" info.txt || fail "$key in the header: $(cat info.txt)"
done
"$E2LF" accumulate all.raw -o all.npz --source triggers --quiet
"$E2LF" accumulate sent.raw -o sent.npz --source triggers --quiet
py -c 'import numpy as np; assert (np.load("all.npz")["events"] == np.load("sent.npz")["events"]).all()'
# What a user put there is not replaced; what an earlier recording brought is.
fails 1 "low.bias" camera "" record camera://metavision -o low.raw
camera "end_at=20000;period_us=0" record camera://metavision -o all.raw --overwrite --quiet 2>log.txt || [ $? -eq 3 ] || fail "$(cat log.txt)"
grep -qxE "0 +% bias_diff_on" all.bias || fail "the biases of the earlier recording stayed"

# Cycles straight from the camera: triggers are on.
camera "period_us=200" accumulate camera://metavision -o live.npz --source triggers --max-cycles 2 --quiet
[ "$(json live.npz.run.json 'j["notes"]["header"]["serial_number"]')" = A1 ] || fail "the camera in the record of accumulate"
fails 3 "ended by itself" camera "period_us=0;end_at=$size" accumulate camera://metavision -o ended.npz --source triggers
py -c 'import numpy as np; assert (np.load("ended.npz")["events"] == np.load("sent.npz")["events"]).all()'

# An unplugged camera and a sender that breaks off keep what came, in every verb, and the exit code says so.
fails 3 "connection" camera "unplug_at=50001;buffer=1000;period_us=20000" record camera://metavision -o unplugged.raw
[ "$(words_of unplugged.raw)" -gt 30000 ] || fail "$(words_of unplugged.raw) bytes of 50001 before it was unplugged"
[ "$(json unplugged.raw.run.json 'j["notes"]["ended_by"]')" = failure ] || fail "the record of an unplugged camera"
fails 3 "connection" camera "unplug_at=50001;buffer=1000;period_us=20000" convert camera://metavision unplugged.csv --strict
fails 3 "connection" camera "unplug_at=50001;buffer=1000;period_us=20000" info camera://metavision
[ "$(wc -l <unplugged.csv)" -gt 1000 ] || fail "$(wc -l <unplugged.csv) events"
/usr/bin/python3 - <<'PY' &
import socket, struct, time
data = open("sent.raw", "rb").read()
server = socket.socket()
server.bind(("127.0.0.1", 0))
server.listen(2)
open("port", "w").write(str(server.getsockname()[1]))
for _ in range(2):
    connection, _ = server.accept()
    connection.sendall(data[:60000])
    time.sleep(1)
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))  # close() then resets
    connection.close()
PY
sender=$!
trap 'kill "$sender" 2>/dev/null || true; remove_folder' EXIT
wait_for port "$sender"
fails 3 "sender" "$E2LF" record "tcp://127.0.0.1:$(cat port)" -o reset.raw
cmp <(head -c 60000 sent.raw) reset.raw
fails 3 "sender" "$E2LF" convert "tcp://127.0.0.1:$(cat port)" reset.csv
[ "$(wc -l <reset.csv)" -gt 1000 ] || fail "$(wc -l <reset.csv) events"

# Ctrl-C keeps all that came.
E2LF_STAND_IN="serial=A1;width=96;height=64;file=sent.raw;period_us=1000" "$E2LF" record camera://metavision -o stopped.raw --quiet 2>log.txt &
recorder=$!
until [ "$(cat stopped.raw.*.part/* 2>/dev/null | wc -c)" -gt 150000 ]; do
  kill -0 $recorder || fail "ended before the signal: $(cat log.txt)"
  sleep 0.05
done
kill -INT $recorder
code=0
wait $recorder || code=$?
[ $code -eq 130 ] || fail "exit code $code: $(cat log.txt)"
[ "$(words_of stopped.raw)" -gt 100000 ] || fail "$(words_of stopped.raw) bytes"
[ "$(json stopped.raw.run.json 'j["notes"]["ended_by"]')" = signal ] || fail "the record of a stopped recording"

# The check says what is wrong.
camera "loop;period_us=500" camera check --seconds 1 --json --quiet >check.json 2>log.txt || fail "$(cat log.txt)"
[ "$(json check.json 'j["findings"], j["header"]["serial_number"]')" = "([], 'A1')" ] || fail "$(cat check.json)"
check "$(json check.json 'j["trigger_channels"][0]["rising_per_s"]') > 1"
check "0.2 < $(json check.json 'j["on_share"]') < 0.8"
fails 1 "no trigger within 3" camera "period_us=1000" camera check camera://metavision --trigger-channel none --seconds 3
grep -q "no trigger within 2 s; check the trigger cable" stderr.txt || fail "not while it waits: $(cat stderr.txt)"
fails 1 "camera://metavision" camera "file=nowhere" camera check camera://metavision --seconds 1
# What the sensor says that it dropped: OTHERS words 0x14 and 0x16.
py - <<'PY'
import struct
def report(kind, count):
    return struct.pack("<4H", 0xE000 | kind, 0xF000 | count & 0xFFF, 0xF000 | count >> 12 & 0xFFF, 0x7000 | count >> 24)
words = open("words", "rb").read()
open("dropping.raw", "wb").write(words[:40000] + report(0x14, 5000) + report(0x16, 4000) + words[40000:])
PY
fails 1 "the sensor dropped 1000 of 5000 events" camera "file=dropping.raw;period_us=100" camera check camera://metavision --seconds 2
E2LF_STAND_IN="serial=A1;width=96;height=64;file=dropping.raw;period_us=100" "$E2LF" record camera://metavision -o dropping2.raw --seconds 2 --quiet
"$E2LF" convert dropping2.raw dropping.hdf5 --quiet
[ "$(json dropping2.raw.run.json 'j["notes"]["sensor"]')" = "{'events_in': 5000, 'events_sent': 4000}" ] || fail "what the sensor counted, in the record of the recording"
[ "$(json dropping.hdf5.run.json 'j["notes"]["sensor"]')" = "{'events_in': 5000, 'events_sent': 4000}" ] || fail "what the sensor counted"
