# Links in the documents lead somewhere, commands name what exists, and those of README.md work as written.
# Other pages: the cases documents_*.
documents=$TESTSUITE/documents/documents.py
py "$documents" links "$TESTSUITE/.." >problems.txt || fail "$(cat problems.txt)"
py "$documents" words "$TESTSUITE/.." "$E2LF" >problems.txt || fail "$(cat problems.txt)"

# The checks see what is wrong.
mkdir -p wrong/docs
printf '# A\n[b](none.md) [c](#d)\n```\ne2lf info x.raw\n```\n```sh\ne2lf inffo x.raw\n```\n`e2lf info --jsonn` `e2lf codes show --flip-x` `--nonsense` `models/none.safetensors`\n' >wrong/docs/a.md
touch wrong/README.md
if py "$documents" links wrong >problems.txt; then fail "broken links pass"; fi
[ "$(wc -l <problems.txt)" -eq 4 ] || fail "$(cat problems.txt)"
if py "$documents" words wrong "$E2LF" >problems.txt; then fail "wrong words pass"; fi
[ "$(wc -l <problems.txt)" -eq 5 ] || fail "$(cat problems.txt)"

source "$TESTSUITE/documents/page.sh"
page README.md
exists README/out/lightfield/07_07.png README/out/part.hdf5
