# --report of each verb: one file that needs nothing else, tables as CSV and LaTeX, and charts of recordings as SVG.
model=$SOURCES/models/e2lf-n4.safetensors
"$E2LF" demo -o demo --width 64 --height 48 --quiet
"$E2LF" simulate demo/scene -m "$model" --cycles 3 -o rec.raw --quiet

# page <file> <text...>: a page that stands alone, has these texts and draws no number that is none.
page() {
  local file=$1
  shift
  py - "$file" "$@" <<'PY'
import re, sys
from html.parser import HTMLParser
path, wanted = sys.argv[1], sys.argv[2:]
page = open(path, encoding="utf-8").read()
class Parser(HTMLParser):
    def __init__(self):
        super().__init__()
        self.open, self.text = [], ""
    def handle_starttag(self, tag, attributes):
        if tag not in ("meta", "img", "rect", "line"): self.open.append(tag)
        for name, value in attributes:
            assert not (name in ("src", "href") and not value.startswith("data:")), (tag, name, value)
    def handle_endtag(self, tag):
        if tag in ("rect", "line"): return
        assert self.open and self.open.pop() == tag, tag
    def handle_data(self, data):
        self.text += data
parser = Parser()
parser.feed(page)
assert not parser.open, parser.open
for text in wanted: assert text in parser.text, text
assert not re.search(r'="[^"]*\b(nan|inf)\b', page), path
PY
}

"$E2LF" eval demo/scene demo/recon --events demo/events.npz --report eval.html --report eval.csv --report eval.tex --quiet
page eval.html "PSNR dB" "events per pixel" "e2lf eval demo/scene demo/recon"
[ "$(head -1 eval.csv | tr -d '\r')" = "method,scene,psnr_db,ssim_uniform7,ssim_gaussian,epi_relative_error,bad_07_percent,bad_20_percent,mean_absolute_px,slope,events_per_pixel,min_measurement_ms,bits_per_light_field_pixel" ] || fail "columns"
"$E2LF" eval demo/scene demo/recon --json >eval.json
check "abs($(sed -n 2p eval.csv | cut -d, -f3) - $(json eval.json "j['psnr_db']")) < 1e-9"
grep -q 'begin{tabular}{llrrrrrrrrrrr}' eval.tex || fail "LaTeX"
[ "$(grep -c '<img' eval.html)" = 4 ] || fail "pictures"

"$E2LF" accumulate rec.raw -o cycles.npz --report cycles.html --report cycles.csv --report cycles.svg --quiet
page cycles.html "found complete" "cycles: number, confidence"
[ "$(wc -l <cycles.csv)" = 4 ] || fail "a row for each cycle"
"$E2LF" info rec.raw --report rate.svg --report rec.html --quiet >info.txt
grep -q 'fill="white"' rate.svg || fail "an SVG file has a background"
page rec.html "Events over time" "triggers" "M events/s"
fails 1 "recordings" "$E2LF" info demo/scene --report scene.html
"$E2LF-bench" reconstruct --width 48 --height 32 --runs 1 --report bench.html --report bench.csv --quiet
page bench.html "GFLOP/s" "float32"
grep -q '^float32,' bench.csv || fail "bench.csv: $(cat bench.csv)"
"$E2LF-bench" decode --events 20000 --seconds 0 --report decode.html --quiet
page decode.html "evt3 dense" "scalar reference"
"$E2LF-bench" simulate --width 64 --height 48 --seconds 0 --report simulate.html --quiet
page simulate.html "light_field_to_events"
"$E2LF-bench" rig --width 96 --height 64 --report rig.html --quiet
page rig.html "decode and accumulate"
"$E2LF-bench" rig --width 64 --height 48 --json --quiet >rig.json
[ "$(json rig.json "j['accumulated_is_summed']")" = True ] || fail "the sums of a small sensor"

fails 1 "(--overwrite)" "$E2LF" eval demo/scene demo/recon --report eval.html
fails 2 "tables" "$E2LF" eval demo/scene demo/recon --report eval.pdf
cp rec.raw rec.csv
fails 1 "two outputs" "$E2LF" accumulate rec.raw -o twice.npz --report twice.svg --report twice.svg
absent twice.npz twice.svg
fails 1 "rec.csv" "$E2LF" info rec.csv --report rec.csv --overwrite
absent eval.pdf
