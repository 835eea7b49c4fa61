# Outputs other than files, and full disks.

part output_streams
# Output to pipes, devices and full disks: data and text never mix, devices stay devices, and nothing fails in silence.
"$E2LF" demo -o demo --width 48 --height 32 --quiet
"$E2LF" simulate demo/scene -o rec.raw --cycles 2 --quiet
"$E2LF" convert rec.raw file.raw --format evt3 --quiet
for flag in "" --json; do
  # shellcheck disable=SC2086
  "$E2LF" convert rec.raw - --format evt3 $flag >piped.raw 2>text.txt
  cmp file.raw piped.raw || fail "the data on standard output ($flag)"
  grep -q events text.txt || fail "no summary on standard error ($flag)"
done
"$E2LF" convert rec.raw /dev/stdout --format evt3 2>text.txt >piped.raw
cmp file.raw piped.raw
for format in npy hdf5; do
  fails 1 "convert: -:" "$E2LF" convert rec.raw - --format "$format"
  [ ! -s stdout.txt ] || fail "$format wrote something"
done
absent ./-
fails 1 "a file whose name ends in .npz" "$E2LF" accumulate rec.raw -o /dev/null
fails 1 "ends in .npz" "$E2LF" accumulate rec.raw -o -
fails 1 "e.g. .raw or .hdf5" "$E2LF" simulate demo/scene -o - </dev/null
if grep -q "give the format" stderr.txt; then fail "simulate has no such option: $(cat stderr.txt)"; fi
absent ./-

mkfifo pipe.raw
cat pipe.raw >piped.raw &
"$E2LF" convert rec.raw pipe.raw --quiet
wait $!
cmp file.raw piped.raw
[ -p pipe.raw ] || fail "the named pipe was replaced"
"$E2LF" convert rec.raw /dev/null --format csv 2>text.txt
[ -c /dev/null ] || fail "/dev/null was replaced"
absent /dev/null.run.json /dev/null_triggers.csv
# Triggers that are lost are not said to be there.
grep -q "triggers, which are lost" text.txt || fail "$(cat text.txt)"
"$E2LF" convert rec.raw /dev/null --format csv >text.txt 2>warnings.txt
grep -q " events and 0 triggers in /dev/null" text.txt || fail "$(cat text.txt)"
fails 1 "/dev/null" "$E2LF" convert rec.raw /dev/null --format hdf5
"$E2LF" eval demo/scene demo/recon -o /dev/null --quiet
if [ "$(id -u)" = 0 ]; then
  mknod null.npz c 1 3 2>/dev/null || true
  if [ -c null.npz ]; then
    fails 1 "null.npz" "$E2LF" simulate demo/scene -o null.npz --overwrite
    [ -c null.npz ] || fail "a device was replaced"
  fi
fi

# A full disk behind standard output is an error of every verb.
full() {
  local got=0
  "$@" >/dev/full 2>stderr.txt || got=$?
  [ "$got" -eq 1 ] || fail "exit code $got from: $*"
  grep -q "standard output" stderr.txt || fail "nothing said about standard output by: $*"
}
full "$E2LF" info rec.raw
full "$E2LF" info rec.raw --json
full "$E2LF" eval demo/scene demo/recon
full "$E2LF" codes show
full "$E2LF" model info "$SOURCES/models/e2lf-n4.safetensors"
full "$E2LF" --help
full "$E2LF" convert --help
full "$E2LF" --version
fails 1 "cannot write" "$E2LF" convert rec.raw /dev/full --format evt3

part full_disk
# A disk that fills: one message, exit code 1, and nothing left; a limit on the size of files stands for it.
"$E2LF" demo -o demo --width 64 --height 64 --quiet
"$E2LF" simulate demo/scene -o rec.raw --cycles 20 --quiet
limited() ( # <KiB> <command...>
  ulimit -f "$1"
  shift
  "$@"
)
for output in a.hdf5 a.raw a.npz; do
  for size in 4 64; do
    fails 1 "cannot write" limited "$size" "$E2LF" convert rec.raw "$output"
    [ -z "$(find . -name 'a*')" ] || fail "left behind: $(find . -name 'a*')"
  done
done
fails 1 "cannot write" limited 16 "$E2LF" accumulate rec.raw -o a.npz --source triggers
fails 1 "cannot write" limited 16 "$E2LF" simulate demo/scene -o a.npz --cycles 20
fails 1 "cannot write" limited 1 "$E2LF" reconstruct rec.raw --method inversion --source triggers -o a
[ -z "$(find . -name 'a*' -o -name '*.part')" ] || fail "left behind: $(find . -name 'a*' -o -name '*.part')"
