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
