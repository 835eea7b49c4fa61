# docs/packages.md names every library that the program loads.
objdump -p "$E2LF" | sed -n 's/^ *NEEDED *\(lib[a-z0-9A-Z+_-]*\|ld-linux\).*/\1/p' >needed.txt
[ "$(wc -l <needed.txt)" -ge 8 ] || fail "no libraries found: $(cat needed.txt)"
skip_sanitizers "sanitizers add libraries of their own"
while read -r library; do
  grep -q "^|.*\`$library\`" "$TESTSUITE/../docs/packages.md" || fail "$library is not in docs/packages.md"
done <needed.txt
