# The commands of the pages on depth, models and comparisons, and of the example, work as written.
source "$TESTSUITE/documents/page.sh"
models() { make release DIR; }
comparison() { ln -s configs/compare.json CONFIG; }
page docs/depth.md
exists depth/out/depth/points.ply depth/out/both.png
example() {
  make release DIR
  e2lf demo -o scene --quiet && mkdir out && mv scene/recon out/animals # in place of the light field of the capture
}
page docs/example.md example
exists example/out/animals.html example/out/rig_orbit.mp4
page docs/models.md models
exists models/e2lf-n4-camera.onnx
demo() { e2lf demo -o out/demo --quiet; }
page docs/outputs.md demo
exists outputs/quality.html
page docs/experiments/equivalence.md
exists equivalence/equivalence/index.html
page docs/compare.md comparison
exists compare/out/compare/index.html compare/all/table.csv
