# The commands of the tutorial work as written.
source "$TESTSUITE/documents/page.sh"
page docs/tutorial.md
exists tutorial/out/mine/cycles/cycle_00002/07_07.png tutorial/out/mine/inversion/epi.png
