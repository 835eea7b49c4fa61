# Pages that vanish: neither a killed browser nor one that stops reading disturbs the light fields, the other pages or the memory.
grep -q "This build has no viewer" <<<"$("$E2LF" view --help)" && skip "this build has no page (npm or libcpp-httplib-dev was not found)"
"$E2LF" demo -o demo --width 320 --height 240 --quiet
model=$SOURCES/models/e2lf-n4-live.safetensors
"$E2LF" simulate demo/scene -m "$model" --cycles 6 --seed 2 -o six.raw --quiet
"$E2LF" live 'replay:six.raw?repeat=1000' -m "$model" --json --size full >lines.json 2>log.txt &
instrument=$!
trap 'kill "$instrument" 2>/dev/null || true; remove_folder' EXIT
wait_for lines.json "$instrument"
cat >pages.py <<'PY'
import http.client, json, os, re, signal, socket, sys, time
process = sys.argv[1]
host, path = re.match("http://([^/]+)(/.*/)", json.loads(open("lines.json").readline())["url"]).groups()
ask = f"GET {path}picture?after=0&x=0.5&y=0.5 HTTP/1.1\r\nHost: {host}\r\n\r\n".encode()

def connect():
    return http.client.HTTPConnection(host, timeout=20)

def get(connection, name):
    connection.request("GET", path + name)
    answer = connection.getresponse()
    return answer.status, answer.read()

def fields():
    return json.loads(get(connect(), "statistics")[1])["fields"]

def memory_mib():
    return int(re.search(r"VmRSS:\s*(\d+)", open(f"/proc/{process}/status").read())[1]) / 1024

def vanish():
    """Another process looks at two pictures and is killed while it waits for the third."""
    child = os.fork()
    if child == 0:
        page = connect()
        for _ in range(2):
            get(page, "picture?after=0&x=0.5&y=0.5")
        page.sock.sendall(ask)
        os.kill(os.getpid(), signal.SIGKILL)
    assert os.WTERMSIG(os.waitpid(child, 0)[1]) == signal.SIGKILL

def stall():
    """Asks for pictures and reads none of them."""
    page = socket.socket()
    page.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
    page.connect(tuple(host.split(":")[:1]) + (int(host.split(":")[1]),))
    page.sendall(5 * ask)
    return page

def look(pictures, disturb):
    """Looks at so many pictures, with a disturbance before every third one. Returns the number of light fields
    that are made in the meantime."""
    page, before, after = connect(), fields(), 0
    for picture in range(pictures):
        if picture % 3 == 0:
            disturb()
        begin, status = time.time(), 0
        while status != 200:
            status, body = get(page, f"picture?after={after}&x=0.5&y=0.5")
            # The server waits 5 s for a page that does not read: nothing else may wait with it.
            assert time.time() - begin < 4, "light fields or another page wait for pages that do not read"
        head = json.loads(body[4 : 4 + int.from_bytes(body[:4], "little")])
        assert head["serial"] > after, head
        after = head["serial"]
    return fields() - before

while fields() < 5:
    time.sleep(0.1)
calm = look(24, lambda: None)
stalled = []
def disturb():
    vanish()
    if len(stalled) < 10:
        stalled.append(stall())
look(24, disturb)
before = memory_mib()
disturbed = look(72, disturb)
grown = memory_mib() - before
print(f"{calm} and {disturbed} light fields, {before:.0f} MiB and {grown:.1f} more")
assert 72 / disturbed > 0.6 * 24 / calm, "another page misses light fields"
assert os.environ.get("E2LF_SANITIZE") or grown < 8, "the memory grows"
PY
py pages.py "$instrument"
kill -INT "$instrument"
code=0
wait "$instrument" || code=$?
[ "$code" -eq 130 ] || fail "exit code $code after the pages vanished: $(cat log.txt)"
