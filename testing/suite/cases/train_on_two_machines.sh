# Data-parallel training between two network namespaces, each with its own end of a virtual cable: the same weights as
# one process, a lost peer, and going on with another number of processes.
train=$(dirname "$E2LF")/e2lf-train
[ -x "$train" ] || skip "built without torch"
# An option that a verb does not have is refused.
for useless in "resume run -o model.safetensors" "export run -o model.safetensors --set train.steps=1" "evaluate run a --overwrite"; do
  fails 2 "usage" "$train" $useless
done
[ "$(id -u)" -eq 0 ] && command -v ip >ip.txt || skip "network namespaces need root and iproute2"
one=e2lf_a_$$ two=e2lf_b_$$
ip netns add $one 2>netns.txt || skip "this machine does not allow network namespaces"
remove_hosts() {
  jobs -p | xargs -r kill -9 2>/dev/null || true
  ip netns del $one || true
  ip netns del $two || true
  remove_folder
}
trap remove_hosts EXIT
ip netns add $two
ip link add cable netns $one type veth peer name cable netns $two 2>netns.txt || skip "this kernel has no virtual cables"
for host in $one:10.77.0.1 $two:10.77.0.2; do
  ip -n "${host%:*}" addr add "${host#*:}/24" dev cable
  ip -n "${host%:*}" link set cable up
  ip -n "${host%:*}" link set lo up
done

py - <<'PY'
import json, struct
import numpy as np
rng = np.random.default_rng(1)
tensors = {"lightfield/a": rng.integers(0, 255, (8, 8, 40, 40), dtype=np.uint8),
           "lightfield/b": rng.integers(0, 255, (8, 8, 40, 40), dtype=np.uint8)}
header, at = {}, 0
for name, values in tensors.items():
    header[name] = {"dtype": "U8", "shape": values.shape, "data_offsets": [at, at + values.size]}
    at += values.size
text = json.dumps(header).encode()
text += b" " * (-len(text) % 8)
open("packed.safetensors", "wb").write(struct.pack("<Q", len(text)) + text + b"".join(v.tobytes() for v in tensors.values()))
json.dump({"name": "tiny", "data": {"file": "packed.safetensors", "validation": ["a"], "synthetic_share": 0.5, "pool": 4,
                                    "synthesiser": {"size": 32}},
           "patterns": {"begin_step": 2, "learn_steps": 8}, "network": {"widths": [8, 8], "blocks": [1, 1], "head_width": 4},
           "train": {"patch": 16, "batch": 4, "steps": 12, "warmup_steps": 2, "log_steps": 1, "evaluate_steps": 6,
                     "checkpoint_steps": 4}}, open("config.json", "w"))
PY

export OMP_NUM_THREADS=1 MASTER_ADDR=10.77.0.1 MASTER_PORT=29517
# become <rank> <arguments of e2lf-train...>: this process becomes the trainer, so that in the background its id is $!.
become() {
  local rank=$1 host=$one
  shift
  [ "$rank" -eq 0 ] || host=$two
  WORLD_SIZE=2 RANK=$rank exec ip netns exec $host "$train" "$@"
}
on() { (become "$@"); }

# The same weights and patterns, to rounding, as one process with the whole batch.
"$train" train config.json -o "$PWD/alone"
mkdir elsewhere && cp packed.safetensors elsewhere
(cd elsewhere && become 1 train config.json -o "$PWD/unused") &
on 0 train config.json -o "$PWD/both"
wait $!
absent elsewhere/unused
cat >compare.py <<'PY'
import json, struct, sys
import numpy as np
def read(path):
    data = open(path, "rb").read()
    (size,) = struct.unpack("<Q", data[:8])
    header = json.loads(data[8:8 + size])
    header.pop("__metadata__")
    def tensor(entry):
        begin, end = entry["data_offsets"]
        return np.frombuffer(data[8 + size + begin:8 + size + end], np.float32)
    return {name: tensor(entry) for name, entry in header.items()}
a, b = read(sys.argv[1]), read(sys.argv[2])
assert a.keys() == b.keys() and len(a) > 10
moved = max(np.abs(a[n] - a[n.replace("average/", "weights/")]).max() for n in a if n.startswith("average/"))
worst = max(np.abs(a[n] - b[n]).max() for n in a if n.startswith(("weights/", "average/", "patterns")))
print(f"largest difference {worst:.2e}, average to weights {moved:.2e}")
assert worst < 2e-5 and moved > 1e-4
PY
py compare.py alone/checkpoint.safetensors both/checkpoint.safetensors

# A peer that is killed ends the other with an error; the run goes on with one process.
become 1 train config.json -o "$PWD/unused" --set train.steps=100000 2>lost.txt &
follower=$!
become 0 train config.json -o "$PWD/lost" --set train.steps=100000 2>error.txt &
leader=$!
wait_for lost/checkpoint.safetensors $leader
kill -9 $follower
code=0
wait $leader || code=$?
[ $code -eq 1 ] || fail "exit code $code"
grep -qF "e2lf resume" error.txt || fail "no remedy in: $(cat error.txt)"
steps=$(tail -n 1 lost/log.csv | cut -d, -f1)
"$train" resume lost --set train.steps=$((steps + 2))
exists lost/tiny.safetensors lost/curves.html

# So does one whose cable is cut, which no closed connection tells.
become 1 train config.json -o "$PWD/unused" --set train.steps=100000 2>cut_two.txt &
follower=$!
become 0 train config.json -o "$PWD/cut" --set train.steps=100000 2>cut_one.txt &
leader=$!
wait_for cut/checkpoint.safetensors $leader
ip -n $two link set cable down
code=0
wait $leader || code=$?
[ $code -eq 1 ] || fail "exit code $code"
wait $follower && fail "the cut off process ended well" || true
grep -qF "e2lf resume" cut_one.txt || fail "no remedy in: $(cat cut_one.txt)"

# A batch that cannot be split, and a variable that is missing.
ip -n $two link set cable up
become 1 train config.json -o "$PWD/unused" --set train.batch=5 2>odd_two.txt &
fails 1 "split evenly" on 0 train config.json -o "$PWD/odd" --set train.batch=5
wait $! && fail "an odd batch was accepted" || true
WORLD_SIZE=2 RANK=0 fails 1 MASTER_ADDR env -u MASTER_ADDR WORLD_SIZE=2 RANK=0 "$train" train config.json -o "$PWD/none"
