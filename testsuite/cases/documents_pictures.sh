# The commands of the pages on depth, models and comparisons work as written.
source "$TESTSUITE/documents/page.sh"
films() { "$E2LF" animate SCENE -o film.gif --frames 1 --quiet 2>/dev/null; }
depth() {
  e2lf demo -o demo --quiet
  ln -s demo/scene SCENE
  films || sed -i '/^e2lf animate .*\.\(gif\|mp4\)/s/^/echo "not run (this build has no FFmpeg): "/' ../depth.sh
}
models() { make release DIR; }
comparison() { ln -s configs/compare.json CONFIG; }
page docs/depth.md depth
exists depth/out/depth/points.ply depth/out/both.png
page docs/models.md models
exists models/e2lf-n4-camera.onnx
page docs/compare.md comparison
exists compare/out/compare/index.html compare/all/table.csv
