# The documents. Other pages: the cases documents_*.

part documents
# Links in the documents lead somewhere, commands name what exists, and those of README.md work as written.
# Other pages: the cases documents_*.
documents=$TESTSUITE/documents/documents.py
py "$documents" links "$SOURCES" >problems.txt || fail "$(cat problems.txt)"
py "$documents" words "$SOURCES" "$E2LF" >problems.txt || fail "$(cat problems.txt)"

# A clone with the whole history is large, and what a change is asked for stands where people look for it.
grep -q "git clone --depth 1" "$SOURCES/README.md" || fail "README.md does not say how to clone"
for word in "march=native" OpenCV "derived from data of others" "with its figures"; do
  grep -q -- "$word" "$SOURCES/CONTRIBUTING.md" || fail "CONTRIBUTING.md says nothing of $word"
done
for word in 127.0.0.1 origin plugin readers "latest release"; do
  grep -q -- "$word" "$SOURCES/SECURITY.md" || fail "SECURITY.md says nothing of $word"
done

# The checks see what is wrong.
mkdir -p wrong/docs
printf '# A\n[b](none.md) [c](#d)\n```\ne2lf info x.raw\n```\n```sh\ne2lf inffo x.raw\n```\n`e2lf info --jsonn` `e2lf codes show --flip-x` `--nonsense` `models/none.safetensors`\n```bash\necho\n```\n```python\n1\n```\n' >wrong/docs/a.md
touch wrong/README.md
if py "$documents" links wrong >problems.txt; then fail "broken links pass"; fi
[ "$(wc -l <problems.txt)" -eq 6 ] || fail "$(cat problems.txt)"
if py "$documents" words wrong "$E2LF" >problems.txt; then fail "wrong words pass"; fi
[ "$(wc -l <problems.txt)" -eq 5 ] || fail "$(cat problems.txt)"

source "$TESTSUITE/documents/page.sh"
page README.md
exists README/out/lightfield/07_07.png README/out/part.hdf5

part documents_tutorial
# The commands of the tutorial work as written.
source "$TESTSUITE/documents/page.sh"
page docs/tutorial.md
exists tutorial/out/mine/cycles/cycle_00002/07_07.png tutorial/out/mine/views/epi.png tutorial/out/mine/depth

part licences
# docs/packages.md names every library that the program loads.
objdump -p "$E2LF" | sed -n 's/^ *NEEDED *\(lib[a-z0-9A-Z+_-]*\|ld-linux\).*/\1/p' >needed.txt
[ "$(wc -l <needed.txt)" -ge 8 ] || fail "no libraries found: $(cat needed.txt)"
skip_sanitizers "sanitizers add libraries of their own"
while read -r library; do
  grep -q "^|.*\`$library\`" "$SOURCES/docs/packages.md" || fail "$library is not in docs/packages.md"
done <needed.txt
