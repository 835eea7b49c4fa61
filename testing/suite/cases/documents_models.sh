# The pages on training, measurements and pictures.

part documents_training
# The commands of the pages on training work as written, and those of the experiments that need no data.
source "$TESTSUITE/documents/page.sh"
training() {
  e2lf demo -o demo --quiet
  ln -s demo/scene SCENE
  ln -s demo/recon OTHER
  mkdir FOLDER
  convert demo/scene/00_00.png FOLDER/photograph.png
}
page docs/training.md training
page docs/experiments/decisions.md
page docs/experiments/camera-fit.md
page docs/experiments/imperfections.md
page docs/experiments/motion.md
page docs/experiments/plenoptic-scenes.md
page docs/experiments/geometry.md

part documents_measurements
# The commands of the pages on measurements work as written; of those on the library and packages, the ones
# that build nothing.
source "$TESTSUITE/documents/page.sh"
measurements() {
  e2lf demo -o rendered --quiet
  ln -s rendered/scene SCENE
  ln -s models/e2lf-n4.safetensors MODEL
}
page docs/measurements.md measurements
page docs/clusters.md
page docs/library.md
page docs/packages.md
page docs/python.md

part documents_pictures
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
page docs/compare.md comparison
exists compare/out/compare/index.html compare/all/table.csv
block docs/compare.md "Two methods" >two.json
"$E2LF" compare two.json -o two --quiet --set 'scenes=[{"name": "mine", "scenes": ["demo:1"], "width": 48, "height": 32}]' --set pictures=false
[ "$(json two/run.json "j['notes']['new_results']")" = 12 ] || fail "two methods, three sensors, two seeds"

part documents_pytorch
# The commands of the page on PyTorch work as written.
source "$TESTSUITE/documents/page.sh"
if PYTHONPATH=$E2LF_BUILD/python py -c "import e2lf.torch" 2>/dev/null; then
  demo() { e2lf demo -o out/demo --quiet; }
  page docs/pytorch.md demo
  exists pytorch/out/own/index.html pytorch/out/tuned/run.json
  grep -q "own network" pytorch/out/own/table.csv || fail "the network of the reader is not in the table"
else
  echo "not run (PyTorch or the Python package is not there): docs/pytorch.md"
fi
