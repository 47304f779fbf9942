/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shapes of clumps: a text file with a sphere a line, x y z diameter in m; # begins a comment.
 * Lines `volume V`, `centre x y z` and `inertia xx yy zz xy xz yz` (m3, m, m5: over density, about
 * the centre, in the axes of the file), all three or none, give the mass properties of the body
 * that the spheres stand for; without them they are those of the union of the spheres. */
#include <stdio.h>

#include "internal.h"
#include "rotation.h"

enum { GIVEN = 3, MOST_VALUES = 6 };
static const char *const words[GIVEN] = {"volume", "centre", "inertia"};
static const int lengths[GIVEN] = {1, 3, 6};

typedef struct shape_text {
  const char *path;
  size_t capacity;
  int given[GIVEN]; /* line of each, 0: none */
  double value[GIVEN][MOST_VALUES];
} shape_text;

void dem_clump_shape_free(dem_clump_shape *shape) {
  free(shape->sphere);
  shape->sphere = NULL;
}

/* A line that begins with a word. *is_word: it does. */
static int parse_word(shape_text *text, int line_number, char *line, int *is_word) {
  const char *bad = "";
  size_t length = 0;
  while (*line == ' ' || *line == '\t' || *line == '\r')
    line++;
  while ((line[length] >= 'a' && line[length] <= 'z') ||
         (line[length] >= 'A' && line[length] <= 'Z'))
    length++;
  *is_word = length > 0 && strncmp(line, "nan", 3) != 0 && strncmp(line, "inf", 3) != 0;
  if (!*is_word)
    return PART_OK;
  int w = 0;
  while (w < GIVEN && (strlen(words[w]) != length || strncmp(line, words[w], length) != 0))
    w++;
  if (w == GIVEN) {
    char word[32];
    snprintf(word, sizeof word, "%.*s", (int)(length < 31 ? length : 31), line);
    const char *near = part_nearest_name(word, GIVEN, words);
    return part_fail(PART_ERR_FORMAT,
                     "%s, line %d: '%s' is not known; known are volume, centre, inertia%s%s%s",
                     text->path, line_number, word, near != NULL ? "; did you mean '" : "",
                     near != NULL ? near : "", near != NULL ? "'?" : "");
  }
  if (text->given[w] != 0)
    return part_fail(PART_ERR_FORMAT, "%s, line %d: %s is given twice", text->path, line_number,
                     words[w]);
  const int n = dem_text_numbers(line + length, MOST_VALUES, text->value[w], &bad);
  if (n < 0)
    return part_fail(PART_ERR_FORMAT, "%s, line %d: '%.20s' is not a finite number", text->path,
                     line_number, bad);
  if (n != lengths[w])
    return part_fail(PART_ERR_FORMAT, "%s, line %d: %s has %d numbers; must be %d", text->path,
                     line_number, words[w], n, lengths[w]);
  text->given[w] = line_number;
  return PART_OK;
}

static int parse_sphere(shape_text *text, int line_number, char *line, dem_clump_shape *shape) {
  double value[4];
  const char *bad = "";
  const int n = dem_text_numbers(line, 4, value, &bad);
  if (n == 0)
    return PART_OK;
  if (n < 0)
    return part_fail(PART_ERR_FORMAT, "%s, line %d: '%.20s' is not a finite number", text->path,
                     line_number, bad);
  if (n != 4)
    return part_fail(PART_ERR_FORMAT, "%s, line %d: %d numbers; must be 4 (x y z diameter)",
                     text->path, line_number, n);
  if (!(value[3] > 0.0))
    return part_fail(PART_ERR_RANGE, "%s, line %d: diameter %g m is not allowed; must be positive",
                     text->path, line_number, value[3]);
  PART_TRY(dem_grow(4 * ((size_t)shape->spheres + 1), sizeof *shape->sphere, &text->capacity,
                    &shape->sphere));
  double *to = shape->sphere + 4 * (size_t)shape->spheres++;
  memcpy(to, value, sizeof value);
  to[3] *= 0.5;
  return PART_OK;
}

static int parse(shape_text *text, char *content, dem_clump_shape *shape) {
  int line_number = 0, given = 0, missing = -1;
  for (char *line = content, *next = content; next != NULL; line = next) {
    int is_word;
    next = strchr(line, '\n');
    if (next != NULL)
      *next++ = '\0';
    PART_TRY(parse_word(text, ++line_number, line, &is_word));
    if (!is_word)
      PART_TRY(parse_sphere(text, line_number, line, shape));
  }
  if (shape->spheres == 0)
    return part_fail(PART_ERR_RANGE, "%s: zero spheres", text->path);
  for (int w = 0; w < GIVEN; w++) {
    given += text->given[w] != 0;
    missing = text->given[w] == 0 ? w : missing;
  }
  if (given != 0 && given != GIVEN)
    return part_fail(PART_ERR_FORMAT,
                     "%s: %s is missing; volume, centre and inertia are given together or not at "
                     "all",
                     text->path, words[missing]);
  return PART_OK;
}

