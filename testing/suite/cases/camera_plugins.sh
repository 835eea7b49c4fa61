# Camera plugins: shared libraries with a C interface, named in E2LF_CAMERA_PLUGINS.
compiler=${CXX:-c++}
command -v "$compiler" >/dev/null || skip "no compiler"
mkdir plugins
build() { "$compiler" -std=c++17 -Wall -Wextra -Werror -shared -fPIC -I "$SOURCES/src" "$1" -o "$2"; }
build "$SOURCES/examples/camera_plugin.cpp" plugins/edge.so
# The interface is C.
echo '#include "e2lf/recordings/live/camera_plugin.h"' >c.c
"$compiler" -x c -std=c99 -Wall -Wextra -Werror -pedantic -fsyntax-only -I "$SOURCES/src" c.c
export E2LF_CAMERA_PLUGINS=$PWD/plugins

"$E2LF" camera list --quiet >list.txt
grep -qx "camera://edge/edge" list.txt || fail "$(cat list.txt)"
grep -qx "camera://edge/loose" list.txt || fail "$(cat list.txt)"
"$E2LF" record camera://edge/edge -o edge.raw --seconds 1 --json >edge.json
"$E2LF" info edge.raw --json >info.json
check "$(json info.json 'j["triggers"]') > 50 and $(json info.json 'j["events"]') == 48 * round($(json info.json 'j["events"]') / 48) > 20000"
grep -qx "0 % bias_diff_on" edge.bias || fail "$(cat edge.bias)"
"$E2LF" record camera://edge -o off.raw --seconds 0.3 --trigger-channel none --quiet
[ "$("$E2LF" info off.raw --json | py -c 'import json, sys; print(json.load(sys.stdin)["triggers"])')" = 0 ] || fail "triggers are on"
echo "-7 % bias_diff_on" >low.bias
"$E2LF" record camera://edge -o low_biases.raw --seconds 0.2 --biases low.bias --quiet
grep -qx -- "-7 % bias_diff_on" low_biases.bias || fail "$(cat low_biases.bias)"
echo nonsense >bad.bias
fails 1 "biases" "$E2LF" record camera://edge -o x.raw --biases bad.bias
fails 1 "trigger input" "$E2LF" record camera://edge -o x.raw --trigger-channel aux
fails 1 "no roi" "$E2LF" record camera://edge -o x.raw --roi 0,0,8,8
fails 1 "edge/third" "$E2LF" record camera://edge/third -o x.raw
absent x.raw

# An unplugged camera keeps what came.
fails 3 "cable" "$E2LF" record camera://edge/loose -o loose.raw
[ "$("$E2LF" info loose.raw --json | py -c 'import json, sys; print(json.load(sys.stdin)["events"])')" = $((48 * 500)) ] || fail "events were lost"

# What is no plugin is left out with the reason, and the others still work.
cp plugins/edge.so plugins/twice.so
echo "not a library" >plugins/text.so
printf 'int nothing;\n' >symbol.cpp
build symbol.cpp plugins/symbol.so
plugin_with() { printf '#include "e2lf/recordings/live/camera_plugin.h"\nconst e2lf_camera_functions* e2lf_camera_plugin() { static e2lf_camera_functions f{}; (void)f; %s }\n' "$2" >bad.cpp && build bad.cpp "plugins/$1.so"; }
plugin_with version 'f.version = 99; f.name = "version"; return &f;'
plugin_with nameless 'f.version = 1; return &f;'
plugin_with slash 'f.version = 1; f.name = "a/b"; return &f;'
plugin_with empty 'f.version = 1; f.name = "empty"; return &f;'
plugin_with null 'return nullptr;'
plugin_with builtin 'f.version = 1; f.name = "replay"; return &f;'
"$E2LF" camera list 2>log.txt >list.txt
grep -qx "camera://edge/edge" list.txt || fail "$(cat list.txt log.txt)"
for said in "another one with the name edge" "text.so: cannot be loaded" "symbol.so: is not a camera plugin" \
  "version.so: the camera plugin has version 99" "nameless.so: the name of a camera plugin consists" "slash.so: the name of a camera plugin consists" \
  "empty.so: the camera plugin lacks one of" "null.so: the camera plugin returns no functions"; do
  grep -q "$said" log.txt || fail "\"$said\" is not in $(cat log.txt)"
