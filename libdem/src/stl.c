/* SPDX-License-Identifier: GPL-3.0-or-later */
/* STL files, ASCII and binary: the triangles, and whether they close. Corners count as one where
 * their numbers are equal, as writers of STL leave them. Normals in the file are not used. */
#include <ctype.h>
#include <limits.h>
#include <stdio.h>

#include "internal.h"

enum { HEADER = 84, RECORD = 50, WORD = 64 };

typedef struct stl_text {
  const char *at, *end;
  int line;
} stl_text;

static int fail_text(const stl_text *text, const char *wanted, const char *found) {
  if (found[0] == '\0')
    return part_fail(PART_ERR_FORMAT,
                     "line %d: the file ends where '%s' should follow: it is cut "
                     "short",
                     text->line, wanted);
  return part_fail(PART_ERR_FORMAT, "line %d: '%.30s' where '%s' should be", text->line, found,
                   wanted);
}

/* Next word, "" at the end. */
static void next(stl_text *text, char word[WORD]) {
  int n = 0;
  while (text->at < text->end && isspace((unsigned char)*text->at))
    text->line += *text->at++ == '\n';
  while (text->at < text->end && !isspace((unsigned char)*text->at)) {
    if (n < WORD - 1)
      word[n++] = *text->at;
    text->at++;
  }
  word[n] = '\0';
}

static void skip_line(stl_text *text) {
  while (text->at < text->end && *text->at != '\n')
    text->at++;
}

static int same_word(const char *word, const char *wanted) {
  for (; *word != '\0' && *wanted != '\0'; word++, wanted++)
    if (tolower((unsigned char)*word) != *wanted)
      return 0;
  return *word == *wanted;
}

static int expect(stl_text *text, const char *wanted) {
  char word[WORD];
  next(text, word);
  return same_word(word, wanted) ? PART_OK : fail_text(text, wanted, word);
}

static int numbers(stl_text *text, double *to, double scale) {
  for (int c = 0; c < 3; c++) {
    char word[WORD], *end;
    next(text, word);
    to[c] = scale * strtod(word, &end);
    if (end == word || *end != '\0')
      return fail_text(text, "a number", word);
  }
  return PART_OK;
}

static int facet(stl_text *text, double scale, double *vertices) {
  double normal[3];
  PART_TRY(expect(text, "normal"));
  PART_TRY(numbers(text, normal, 1.0));
  PART_TRY(expect(text, "outer"));
  PART_TRY(expect(text, "loop"));
  for (int k = 0; k < 3; k++) {
    PART_TRY(expect(text, "vertex"));
    PART_TRY(numbers(text, vertices + 3 * k, scale));
  }
  PART_TRY(expect(text, "endloop"));
  return expect(text, "endfacet");
}

/* One solid or several after each other. */
static int read_text(const char *bytes, size_t size, double scale, int *count, double **vertices) {
  stl_text text = {bytes, bytes + size, 1};
  size_t capacity = 0;
  char word[WORD];
  int inside = 0;
  for (next(&text, word); word[0] != '\0'; next(&text, word)) {
    if (inside && same_word(word, "facet")) {
      PART_TRY(dem_grow(9 * (size_t)(*count + 1), sizeof(double), &capacity, vertices));
      PART_TRY(facet(&text, scale, *vertices + 9 * (size_t)*count));
      (*count)++;
    } else if (same_word(word, inside ? "endsolid" : "solid")) {
      skip_line(&text);
      inside = !inside;
    } else {
      return fail_text(&text, inside ? "facet or endsolid" : "solid", word);
    }
  }
  return inside ? fail_text(&text, "endsolid", "") : PART_OK;
}

