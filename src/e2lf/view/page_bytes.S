/* SPDX-License-Identifier: MIT */
/* The built page, byte for byte. */
        .section .rodata
        .global e2lf_view_page_begin
        .global e2lf_view_page_end
e2lf_view_page_begin:
        .incbin E2LF_VIEWER_PAGE
e2lf_view_page_end:
        .byte 0
        .section .note.GNU-stack,"",%progbits
