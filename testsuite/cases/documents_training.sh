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
page docs/experiments/capture-at-equal-tones.md
page docs/experiments/plenoptic-scenes.md
page docs/experiments/geometry.md
