# The pages on recordings and calibration.

part documents_recordings
# The commands of the pages on recordings, simulation and frames work as written.
source "$TESTSUITE/documents/page.sh"
scene() { e2lf demo -o demo --quiet && ln -s demo/scene SCENE; }
recordings() {
  scene
  ln -s models/e2lf-n4-camera.safetensors MODEL
  cp cameras/evk4-lcos.json mine.json
  e2lf simulate SCENE -m MODEL --camera evk4-lcos -o REC.raw --cycles 2 --quiet
}
video() {
  scene
  e2lf simulate SCENE -o recording.raw --cycles 2 --quiet
  make firenet checkpoint.safetensors
}
page docs/recordings.md recordings
exists recordings/display/contact_sheet.png recordings/out/mine/cycle_00001/07_07.png
block docs/recordings.md duration_us >schedule.json
"$E2LF" accumulate recordings/REC.raw --schedule schedule.json -o scheduled.npz --quiet
simulation() {
  scene
  mkdir -p out && ln -s ../demo out/demo
}
page docs/simulation.md simulation
exists simulation/out/lf/cycle_00004/00_00.png
page docs/video.md video
exists video/out/frames/frame_000000.png
page docs/viewer.md
# A simulated camera, in builds for tests.
if "$E2LF" --version | grep "^metavision: ON (.*simulated" >/dev/null; then
  export E2LF_STAND_IN="serial=A1;period_us=200;loop;file=$PWD/recordings/REC.raw"
  page docs/camera.md
  exists camera/capture.raw camera/capture.bias
fi
page docs/live.md
exists live/out/last.npy live/out/live.json

part documents_calibration
# The commands of the page on calibration work as written.
source "$TESTSUITE/documents/page.sh"
calibration() {
  py "$root/examples/calibration/grey_card.py" scene.npy codes.json
  cp codes.json known.json
  e2lf simulate scene.npy --codes codes.json --camera evk4-lcos --cycles 4 -o events.npz --quiet
  e2lf simulate scene.npy --codes codes.json --camera evk4-lcos --cycles 2 -o still.raw --quiet
  for light in dim:0.5 middle:1 bright:2; do
    e2lf simulate scene.npy --codes codes.json --camera evk4-lcos --cycles 2 --scene-gain "${light#*:}" -o "${light%:*}.raw" --quiet
  done
}
page docs/calibration.md calibration
exists calibration/mine.json calibration/card.json.run.json
