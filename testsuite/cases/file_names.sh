# Names of files may hold any byte but "/": what is said of them in JSON is valid all the same.
"$E2LF" demo -o demo --width 48 --height 32 --quiet
odd=$(printf 'odd\377name')
cp -r demo/scene "$odd"
parsed() { py -c 'import json, sys; json.loads(sys.stdin.buffer.read().decode())'; }
"$E2LF" simulate "$odd" -o "$odd.raw" --cycles 2 --json | parsed
"$E2LF" info "$odd.raw" --json | parsed
"$E2LF" convert "$odd.raw" "$odd.csv" --json 2>stderr.txt | parsed
"$E2LF" accumulate "$odd.raw" -o "$odd.npz" --json | parsed
"$E2LF" reconstruct "$odd.raw" --method inversion -o "$odd.out" --json 2>stderr.txt | parsed
"$E2LF" eval "$odd" demo/recon -o "$odd.json" --json | parsed
"$E2LF" convert "$odd" "$odd.npy" --json | parsed
"$E2LF" codes show -o "codes$odd.json" --json | parsed
parsed <"$odd.json"
for record in "$odd".*.run.json "$odd.out/run.json"; do
  parsed <"$record" || fail "the record $record"
  py -c 'import json, sys; assert "odd\ufffdname" in open(sys.argv[1], encoding="utf-8").read()' "$record"
done