done
E2LF_CAMERA_PLUGINS=nowhere.so:$PWD/plugins/edge.so fails 1 "nowhere.so" "$E2LF" record camera://nosuch -o x.raw
# Plugins that misbehave: an error without a message, a buffer without memory, no end after a stop, a message without an end.
cat >odd.cpp <<'CPP'
#include <chrono>
#include <cstring>
#include <thread>
#include "e2lf/recordings/live/camera_plugin.h"
struct e2lf_camera { char kind; };
static e2lf_camera* open(const char* address, char* error) {
  if (*address == 'l') std::memset(error, 'x', E2LF_CAMERA_ERROR_SIZE);
  return *address == 'l' || *address == 0 ? nullptr : new e2lf_camera{*address};
}
static void close(e2lf_camera* camera) { delete camera; }
static int start(e2lf_camera*, char*) { return 0; }
static e2lf_camera_state next(e2lf_camera* camera, e2lf_camera_buffer* buffer, char*) {
  std::this_thread::sleep_for(std::chrono::milliseconds(10));
  if (camera->kind == 'm') buffer->size = 1000;
  static bool has_sent = false;
  if (camera->kind == 'h' && has_sent) std::this_thread::sleep_for(std::chrono::hours(1));
  has_sent = true;
  static int number = 0;
  if ((camera->kind == 'g' || camera->kind == 'h') && number < 5) {
    static const char header[] = "% evt 3.0\n% geometry 64x48\n% end\n", words[] = "\x01\x80\x02\x60\x00\x00\x05\x20";
    buffer->bytes = reinterpret_cast<const uint8_t*>(number == 0 ? header : words);
    buffer->size = number == 0 ? sizeof header - 1 : 8;
    buffer->lost = number == 3 ? 2 : 0;
    if (++number == 5) return E2LF_CAMERA_RUNS;
  }
  return camera->kind == 's' ? static_cast<e2lf_camera_state>(-5) : E2LF_CAMERA_RUNS;
}
static void stop(e2lf_camera*) {}
const e2lf_camera_functions* e2lf_camera_plugin() {
  static const e2lf_camera_functions f = {1, "odd", nullptr, nullptr, open, close, nullptr, nullptr, nullptr, nullptr, start, next, stop};
  return &f;
}
CPP
build odd.cpp odd.so
export E2LF_CAMERA_PLUGINS=$PWD/odd.so
fails 1 "message" "$E2LF" record camera://odd -o x.raw
fails 1 "xxxx" "$E2LF" record camera://odd/long -o x.raw
fails 1 "message" "$E2LF" record camera://odd/silent -o x.raw
fails 1 "memory" "$E2LF" record camera://odd/memory -o x.raw
fails 1 "sent nothing" "$E2LF" record camera://odd/never -o x.raw --seconds 0.5
absent x.raw
# Its first bytes are kept though it never returns.
fails 3 "does not return" "$E2LF" record camera://odd/hung -o hung.raw --seconds 0.2
exists hung.raw
"$E2LF" record camera://odd/hung -o interrupted.raw 2>log.txt &
recorder=$!
until [ -s "$(echo interrupted.raw.*.part/interrupted.raw.*)" ]; do
  kill -0 $recorder || fail "ended before the signal: $(cat log.txt)"
  sleep 0.1
done
kill -INT $recorder
code=0
wait $recorder || code=$?
[ $code -eq 130 ] || fail "exit code $code: $(cat log.txt)"
[ -s interrupted.raw ] || fail "what arrived before Ctrl-C is lost"
fails 1 "lost 2 buffers" "$E2LF" camera check camera://odd/gap --seconds 1
# The record says where data are missing.
"$E2LF" record camera://odd/gap -o gap.raw --seconds 1 --quiet 2>log.txt
grep -q "gap.raw: data are missing at 1 place; its record lists them" log.txt || fail "$(cat log.txt)"
grep -q "the camera or its driver lost 2 buffers" log.txt || fail "$(cat log.txt)"
[ "$(json gap.raw.run.json 'j["notes"]["live"]["gaps"]')" = "[{'byte': $(($(wc -c <gap.raw) - 16)), 'dropped_bytes': 0, 'lost_buffers': 2}]" ] || fail "$(cat gap.raw.run.json)"
"$E2LF" convert camera://odd/gap gap.csv --quiet 2>log.txt &
converter=$!
sleep 1
kill -INT $converter
wait $converter || [ $? -eq 130 ] || fail "$(cat log.txt)"
[ "$(json gap.csv.run.json 'j["notes"]["live"]["lost_buffers"]')" = 2 ] || fail "$(cat gap.csv.run.json)"
