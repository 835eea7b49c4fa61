# e2lf refocus, epi and animate: what the pictures hold, and what is refused.
"$E2LF" demo -o demo --width 64 --height 48 --quiet
lf=demo/scene

# The picture of the demo is the one of refocus; several stand side by side with 4 px between them.
"$E2LF" refocus demo/recon --disparity=-1 -o near.png --quiet
exists near.png.run.json
"$E2LF" refocus "$lf" --disparity=-1,0,1.2 -o three.png --quiet
[ "$(identify -format '%wx%h' three.png)" = 200x48 ] || fail "the size of three pictures"
"$E2LF" refocus "$lf" --disparity=0 --aperture 0.5 --centre-row 0.5 --centre-column 0.5 -o view.png --quiet
convert "$lf/04_04.png" -depth 8 gray:view.gray
convert view.png -depth 8 gray:made.gray
cmp view.gray made.gray || fail "an aperture of one view is that view"

# An EPI is its row of all views.
"$E2LF" epi "$lf" --row 20 -o row.png --quiet
"$E2LF" epi "$lf" --column 30 --view 2 -o column.png --quiet
"$E2LF" epi "$lf" --row 20 --column 30 -o both.png --quiet
[ "$(identify -format '%wx%h' row.png) $(identify -format '%wx%h' column.png)" = "64x48 48x48" ] || fail "sizes of EPIs"
[ "$(identify -format '%wx%h' both.png)" = 116x100 ] || fail "the view with both EPIs"
convert "$lf/04_03.png" -crop 64x1+0+20 +repage -depth 8 gray:truth.gray
convert row.png -crop 64x1+0+18 +repage -depth 8 gray:made.gray
cmp truth.gray made.gray || fail "the row of view (4, 3)"
convert "$lf/05_02.png" -crop 1x48+30+0 +repage -depth 8 gray:truth.gray
convert column.png -crop 1x48+30+0 +repage -depth 8 gray:made.gray
cmp truth.gray made.gray || fail "the column of view (5, 2)"

fails 1 'there is no row 48; give 0 to 47' "$E2LF" epi "$lf" --row 48 -o x.png
fails 1 '--row' "$E2LF" epi "$lf" --view 2 -o x.png
fails 1 'aperture' "$E2LF" refocus "$lf" --disparity=0 --aperture 0 -o x.png
fails 2 '--aperture' "$E2LF" refocus "$lf" --disparity=0 --centre-row 1 -o x.png
fails 2 'disparity' "$E2LF" refocus "$lf" -o x.png
fails 1 'use .gif, .webm or .mp4' "$E2LF" animate "$lf" -o x.avi
fails 1 "x.png" "$E2LF" animate "$lf" --path orbit -o x.png
fails 1 '--from' "$E2LF" animate "$lf" --from 1 --to 2 -o x.gif
fails 1 '--still' "$E2LF" animate "$lf" --path focus --still=1 -o x.gif
fails 2 '--to' "$E2LF" animate "$lf" --path focus --from 1 -o x.gif
fails 1 'exceeds the image of 64x48 px' "$E2LF" refocus "$lf" --disparity=0,1e30 -o x.png
fails 1 'exceeds the image of 64x48 px' "$E2LF" animate "$lf" --still=-64 -o x.gif
# A name says what a file holds.
fails 1 ".png" "$E2LF" refocus "$lf" --disparity=0 -o x.jpg
fails 1 ".png" "$E2LF" epi "$lf" -o x.npy
absent x.jpg x.npy
fails 1 'light field' "$E2LF" refocus demo/events.npz --disparity=0 -o x.png
absent x.png x.avi x.gif

if "$E2LF" animate "$lf" -o orbit.gif --frames 6 --quiet 2>message.txt; then
  [ "$(identify -format '%wx%h ' orbit.gif)" = "64x48 64x48 64x48 64x48 64x48 64x48 " ] || fail "frames of the GIF"
  "$E2LF" animate "$lf" --path focus -o focus.webm --frames 6 --quiet
  "$E2LF" animate "$lf" --path sweep --still=-1 -o sweep.mp4 --frames 6 --quiet
  exists focus.webm sweep.mp4 sweep.mp4.run.json
else
  grep -q 'install libavcodec-dev' message.txt || fail "the message: $(cat message.txt)"
fi
