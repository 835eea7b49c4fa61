# No output takes away what is not e2lf's own: inputs, folders of others, files in them, what links lead to.
"$E2LF" demo -o demo --width 48 --height 32 --quiet
mkdir cap && echo mine >cap/notes
"$E2LF" simulate demo/scene -o cap/rec.raw --cycles 2 --quiet
"$E2LF" simulate demo/scene -o ev.npz --quiet
find . -type f ! -name before.txt -print0 | sort -z | xargs -0 sha256sum >before.txt
sha256sum --quiet -c before.txt
ln -s cap link
ln -s cap/rec.raw plot.svg
untouched() { grep -v -F -e stdout.txt -e stderr.txt before.txt | sha256sum --quiet -c || fail "a file changed after: $*"; }
refused() { # <text> <command...>
  fails 1 "$@"
  untouched "$@"
}
by_inversion=("$E2LF" reconstruct --method inversion --overwrite)
refused "contains an input" "${by_inversion[@]}" cap/rec.raw -o cap
refused "contains an input" "${by_inversion[@]}" cap/rec.raw -o link
refused "contains an input" "${by_inversion[@]}" link/rec.raw -o .
refused "contains an input" "${by_inversion[@]}" replay:cap/rec.raw -o cap
refused "is an input" "${by_inversion[@]}" ev.npz -o ev.npz
refused "a file or link has this name" "${by_inversion[@]}" cap/rec.raw -o ev.npz
refused "lies in an input" "$E2LF" convert demo/scene demo/scene/again --overwrite
refused "is an input" "$E2LF" convert demo/scene demo/scene --overwrite
refused "e2lf did not write this folder" "$E2LF" convert demo/scene cap --overwrite
refused "e2lf did not write this folder" "$E2LF" demo -o cap --overwrite --width 48 --height 32
refused "is an input" "$E2LF" convert cap/rec.raw link/rec.raw --overwrite
refused "is an input" "$E2LF" convert "replay:cap/rec.raw?speed=10" cap/rec.raw --overwrite
refused "is an input" "$E2LF" convert - cap/rec.raw --format evt3 --overwrite <cap/rec.raw
refused "lies in an input" "$E2LF" simulate demo/scene -o demo/scene/ev.npz
refused "put it beside that, e.g. at $PWD/demo/x.json" "$E2LF" eval demo/scene demo/recon -o demo/recon/x.json
refused "is an input" "$E2LF" accumulate cap/rec.raw -o x.npz --report plot.svg --overwrite
refused "is an input" "$E2LF" pack demo/scene ev.npz -o ev.npz --overwrite
refused "is an input" "$E2LF" eval demo/scene demo/recon -o ev.npz --events ev.npz --overwrite
# What an option names is an input, too.
cp "$SOURCES/models/e2lf-n4-depth.safetensors" own.safetensors
"$E2LF" codes show -m e2lf-n4 -o own.npy --quiet
find . -type f ! -name before.txt -print0 | sort -z | xargs -0 sha256sum >before.txt
refused "is an input" "$E2LF" depth ev.npz --codes own.npy -o own.npy --overwrite
refused "is an input" "$E2LF" simulate demo/scene --codes ev.npz -o ev.npz --overwrite
refused "is an input" "$E2LF" model store own.safetensors -o own.safetensors --overwrite
mkdir folder.npz
refused "a folder has this name" "$E2LF" simulate demo/scene -o folder.npz --overwrite
ln "$PWD/cap/rec.raw" same.raw
refused "is an input" "$E2LF" convert cap/rec.raw same.raw --overwrite
ln -s nowhere dangling.npz
refused "a link whose target does not exist" "$E2LF" simulate demo/scene -o dangling.npz --overwrite

# A name says what is there: a folder does not get that of a file, a file not that of another format.
fails 1 "a name that ends in .mp4 is that of a file" "$E2LF" video cap/rec.raw -o frames.mp4
fails 1 "field.npz" "$E2LF" reconstruct ev.npz --method inversion -o field.npz
fails 1 "display.png" "$E2LF" codes render -o display.png
fails 1 "depth.jpg" "$E2LF" depth demo/scene -o depth.jpg
fails 1 "written as .safetensors" "$E2LF" pack demo/scene -o packed.npz
fails 1 "written as .json" "$E2LF" eval demo/scene demo/recon -o eval.png
fails 1 "written as .safetensors" "$E2LF" model store "$SOURCES/models/e2lf-n4.safetensors" -o model.onnx
absent frames.mp4 field.npz display.png depth.jpg packed.npz eval.png model.onnx

# A folder of e2lf's own is replaced, but not with what others put there.
"${by_inversion[@]}" cap/rec.raw -o out --quiet
mkdir out/more
for foreign in notes more/notes; do
  echo mine >"out/$foreign"
  refused "$foreign" "${by_inversion[@]}" ev.npz -o out
  [ "$(cat "out/$foreign")" = mine ] || fail "a note is gone"
  rm "out/$foreign"
done
ln -s ../cap out/link
refused "link" "${by_inversion[@]}" ev.npz -o out
rm out/link
"${by_inversion[@]}" ev.npz -o out --quiet
exists out/00_00.png out/run.json
absent out/cycle_00000 out/cycle_00001
untouched "the replacing"
[ "$(json out/run.json "'00_00.png' in j['files'] and 'notes' not in j['files'] and j['written_by']")" = e2lf ] || fail "the list of files"
rm out/00_00.png && ln -s ../cap/notes out/00_00.png
refused "which e2lf did not write" "${by_inversion[@]}" ev.npz -o out
# A result through a link goes where the link points.
mkdir elsewhere && ln -s elsewhere/e.npz far.npz && cp ev.npz elsewhere/e.npz
"$E2LF" simulate demo/scene -o far.npz --seed 2 --quiet --overwrite
[ -L far.npz ] && ! cmp -s ev.npz elsewhere/e.npz || fail "the link was replaced"
[ -z "$(find . -name '*.part')" ] || fail "temporary files were left behind"

# Errors name the result and not the place where it is made, and what the system says.
printf 'x,y,p,t\n0,0,1,-5\n1,1,0,20\n' >negative.csv
fails 1 "--shift-time" "$E2LF" convert negative.csv negative.raw --sensor-width 64 --sensor-height 48
"$E2LF" convert negative.csv negative.raw --sensor-width 64 --sensor-height 48 --shift-time --quiet
mkdir -m 555 locked
chmod 755 .
as_other=()
[ "$(id -u)" != 0 ] || as_other=(setpriv --reuid=65534 --regid=65534 --clear-groups)
if "${as_other[@]}" "$E2LF" --help >/dev/null 2>&1 && "${as_other[@]}" test -r negative.csv; then
  fails 1 "Permission" "${as_other[@]}" "$E2LF" convert negative.csv locked/x.csv
fi
