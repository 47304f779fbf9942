/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Insertion from a text file: one particle a line, x y z diameter [vx vy vz] in SI units, clumps
 * with [qw qx qy qz] besides; # begins a comment. Rank 0 reads, all ranks parse. */
#include <ctype.h>
#include <errno.h>
#include <stdio.h>

#include "internal.h"

static int read_all(const char *path, char **text, long long *size) {
  FILE *file = fopen(path, "rb");
  if (file == NULL)
    return part_fail(PART_ERR_IO, "%s: cannot be opened: %s", path, strerror(errno));
  size_t capacity = 0, used = 0, got = 0;
  int status = PART_OK;
  do {
    status = dem_grow(used + 65537, 1, &capacity, text);
    if (status != PART_OK)
      break;
    got = fread(*text + used, 1, 65536, file);
    used += got;
  } while (got > 0);
  if (status == PART_OK && ferror(file))
    status = part_fail(PART_ERR_IO, "%s: cannot be read: %s", path, strerror(errno));
  fclose(file);
  *size = (long long)used;
  return status;
}

int dem_text_share(const dem_t *dem, const char *path, char **text) {
  long long size = 0;
  int status = dem->rank == 0 ? read_all(path, text, &size) : PART_OK;
  PART_TRY(part_agree(dem->comm, status));
  MPI_Bcast(&size, 1, MPI_LONG_LONG, 0, dem->comm);
  if (dem->rank != 0)
    status = dem_allocate((size_t)size + 1, 1, text);
  PART_TRY(part_agree(dem->comm, status));
  /* In pieces, because MPI counts are int. */
  for (long long at = 0; at < size; at += 1 << 30) {
    const long long left = size - at;
    MPI_Bcast(*text + at, left < (1 << 30) ? (int)left : 1 << 30, MPI_CHAR, 0, dem->comm);
  }
  (*text)[size] = '\0';
  return PART_OK;
}

int dem_text_numbers(char *line, int most, double *value, const char **bad) {
  int n = 0;
  char *comment = strchr(line, '#');
  if (comment != NULL)
    *comment = '\0';
  for (;;) {
    char *end;
    while (isspace((unsigned char)*line))
      line++;
    if (*line == '\0')
      return n;
    *bad = line;
    const double x = strtod(line, &end);
    if (end == line || (*end != '\0' && !isspace((unsigned char)*end)) || !isfinite(x))
      return -1;
    if (n < most)
      value[n] = x;
    n++;
    line = end;
  }
}

/* x y z diameter [vx vy vz], and of a clump [qw qx qy qz]; its diameter may be 0. */
static int parse_line(const char *path, int line_number, char *line, const dem_insert *insert,
                      dem_seed *seed, double turn[4], int *is_particle) {
  double value[11];
  const char *bad = "";
  const int n = dem_text_numbers(line, 11, value, &bad), clump = insert->kind == DEM_CLUMP;
  *is_particle = n > 0;
  if (n == 0)
    return PART_OK;
  if (n < 0)
    return part_fail(PART_ERR_FORMAT, "%s, line %d: '%.20s' is not a finite number", path,
                     line_number, bad);
  if (n != 4 && n != 7 && !(clump && n == 11))
    return part_fail(PART_ERR_FORMAT, "%s, line %d: %d numbers; must be 4%s (x y z diameter %s)",
                     path, line_number, n, clump ? ", 7 or 11" : " or 7",
                     clump ? "[vx vy vz [qw qx qy qz]]" : "[vx vy vz]");
  if (!(value[3] > 0.0) && !(clump && value[3] == 0.0))
    return part_fail(PART_ERR_RANGE, "%s, line %d: diameter %g m is not allowed; must be positive",
                     path, line_number, value[3]);
  memcpy(seed->x, value, sizeof seed->x);
  seed->r = 0.5 * value[3];
  memcpy(seed->v, n >= 7 ? &value[4] : insert->velocity, sizeof seed->v);
  if (n == 11) {
    const double *q = value + 7, size = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    if (!(size > 0.0))
      return part_fail(PART_ERR_RANGE, "%s, line %d: the quaternion must not be zero", path,
                       line_number);
    memcpy(turn, q, 4 * sizeof *turn);
  }
  if (insert->kind == DEM_FIXED && (seed->v[0] != 0.0 || seed->v[1] != 0.0 || seed->v[2] != 0.0))
    return part_fail(PART_ERR_RANGE, "%s, line %d: the velocity of a fixed particle must be zero",
                     path, line_number);
  return PART_OK;
}

static int parse(const char *path, char *text, const dem_insert *insert, dem_seed **seed,
                 double **turn, int64_t *count) {
  size_t capacity = 0, turns = 0;
  double none[4] = {0.0, 0.0, 0.0, 0.0};
  int line_number = 0;
  *count = 0;
  for (char *line = text, *next = text; next != NULL; line = next) {
    int is_particle;
    next = strchr(line, '\n');
    if (next != NULL)
      *next++ = '\0';
    PART_TRY(dem_grow((size_t)*count + 1, sizeof **seed, &capacity, seed));
    if (insert->kind == DEM_CLUMP)
      PART_TRY(dem_grow(4 * ((size_t)*count + 1), sizeof **turn, &turns, turn));
    PART_TRY(parse_line(path, ++line_number, line, insert, &(*seed)[*count],
                        *turn != NULL ? *turn + 4 * *count : none, &is_particle));
    *count += is_particle;
  }
  if (*count == 0)
    return part_fail(PART_ERR_RANGE, "%s: zero particles", path);
  return PART_OK;
}

int dem_insert_file(const dem_t *dem, const dem_insert *insert, dem_seed **seed, double **turn,
                    int64_t *count) {
  char *text = NULL;
  if (insert->file[0] == '\0')
    return part_fail(PART_ERR_RANGE, "%s: entry file must be given with method file",
                     dem_insert_table.name);
  int status = dem_text_share(dem, insert->file, &text);
  if (status == PART_OK)
    status = parse(insert->file, text, insert, seed, turn, count);
  free(text);
  return status;
}
