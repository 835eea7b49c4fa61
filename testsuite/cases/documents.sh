# Links in the documents lead somewhere, and the commands of README.md and docs/tutorial.md work as written: in a folder that looks
# like the repository, with small pictures and few steps of training.
root=$TESTSUITE/..
py "$TESTSUITE/documents.py" links "$root" >problems.txt || fail "$(cat problems.txt)"

without=()
[ -x "$(dirname "$E2LF")/e2lf-train" ] || without=(--without runs/)
for document in README.md docs/tutorial.md; do
  folder=$(basename "$document" .md)
  mkdir -p "$folder/build/minimal/bin"
  ln -s "$root/models" "$root/configs" "$root/cameras" "$folder"
  py "$TESTSUITE/documents.py" commands "$root/$document" "${without[@]}" >"$folder/commands.sh"
  cat >"$folder/build/minimal/bin/e2lf" <<EOF
#!/bin/sh
verb=\$1; shift
case "\$verb" in demo) set -- "\$@" --width 96 --height 64 ;; esac
exec "$E2LF" "\$verb" "\$@"
EOF
  cat >"$folder/run" <<'EOF'
#!/bin/sh
verb=$1; shift
case "$verb" in
  demo) exec build/minimal/bin/e2lf demo -o out/demo --overwrite ;;
  train) exec build/minimal/bin/e2lf train "$@" --set train.steps=4 --set train.warmup_steps=1 --set train.hold_steps=2 \
    --set train.batch=2 --set data.pool=2 ;;
esac
EOF
  chmod +x "$folder/run" "$folder/build/minimal/bin/e2lf"
  (cd "$folder" && bash -ex commands.sh) >"$folder.txt" 2>&1 || fail "$document: $(tail -5 "$folder.txt")"
  if grep -q "warning: .*patterns" "$folder.txt"; then fail "$document: $(grep "warning:" "$folder.txt")"; fi
done
exists README/out/lightfield/07_07.png README/out/part.hdf5 tutorial/out/mine/cycles/cycle_00002/07_07.png \
  tutorial/out/mine/inversion/epi.png
