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
