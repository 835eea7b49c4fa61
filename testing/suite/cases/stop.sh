# The first SIGINT or SIGTERM ends long work with what is complete (130, 143), also of live input; SIGKILL leaves what
# the next run finds, names and removes.
"$E2LF" demo -o demo --width 48 --height 32 --quiet
"$E2LF" simulate demo/scene -o rec.raw --cycles 4 --quiet
"$E2LF" accumulate rec.raw -o all.npz --source triggers --quiet
"$E2LF" simulate demo/scene -o long.raw --cycles 100 --quiet

# A sender that stays connected and never ends, as a camera does; it tells when everything is sent.
# Python itself, not a shell around it: what is killed at the end must be the sender.
head -c -1 rec.raw >cut.raw
"$E2LF" convert rec.raw rec.csv --quiet 2>/dev/null
head -c -3 rec.csv >cut.csv
cp rec.raw slow.raw
/usr/bin/python3 - rec.raw cut.raw cut.csv slow.raw <<'PY' &
import selectors, socket, sys, threading, time
def send(name, connection):
    data = open(name, "rb").read()
    pieces = 4 if name == "slow.raw" else 1
    try:
        for i in range(pieces):
            connection.sendall(data[len(data) * i // pieces : len(data) * (i + 1) // pieces])
            time.sleep(0.7)
        open("sent_" + name, "w")
    except OSError:
        pass
ready, kept = selectors.DefaultSelector(), []
for name in sys.argv[1:]:
    server = socket.socket()
    server.bind(("127.0.0.1", 0))
    server.listen(8)
    ready.register(server, selectors.EVENT_READ, name)
    open("port_of_" + name, "w").write(str(server.getsockname()[1]))
open("ready", "w")
while True:
    for key, _ in ready.select():
        kept.append(key.fileobj.accept()[0])
        threading.Thread(target=send, args=(key.data, kept[-1]), daemon=True).start()
PY
sender=$!
trap 'kill "$sender"; remove_folder' EXIT
until [ -e ready ]; do sleep 0.1; done
address_of() { echo "tcp://127.0.0.1:$(cat "port_of_$1")"; }
address=$(address_of rec.raw)

# ended <signal> <exit code> <condition> <command...>: sends the signal when the condition holds.
ended() {
  local signal=$1 code=$2 condition=$3 got=0 process
  shift 3
  "$@" >stdout.txt 2>stderr.txt &
  process=$!
  until eval "$condition"; do
    kill -0 "$process" 2>/dev/null || fail "ended before the signal: $* ($(cat stderr.txt))"
    sleep 0.1
  done
  kill "-$signal" "$process"
  wait "$process" || got=$?
  [ "$got" -eq "$code" ] || fail "exit code $got instead of $code after $signal from: $* ($(cat stderr.txt))"
}
# Whether the process of `ended` handles SIGTERM already (bit 14 of the mask).
catches_term() { (( 0x$(sed -n 's/^SigCgt:[[:space:]]*//p' "/proc/$process/status") & 0x4000 )); }
# The data of the file that is being written in the workspace of an output.
grown() { [ "$(cat "$1".*.part/* 2>/dev/null | wc -c)" -gt "$2" ]; }

size=$(stat -c %s rec.raw)
ended INT 130 'grown live.raw 20000' "$E2LF" convert "$address" live.raw --event-format evt3
grep -q "ended by SIGINT; everything that was complete was written" stderr.txt || fail "nothing was said"
[ "$("$E2LF" info live.raw --json | py -c "import json, sys; print(json.load(sys.stdin)['events'])")" -gt 0 ] || fail "live.raw"
ended TERM 143 'grown live.npz 1000' "$E2LF" accumulate "$address" -o live.npz --source triggers
py - <<'PY'
import numpy as np
whole, live = np.load("all.npz")["events"], np.load("live.npz")["events"]
assert 0 < len(live) <= len(whole) and np.array_equal(live, whole[: len(live)]), live.shape
PY
exists live.npz.run.json
ended INT 130 '[ -e live/cycle_00000 ]' "$E2LF" reconstruct "$address" --method inversion --source triggers -o live
exists live/run.json live/cycle_00000/07_07.png
[ "$(json live/run.json "len(j['notes']['cycles']) > 0 and j.get('complete', True)")" = True ] || fail "run.json of live"
ended INT 130 '[ -e replayed/cycle_00000 ]' "$E2LF" reconstruct replay:long.raw --method inversion --source triggers -o replayed
# The network stops within a light field: what is complete is kept, and an unfinished first one leaves nothing.
ended INT 130 '[ -e field/cycle_00001 ]' "$E2LF" reconstruct replay:long.raw -m e2lf-n4 --source triggers -o field
check "$(json field/run.json "len(j['notes']['cycles'])") == $(find field -name 'cycle_*' | wc -l)"
py - <<'PY'
import numpy as np
events = np.load("all.npz")["events"][:1]
np.savez("large.npz", events=np.tile(events, (1, 1, 22, 26)))
PY
ended INT 130 'catches_term && ls -d unfinished.*.part >/dev/null 2>&1' "$E2LF" reconstruct large.npz -m e2lf-n4 -o unfinished
grep -q "nothing was complete" stderr.txt || fail "$(cat stderr.txt)"
absent unfinished
# Who ends a stream ends it anywhere: inside a word is no damage, and strict reading keeps what there is.
ended INT 130 'grown strict.raw 20000' "$E2LF" convert "$(address_of cut.raw)" strict.raw --event-format evt3 --strict
exists strict.raw
ended INT 130 'grown strict.npz 1000' "$E2LF" accumulate "$(address_of cut.raw)" -o strict.npz --source triggers --strict
exists strict.npz
ended INT 130 'grown said.raw 20000' "$E2LF" convert "$(address_of cut.raw)" said.raw --event-format evt3
grep -qE "damage|left out|ends inside" stderr.txt && fail "a cut by a signal was called damage: $(cat stderr.txt)"
ended INT 130 'grown said.csv 20000' "$E2LF" convert "$(address_of cut.csv)" said.csv --event-format csv --strict
[ "$(sed '$!d' said.csv)" = "$(sed '$!d' rec.csv)" ] && fail "the line that was cut is there"
grep -qxF "$(sed '$!d' said.csv)" rec.csv || fail "a line that was cut passed for an event: $(sed '$!d' said.csv)"
mkfifo fifo
(exec 3>fifo; cat rec.raw >&3; until [ -e done ]; do sleep 0.1; done) &
ended TERM 143 'grown piped.npz 1000' "$E2LF" accumulate fifo --event-format evt3 -o piped.npz --source triggers
touch done
ended INT 130 'grown many.npz 20000' "$E2LF" simulate demo/scene -o many.npz --cycles 1000000
check "$(py -c 'import numpy as np; print(len(np.load("many.npz")["events"]))') > 0"
ended INT 130 'grown many.raw 100000' "$E2LF" simulate demo/scene -o many.raw --cycles 1000000
[ "$("$E2LF" accumulate many.raw -o of_many.npz --source triggers --json | py -c "import json, sys; print(json.load(sys.stdin)['complete'])")" -gt 0 ] || fail "many.raw"
# A signal before there is anything to keep leaves nothing.
ended INT 130 'ls none.npz.*.part >/dev/null 2>&1' "$E2LF" accumulate "$address" -o none.npz --source triggers --channel 9
absent none.npz
[ -z "$(find . -name '*.part')" ] || fail "temporary files were left behind: $(find . -name '*.part')"

# SIGKILL: the next run to the same place names and removes what is left. What was recorded of live input it only names.
ended KILL 137 'grown killed.npz 20000' "$E2LF" simulate demo/scene -o killed.npz --cycles 1000000
[ -n "$(find . -name 'killed.npz.*.part')" ] || fail "no partial file"
absent killed.npz
"$E2LF" simulate demo/scene -o killed.npz --cycles 2 2>stderr.txt
grep -q "killed.npz.*part: removed" stderr.txt || fail "the partial file was not named"
absent killed.npz.*.part
ended INT 130 'ls late.npz.*.part >/dev/null 2>&1' "$E2LF" convert "$address" late.npz --event-format evt3 --quiet
grep -q "late.npz: this format is written at the end.*record to .raw" stderr.txt || fail "$(cat stderr.txt)"
# A pipe that nobody reads or writes is not the disk's fault.
mkfifo unread.csv unwritten
for command in "convert rec.raw unread.csv" "info unwritten"; do
  # shellcheck disable=SC2086
  ended TERM 143 'catches_term && sleep 1' "$E2LF" $command
  grep -q "no program" stderr.txt || fail "$command: $(cat stderr.txt)"
done
ended KILL 137 'grown taken.raw 20000' "$E2LF" convert "$address" taken.raw --event-format evt3
"$E2LF" convert rec.raw taken.raw 2>stderr.txt
grep -q "taken.raw.*part: an interrupted run" stderr.txt || fail "the partial recording was not named"
[ "$("$E2LF" info taken.raw.*.part/taken.raw.*.part --json | py -c "import json, sys; print(json.load(sys.stdin)['events'])")" -gt 0 ] || fail "taken.raw"
rm -r taken.raw.*.part
ended KILL 137 '[ -e dead/cycle_00001 ]' "$E2LF" reconstruct replay:long.raw --method inversion --source triggers -o dead
cmp dead/cycle_00000/03_04.png live/cycle_00000/03_04.png
exists dead/cycle_00001/epi.png dead/cycle_00001/run.json
"$E2LF" reconstruct rec.raw --method inversion --source triggers -o dead --overwrite --quiet
exists dead/cycle_00003
[ "$(json dead/run.json "j.get('complete', True)")" = True ] || fail "run.json of the rerun"
[ -z "$(find . -name '*.part')" ] || fail "temporary files were left behind: $(find . -name '*.part')"