/* Number of the first sphere that does not hang together with sphere 0, -1: none. */
static int loose_sphere(const dem_clump_shape *shape, int *reached, int *queue) {
  int from = 0, to = 1;
  queue[0] = 0;
  reached[0] = 1;
  for (; from < to; from++)
    for (int k = 0; k < shape->spheres; k++) {
      const double *a = shape->sphere + 4 * queue[from], *b = shape->sphere + 4 * k;
      const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]}, reach = a[3] + b[3];
      if (!reached[k] && dem_dot(d, d) <= reach * reach * (1.0 + 2e-6)) {
        reached[k] = 1;
        queue[to++] = k;
      }
    }
  for (int k = 0; k < shape->spheres; k++)
    if (!reached[k])
      return k;
  return -1;
}

static int check_pieces(const char *path, const dem_clump_shape *shape) {
  int *work;
  PART_TRY(dem_allocate(2 * (size_t)shape->spheres, sizeof *work, &work));
  const int loose = loose_sphere(shape, work, work + shape->spheres);
  free(work);
  return loose < 0 ? PART_OK
                   : part_fail(PART_ERR_RANGE,
                               "%s: sphere %d does not hang together with sphere 1; a body in "
                               "pieces needs its volume, centre and inertia in the file",
                               path, loose + 1);
}

/* Volume, centre, inertia tensor about it of the union. */
static int union_properties(const char *path, dem_clump_shape *shape, double tensor[6]) {
  double m[10], middle[3];
  PART_TRY(check_pieces(path, shape));
  PART_TRY(dem_union_moments(shape->spheres, shape->sphere, m, middle));
  const double v = m[0];
  const double c[3] = {m[1] / v, m[2] / v, m[3] / v};
  const double xx = m[4] - v * c[0] * c[0], yy = m[5] - v * c[1] * c[1],
               zz = m[6] - v * c[2] * c[2];
  shape->volume = v;
  for (int k = 0; k < 3; k++)
    shape->centre[k] = middle[k] + c[k];
  const double made[6] = {yy + zz,
                          xx + zz,
                          xx + yy,
                          v * c[0] * c[1] - m[7],
                          v * c[0] * c[2] - m[8],
                          v * c[1] * c[2] - m[9]};
  memcpy(tensor, made, sizeof made);
  return PART_OK;
}

static void given_properties(const shape_text *text, dem_clump_shape *shape, double tensor[6]) {
  shape->volume = text->value[0][0];
  memcpy(shape->centre, text->value[1], sizeof shape->centre);
  memcpy(tensor, text->value[2], 6 * sizeof *tensor);
}

/* Order of principal axes: the third is the one whose inertia differs most from the others (R.3).
 */
static void choose_axes(const double value[3], int axis[3]) {
  int order[3] = {0, 1, 2};
  for (int a = 0; a < 2; a++)
    for (int b = 0; b < 2 - a; b++)
      if (value[order[b]] > value[order[b + 1]]) {
        const int swap = order[b];
        order[b] = order[b + 1];
        order[b + 1] = swap;
      }
  const double low = 1.0 / value[order[0]] - 1.0 / value[order[1]];
  const double high = 1.0 / value[order[1]] - 1.0 / value[order[2]];
  for (int k = 0; k < 3; k++)
    axis[k] = order[low < high ? k : (k + 1) % 3];
}