static uint32_t number_at(const unsigned char *b) {
  return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static int read_binary(const unsigned char *bytes, uint32_t n, double scale, int *count,
                       double **vertices) {
  PART_TRY(dem_allocate(9 * (size_t)n, sizeof(double), vertices));
  for (size_t k = 0; k < n; k++)
    for (size_t c = 0; c < 9; c++) {
      const uint32_t bits = number_at(bytes + HEADER + RECORD * k + 12 + 4 * c);
      float value;
      memcpy(&value, &bits, sizeof value);
      (*vertices)[9 * k + c] = scale * (double)value;
    }
  *count = (int)n;
  return PART_OK;
}

/* Binary when the number of triangles in the header fits the size of the file: some binary files
 * begin with "solid", too. */
static int read_bytes(const unsigned char *bytes, size_t size, double scale, int *count,
                      double **vertices) {
  const uint32_t n = size >= HEADER ? number_at(bytes + HEADER - 4) : 0;
  size_t at = 0;
  if (size == 0)
    return part_fail(PART_ERR_FORMAT, "the file is empty");
  if (size >= HEADER && size == HEADER + RECORD * (size_t)n && n < INT32_MAX / 9)
    return read_binary(bytes, n, scale, count, vertices);
  while (at < size && isspace(bytes[at]))
    at++;
  if (size - at >= 5 && strncmp((const char *)bytes + at, "solid", 5) == 0)
    return read_text((const char *)bytes, size, scale, count, vertices);
  return part_fail(PART_ERR_FORMAT,
                   "this is no STL file, or cut short: it does not begin with 'solid', and as a "
                   "binary one of %lu triangles it would have %.0f bytes, not %lu",
                   (unsigned long)n, HEADER + RECORD * (double)n, (unsigned long)size);
}

/* ---- is it closed? -----------------------------------------------------------------------------
 */
typedef struct edge {
  double end[2][3]; /* the smaller end first */
  int triangle;
} edge;

static int by_place(const void *a, const void *b) {
  const double *x = (const double *)a, *y = (const double *)b;
  for (int c = 0; c < 3; c++)
    if (x[c] != y[c])
      return x[c] < y[c] ? -1 : 1;
  return 0;
}

static int by_ends(const void *a, const void *b) {
  const edge *e = a, *f = b;
  const int first = by_place(e->end[0], f->end[0]);
  if (first != 0)
    return first;
  const int second = by_place(e->end[1], f->end[1]);
  return second != 0 ? second : (e->triangle > f->triangle) - (e->triangle < f->triangle);
}

static void set_edges(int count, const double *vertices, edge *edges) {
  for (int k = 0; k < count; k++)
    for (int m = 0; m < 3; m++) {
      const double *a = vertices + 9 * (size_t)k + 3 * m;
      const double *b = vertices + 9 * (size_t)k + 3 * ((m + 1) % 3);
      edge *e = &edges[3 * (size_t)k + (size_t)m];
      const int turned = by_place(a, b) > 0;
      memcpy(e->end[turned], a, sizeof e->end[0]);
      memcpy(e->end[!turned], b, sizeof e->end[0]);
      e->triangle = k;
    }
}

/* On a closed surface every edge belongs to an even number of triangles: two, or four where parts
 * meet along it. */
int dem_stl_closed(const char *path, int count, const double *vertices) {
  const size_t n = 3 * (size_t)count;
  int status = PART_OK;
  edge *edges;
  PART_TRY(dem_allocate(n, sizeof *edges, &edges));
  set_edges(count, vertices, edges);
  qsort(edges, n, sizeof *edges, by_ends);
  for (size_t k = 0, end; k < n && status == PART_OK; k = end) {
    const edge *e = &edges[k];
    for (end = k + 1; end < n && by_place(e->end[0], edges[end].end[0]) == 0 &&
                      by_place(e->end[1], edges[end].end[1]) == 0;)
      end++;
    if ((end - k) % 2 != 0)
      status = part_fail(PART_ERR_FORMAT,
                         "the surface is not closed: the edge from (%.9g %.9g %.9g) to (%.9g %.9g "
                         "%.9g) m of triangle %d belongs to %lu triangles; if it is meant to be "
                         "open, say 'open yes'",
                         e->end[0][0], e->end[0][1], e->end[0][2], e->end[1][0], e->end[1][1],
                         e->end[1][2], e->triangle, (unsigned long)(end - k));
  }
  free(edges);
  return status == PART_OK ? status : part_fail_context(status, "STL file %s", path);
}

static int check_finite(int count, double *vertices) {
  if (count == 0)
    return part_fail(PART_ERR_FORMAT, "the file has no triangles");
  for (size_t k = 0; k < 9 * (size_t)count; k++) {
    if (!isfinite(vertices[k]))
      return part_fail(PART_ERR_FORMAT, "triangle %lu: a coordinate is not finite",
                       (unsigned long)(k / 9));
    vertices[k] += 0.0; /* no -0 */
  }
  return PART_OK;
}

static int read_file(const char *path, unsigned char **bytes, size_t *size) {
  FILE *file = fopen(path, "rb");
  long length = -1;
  if (file == NULL)
    return part_fail(PART_ERR_IO, "the file cannot be opened");
  if (fseek(file, 0, SEEK_END) == 0)
    length = ftell(file);
  int status = length < 0 || length == LONG_MAX || /* a folder */ fseek(file, 0, SEEK_SET) != 0
                   ? part_fail(PART_ERR_IO, "the file cannot be read")
                   : dem_allocate((size_t)length + 1, 1, bytes);
  if (status == PART_OK && fread(*bytes, 1, (size_t)length, file) != (size_t)length)
    status = part_fail(PART_ERR_IO, "the file cannot be read");
  fclose(file);
  *size = (size_t)length;
  return status;
}

int dem_stl_read(const char *path, double scale, int *count, double **vertices) {
  unsigned char *bytes = NULL;
  size_t size = 0;
  *count = 0;
  *vertices = NULL;
  int status = read_file(path, &bytes, &size);
  if (status == PART_OK)
    status = read_bytes(bytes, size, scale, count, vertices);
  if (status == PART_OK)
    status = check_finite(*count, *vertices);
  free(bytes);
  return status == PART_OK ? status : part_fail_context(status, "STL file %s", path);
}
