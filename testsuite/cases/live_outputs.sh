# The outputs of live inputs: wrong inputs, names that are taken, inputs as outputs, and a disk that is full.
"$E2LF" demo -o demo --width 64 --height 48 --quiet
model=$TESTSUITE/../models/e2lf-n4-live.safetensors
"$E2LF" simulate demo/scene -m "$model" --cycles 3 -o three.raw --quiet
"$E2LF" simulate demo/scene -m "$model" --cycles 120 -o long.raw --quiet
limited() ( # <KiB> <command...>
  ulimit -f "$1"
  shift
  "$@"
)
head -c 1000 /dev/urandom >junk.raw
mkdir folder folder/mine
echo mine >taken.raw
echo mine >taken.npy
cp "$TESTSUITE/../models/e2lf-n4.safetensors" fine.npy
sha256sum three.raw taken.raw taken.npy fine.npy >before.txt

record=("$E2LF" record replay:three.raw -o)
fails 1 "live input" "$E2LF" record three.raw -o x.raw
fails 1 "live input" "$E2LF" record nowhere -o x.raw
fails 1 "nowhere.raw" "$E2LF" record replay:nowhere.raw -o x.raw
fails 1 "junk.raw" "$E2LF" record replay:junk.raw -o x.raw
fails 1 "(--overwrite)" "${record[@]}" taken.raw
fails 1 "folder" "${record[@]}" folder
fails 1 "input" "${record[@]}" three.raw --overwrite
fails 1 "cannot write" "${record[@]}" /dev/full
mkfifo pipe
fails 1 "output" timeout 60 "$E2LF" record pipe -o pipe
absent x.raw x.bias
# What had been written when the disk was full cannot be repeated: it is kept, with its record.
fails 1 "cannot write" limited 16 "$E2LF" record replay:long.raw -o part.raw
cmp <(head -c 16384 long.raw) part.raw
[ "$(json part.raw.run.json 'j["notes"]["header"] is not None')" = True ] || fail "the record of a full disk"

live=("$E2LF" live replay:three.raw -m "$model" --no-page --size half)
fails 1 "file" "${live[@]}" -o taken.raw
fails 1 "was not written by e2lf live" "${live[@]}" -o folder
fails 1 "input" "${live[@]}" -o three.raw
fails 1 "(--overwrite)" "${live[@]}" --last taken.npy
fails 1 "input" "${live[@]}" --fine fine.npy --last fine.npy --overwrite
fails 1 "written as .npy" "${live[@]}" --last last.png
fails 1 "device" "${live[@]}" --last /dev/full
fails 1 "model file" "${live[@]}" --fine nowhere -o new --record
fails 1 "nowhere.raw" "$E2LF" live replay:nowhere.raw -m "$model" --no-page -o new --last x.npy
fails 1 "complete pattern" "${live[@]}" -o new --source triggers --channel 7
absent new x.npy last.png
fails 1 "cannot write" limited 64 "${live[@]}" --last full.npy
absent full.npy full.npy.run.json
# A recording that stops where the disk is full does not stop the light fields, but the exit code says it.
fails 1 "the recording is incomplete: $PWD/new/recording_000.raw: cannot write" limited 64 "$E2LF" live replay:long.raw -m "$model" --no-page --size half --record -o new --seconds 5
[ "$(wc -c <new/recording_000.raw)" -eq 65536 ] || fail "$(wc -c <new/recording_000.raw) bytes of the recording"
check "$(json new/run.json 'j["notes"]["totals"]["fields"]') > 5"
sha256sum --quiet -c before.txt
[ -z "$(find . -name '*.part')" ] || fail "left behind: $(find . -name '*.part')"
