# For the cases that run the commands of the documents: source this, then call page for each page. The commands run as written,
# one after another, in a folder that looks like the repository; e2lf and run there make small pictures and few steps.
root=$SOURCES
skip_sanitizers "the other cases run each verb with sanitizers"

# block <page> <word>: the first block of the page that contains the word.
block() { py "$TESTSUITE/documents/documents.py" block "$root/$1" "$2"; }

# page <path in the repository> [function]: the function makes the inputs that the page names, in the folder of the page.
page() {
  local page=$1 prepare=${2:-true} folder
  folder=$PWD/$(basename "$page" .md)
  mkdir -p "$folder/build/release/bin"
  for name in models configs cameras examples src; do ln -s "$root/$name" "$folder/$name"; done
  ln -s "$TESTSUITE/documents/run" "$folder/run"
  ln -s "$TESTSUITE/documents/e2lf" "$folder/build/release/bin/e2lf"
  ln -s "$(dirname "$E2LF")/e2lf-train" "$folder/build/release/bin/e2lf-train"
  ln -s "$TESTSUITE/documents/python3" "$folder/build/release/bin/python3"
  export E2LF
  (cd "$folder" && PATH=$folder/build/release/bin:$PATH && "$prepare") >"$folder.prepare.txt" 2>&1 ||
    fail "$page: its inputs: $(tail -5 "$folder.prepare.txt")"
  py "$TESTSUITE/documents/documents.py" script "$root/$page" "$TESTSUITE/documents/not_run.txt" >"$folder.sh"
  if [ ! -x "$(dirname "$E2LF")/e2lf-train" ]; then
    # Built without torch: what trains, and what uses the result.
    sed -i -E 's/^.*(runs\/|\bRUN\b|e2lf-train).*$/echo "not run (this build has no torch): a command of training"/' "$folder.sh"
  fi
  if ! "$E2LF" --version | grep -q "^films: ON"; then
    sed -i -E 's/^e2lf animate .*\.(gif|mp4|webm).*$/echo "not run (this build makes no films): e2lf animate"/' "$folder.sh"
  fi
  (cd "$folder" && PATH=$folder/build/release/bin:$PATH && bash -ex "$folder.sh") >"$folder.txt" 2>&1 ||
    fail "$page: $(tail -5 "$folder.txt")"
  if grep -q "warning: .*patterns" "$folder.txt"; then fail "$page: $(grep "warning:" "$folder.txt")"; fi
  grep "^not run" "$folder.txt" | sed "s|^|$page: |" || true
}
