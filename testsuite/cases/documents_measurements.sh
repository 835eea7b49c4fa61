# The commands of the pages on measurements work as written; of those on the library and packages, the ones
# that build nothing.
source "$TESTSUITE/documents/page.sh"
measurements() {
  e2lf demo -o rendered --quiet
  ln -s rendered/scene SCENE
  ln -s models/e2lf-n4.safetensors MODEL
}
page docs/measurements.md measurements
page docs/library.md
page docs/packages.md
page docs/python.md