/* Principal inertia and axes from the tensor. */
static int set_axes(const char *path, dem_clump_shape *shape, const double tensor[6]) {
  double value[3], v[3][3], columns[3][3], sum = 0.0, most = 0.0;
  int axis[3];
  dem_eigen(tensor, value, v);
  for (int k = 0; k < 3; k++) {
    sum += value[k];
    most = fmax(most, value[k]);
  }
  if (!(shape->volume > 0.0) || !isfinite(shape->volume) || !isfinite(sum) ||
      !(value[0] > 0.0 && value[1] > 0.0 && value[2] > 0.0) || !(most <= 0.5 * sum * (1.0 + 1e-9)))
    return part_fail(PART_ERR_RANGE,
                     "%s: volume %g m3 and principal moments of inertia %g, %g, %g m5 (over "
                     "density) are not those of a body: all must be positive, and no moment above "
                     "the sum of the others",
                     path, shape->volume, value[0], value[1], value[2]);
  choose_axes(value, axis);
  for (int c = 0; c < 3; c++) {
    shape->inertia[c] = value[axis[c]];
    for (int r = 0; r < 3; r++)
      columns[r][c] = v[r][axis[c]];
  }
  /* Right-handed: the third is the cross product of the others. */
  for (int r = 0; r < 3; r++)
    columns[r][2] = columns[(r + 1) % 3][0] * columns[(r + 2) % 3][1] -
                    columns[(r + 2) % 3][0] * columns[(r + 1) % 3][1];
  dem_turn_of_matrix((const double(*)[3])columns, shape->axes);
  return PART_OK;
}

void dem_clump_turn(const double j[6], const double arm[3], double k[6]) {
  /* Columns of the matrix of arm x n. */
  const double column[3][3] = {
      {0.0, arm[2], -arm[1]}, {-arm[2], 0.0, arm[0]}, {arm[1], -arm[0], 0.0}};
  static const int row[6] = {0, 1, 2, 0, 0, 1}, other[6] = {0, 1, 2, 1, 2, 2};
  for (int e = 0; e < 6; e++) {
    const double *a = column[row[e]], *b = column[other[e]];
    k[e] = a[0] * (j[0] * b[0] + j[3] * b[1] + j[4] * b[2]) +
           a[1] * (j[3] * b[0] + j[1] * b[1] + j[5] * b[2]) +
           a[2] * (j[4] * b[0] + j[5] * b[1] + j[2] * b[2]);
  }
}

/* Spheres into principal axes about the centre of mass, and what follows from them. */
static void set_spheres(dem_clump_shape *shape) {
  double m[3][3], value[3], v[3][3], k_matrix[6];
  const double per_inertia[6] = {
      1.0 / shape->inertia[0], 1.0 / shape->inertia[1], 1.0 / shape->inertia[2], 0.0, 0.0, 0.0};
  dem_turn_matrix(shape->axes, m);
  shape->bound = shape->arm = shape->light = 0.0;
  for (int k = 0; k < shape->spheres; k++) {
    double *p = shape->sphere + 4 * (size_t)k, d[3];
    for (int c = 0; c < 3; c++)
      d[c] = p[c] - shape->centre[c];
    dem_to_body((const double(*)[3])m, d, p);
    const double arm = sqrt(dem_dot(p, p));
    shape->arm = fmax(shape->arm, arm);
    shape->bound = fmax(shape->bound, arm + p[3]);
    dem_clump_turn(per_inertia, p, k_matrix);
    dem_eigen(k_matrix, value, v);
    shape->light =
        fmax(shape->light, 1.0 / shape->volume + fmax(value[0], fmax(value[1], value[2])));
  }
}

static int make(shape_text *text, char *content, dem_clump_shape *shape) {
  double tensor[6];
  PART_TRY(parse(text, content, shape));
  if (text->given[0] != 0)
    given_properties(text, shape, tensor);
  else
    PART_TRY(union_properties(text->path, shape, tensor));
  PART_TRY(set_axes(text->path, shape, tensor));
  set_spheres(shape);
  return PART_OK;
}

int dem_clump_shape_read(const dem_t *dem, const char *path, dem_clump_shape *shape) {
  shape_text text = {.path = path};
  char *content = NULL;
  memset(shape, 0, sizeof *shape);
  int status = dem_text_share(dem, path, &content);
  if (status == PART_OK)
    status = part_agree(dem->comm, make(&text, content, shape));
  free(content);
  if (status != PART_OK)
    dem_clump_shape_free(shape);
  return status;
}

int dem_get_clump_shape(dem_t *dem, const char *path, dem_clump_shape_report *report) {
  dem_clump_shape shape;
  double m[3][3];
  PART_TRY(dem_clump_shape_read(dem, path, &shape));
  *report = (dem_clump_shape_report){
      .spheres = shape.spheres, .volume = shape.volume, .bound = shape.bound};
  memcpy(report->centre, shape.centre, sizeof report->centre);
  memcpy(report->principal, shape.inertia, sizeof report->principal);
  dem_turn_matrix(shape.axes, m);
  static const int row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
  for (int k = 0; k < 6; k++)
    for (int c = 0; c < 3; c++)
      report->inertia[k] += m[row[k]][c] * shape.inertia[c] * m[column[k]][c];
  dem_clump_shape_free(&shape);
  return PART_OK;
}
