# The commands of the page on calibration work as written.
source "$TESTSUITE/documents/page.sh"
calibration() {
  py - <<'PY'
import json
import numpy as np
values = 0.01 * 1.35 ** (np.arange(15) * 7 % 15)
scene = np.kron(values.reshape(3, 5), np.ones((100, 100)))
np.save("scene.npy", np.broadcast_to(scene, (8, 8, *scene.shape)).astype(np.float32))
rows = [["".join("1" if 8 * row + column < count else "0" for column in range(8)) for row in range(8)] for count in (0, 8, 48, 16)]
json.dump({"patterns": rows}, open("codes.json", "w"))
PY
  cp codes.json known.json
  e2lf simulate scene.npy --codes codes.json --camera evk4-lcos --cycles 4 -o events.npz --quiet
  e2lf simulate scene.npy --codes codes.json --camera evk4-lcos --cycles 2 -o still.raw --quiet
  for light in dim:0.5 middle:1 bright:2; do
    e2lf simulate scene.npy --codes codes.json --camera evk4-lcos --cycles 2 --scene-gain "${light#*:}" -o "${light%:*}.raw" --quiet
  done
}
page docs/calibration.md calibration
exists calibration/mine.json calibration/card.json.run.json
