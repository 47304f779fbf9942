/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Printing into a text of limited size, piece by piece. */
#ifndef PART_PARAMS_TEXT_H
#define PART_PARAMS_TEXT_H

#include <stddef.h>

/* Append formatted text at the end of the string in text[size]; cuts what does not fit. */
void part_text_add(size_t size, char *text, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 3, 4)))
#endif
    ;

#endif
