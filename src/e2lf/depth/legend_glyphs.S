/* SPDX-License-Identifier: MIT */
/* The characters of legends, a PNG of scripts/draw_legend_glyphs.mjs. */
        .section .rodata
        .global e2lf_depth_glyphs_begin
        .global e2lf_depth_glyphs_end
e2lf_depth_glyphs_begin:
        .incbin E2LF_LEGEND_GLYPHS
e2lf_depth_glyphs_end:
        .byte 0
        .section .note.GNU-stack,"",%progbits
