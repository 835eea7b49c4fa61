# Long steps draw one line on stderr, in a terminal and without --quiet alone; live input tells of each cycle, terminal or not.
"$E2LF" demo -o demo --width 64 --height 48 --quiet
"$E2LF" simulate demo/scene -m e2lf-n4 -o rec.raw --cycles 3 --quiet
model=$SOURCES/models/e2lf-n4.safetensors
"$E2LF" simulate demo/scene -m "$model" -o events.npz --cycles 2 --quiet
in_terminal() { py "$TESTSUITE/terminal.py" terminal.txt "$@" >stdout.txt; }
erase=$(printf '\r\033[K')

# shown <lines of progress, by "|"> <command...>
shown() {
  local labels=$1 label
  shift
  in_terminal "$@" || fail "exit code of: $* ($(cat terminal.txt))"
  IFS='|' read -ra labels <<<"$labels"
  for label in "${labels[@]}"; do
    grep -qF "$(printf '\r')$label  " terminal.txt || fail "no progress \"$label\" from: $* ($(cat -v terminal.txt))"
  done
  [ "$(tail -c 4 terminal.txt)" = "$erase" ] || fail "the line is left behind by: $* ($(tail -c 80 terminal.txt | cat -v))"
  in_terminal "$@" --overwrite --quiet || fail "exit code of: $* --quiet"
  [ ! -s terminal.txt ] || fail "--quiet draws: $* ($(cat -v terminal.txt))"
  "$@" --overwrite >stdout.txt 2>stderr.txt
  [ ! -s stderr.txt ] || fail "not in a terminal: $* ($(cat -v stderr.txt))"
}
shown "convert" "$E2LF" convert rec.raw rec.hdf5
shown "read scene|write" "$E2LF" convert demo/scene scene
shown "read scene|write" "$E2LF" convert demo/scene scene.npy
shown "accumulate|hash rec.raw" "$E2LF" accumulate rec.raw -o images.npz
shown "simulate|hash scene" "$E2LF" simulate demo/scene -m e2lf-n4 -o many.raw --cycles 5
shown "read scene|simulate" "$E2LF" simulate demo/scene -m e2lf-n4 -o many.npz --cycles 5
shown "reconstruct cycle_00000|reconstruct cycle_00001" "$E2LF" reconstruct events.npz -m "$model" -o network
shown "reconstruct cycle_00002" "$E2LF" reconstruct rec.raw --method inversion -o inverted
shown "read scene|read recon|compare" "$E2LF" eval demo/scene demo/recon -o eval.json
shown "pack" "$E2LF" pack demo/scene demo/recon -o packed.safetensors
shown "read" "$E2LF" info rec.raw
in_terminal "$E2LF" convert rec.raw rec.csv
grep -qE "convert  [1-9][0-9]* events  [0-9]+ s" terminal.txt || fail "nothing is counted: $(cat -v terminal.txt)"

# A message takes the line away first.
printf 'x,y,p,t\n0,0,1,10\nno event\n0,0,1,20\n' >bad.csv
in_terminal "$E2LF" convert bad.csv bad.npz
grep -qF "${erase}e2lf: $(printf '\033')[1;33mwarning:" terminal.txt || fail "the warning is behind the line: $(cat -v terminal.txt)"

# Live input, whichever way it comes.
for output in "accumulate -o live.npz" "reconstruct --method inversion -o live"; do
  for input in replay:rec.raw - fifo; do
    rm -f fifo && mkfifo fifo
    if [ $input = fifo ]; then cat rec.raw >fifo & fi
    # shellcheck disable=SC2086
    "$E2LF" ${output%% *} "$input" ${output#* } --source triggers --overwrite < <(cat rec.raw) >stdout.txt 2>stderr.txt
    for cycle in 0 1 2; do
      grep -qE "^e2lf: cycle $cycle: [1-9][0-9]* events, latency [0-9.]+ ms$" stderr.txt || fail "$output $input: $(cat stderr.txt)"
    done
    grep -qE "^e2lf: live input ended: 3 complete cycles[^;]*; [0-9]+ events; latency [0-9.]+ ms on average, [0-9.]+ ms at most$" stderr.txt || fail "$output $input: $(cat stderr.txt)"
  done
  # shellcheck disable=SC2086
  in_terminal "$E2LF" ${output%% *} replay:rec.raw ${output#* } --source triggers --overwrite
  [ "$(grep -c "cycle [012]: " terminal.txt)" = 3 ] || fail "$output in a terminal: $(cat -v terminal.txt)"
  if grep -q "$(printf '\033')" terminal.txt; then fail "two kinds of lines: $(cat -v terminal.txt)"; fi
  # shellcheck disable=SC2086
  "$E2LF" ${output%% *} replay:rec.raw ${output#* } --source triggers --overwrite --quiet 2>stderr.txt
  [ ! -s stderr.txt ] || fail "--quiet: $(cat stderr.txt)"
done
events=$(py -c 'import numpy as np; print(np.abs(np.load("live.npz")["events"].astype(int)).sum())')
[ "$events" -gt 0 ] && [ "$(json live.npz.run.json "sum(c['events'] for c in j['notes']['each'])")" = "$events" ] || fail "the events of the cycles"
# A named pipe is read once, as a recording: nothing peeks into it, and nothing reads it again for the record.
mkfifo once
cat rec.raw >once &
"$E2LF" convert once once.raw
"$E2LF" convert rec.raw file.raw
cmp file.raw once.raw
[ "$(json once.raw.run.json "j['inputs']")" = "[]" ] || fail "the record of a pipe"
