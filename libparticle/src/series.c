/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The `.vtkhdf.series` index that ParaView reads: JSON with one file and time per entry. */
#define _XOPEN_SOURCE 700
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "file.h"
#include "memory.h"
#include "particle/status.h"

/* name: JSON string content, escapes as they stand; not terminated. */
typedef struct series_entry {
  const char *name;
  size_t length;
  double time;
} series_entry;

/* The whole file as a string; NULL text when there is none. */
static int read_text(const char *path, char **text) {
  size_t used = 0, room = 0, got;
  *text = NULL;
  FILE *in = fopen(path, "rb");
  if (in == NULL)
    return errno == ENOENT ? PART_OK
                           : part_fail(PART_ERR_IO, "%s: cannot open: %s", path, strerror(errno));
  int status = part_grow(4096, 1, &room, text);
  while (status == PART_OK && (got = fread(*text + used, 1, room - used - 1, in)) > 0) {
    used += got;
    status = part_grow(2 * used + 4096, 1, &room, text);
  }
  if (status == PART_OK && ferror(in))
    status = part_fail(PART_ERR_IO, "%s: cannot read", path);
  if (status == PART_OK)
    (*text)[used] = '\0';
  fclose(in);
  return status;
}

/* After the key in quotes and its colon, inside from .. to; NULL: not there. */
static const char *value_of(const char *from, const char *to, const char *key) {
  for (const char *at = strstr(from, key); at != NULL && at < to; at = strstr(at + 1, key)) {
    const char *value = at + strlen(key);
    value += strspn(value, " \t\r\n");
    if (*value == ':')
      return value + 1 + strspn(value + 1, " \t\r\n");
  }
  return NULL;
}

/* The end of a JSON string that begins after its quote. */
static const char *string_end(const char *at) {
  while (*at != '\0' && *at != '"')
    at += at[0] == '\\' && at[1] != '\0' ? 2 : 1;
  return at;
}

/* The end of the object that begins at {: strings may hold braces. */
static const char *object_end(const char *at) {
  while (*at != '\0' && *at != '}')
    at = *at == '"' ? string_end(at + 1) + (*string_end(at + 1) == '"') : at + 1;
  return at;
}

static int parse(const char *path, const char *text, series_entry **entries, size_t *count) {
  size_t room = 0;
  const char *at = value_of(text, text + strlen(text), "\"files\"");
  *count = 0;
  if (at == NULL || *at != '[')
    return part_fail(PART_ERR_FORMAT, "%s: is not a series index (no list \"files\")", path);
  for (at = strchr(at, '{'); at != NULL; at = strchr(at, '{')) {
    const char *end = object_end(at), *name = value_of(at, end, "\"name\""),
               *time = value_of(at, end, "\"time\"");
    char *after = NULL;
    if (*end != '}' || name == NULL || *name != '"' || time == NULL)
      return part_fail(PART_ERR_FORMAT, "%s: an entry has no name or time", path);
    PART_TRY(part_grow(*count + 1, sizeof **entries, &room, entries));
    series_entry *e = &(*entries)[(*count)++];
    e->name = name + 1;
    e->length = (size_t)(string_end(name + 1) - e->name);
    e->time = strtod(time, &after);
    if (after == time)
      return part_fail(PART_ERR_FORMAT, "%s: a time is not a number", path);
    at = end;
  }
  return PART_OK;
}

/* Path of a file as seen from the folder of the index: the tail when it is in or below that
 * folder, else absolute. */
static int name_in_series(const char *series, const char *path, char **name) {
  const char *slash = strrchr(series, '/');
  const size_t folder = slash != NULL ? (size_t)(slash - series) + 1 : 0;
  char *whole = NULL;
  if (strncmp(series, path, folder) == 0 && (folder > 0 || path[0] != '/')) {
    path += folder;
  } else {
    whole = realpath(path, NULL);
    if (whole == NULL)
      return part_fail(PART_ERR_IO, "%s: has no absolute path: %s", path, strerror(errno));
    path = whole;
  }
  const int status = part_allocate(2 * strlen(path) + 1, 1, name);
  for (char *to = *name; status == PART_OK && *path != '\0';) {
    if (*path == '"' || *path == '\\')
      *to++ = '\\';
    *to++ = *path++;
  }
  free(whole);
  return status;
}

/* Whether the file of an entry is there: purged times, and what was removed by hand, is not. Names
 * with other escapes than name_in_series() writes count as there. */
static int entry_exists(const char *series, const series_entry *e, int *exists) {
  const char *slash = strrchr(series, '/');
  const size_t folder = slash != NULL ? (size_t)(slash - series) + 1 : 0;
  char *path;
  PART_TRY(part_allocate(folder + e->length + 1, 1, &path));
  char *to = path;
  if (e->length > 0 && e->name[0] != '/')
    to = (char *)memcpy(path, series, folder) + folder;
  int plain = 1;
  for (size_t k = 0; k < e->length; k++) {
    if (e->name[k] == '\\' && k + 1 < e->length)
      plain = plain && strchr("\"\\/", e->name[++k]) != NULL;
    *to++ = e->name[k];
  }
  *to = '\0';
  *exists = !plain || access(path, F_OK) == 0 || errno != ENOENT;
  free(path);
  return PART_OK;
}

/* Drop the entries at or after time, those of the same name, and those without a file. */
static int keep_entries(const char *series, const char *name, double time, series_entry *entries,
                        size_t *count) {
  size_t kept = 0;
  for (size_t k = 0; k < *count; k++) {
    const series_entry *e = &entries[k];
    int exists;
    if (!(e->time < time) || (e->length == strlen(name) && !memcmp(e->name, name, e->length)))
      continue;
    PART_TRY(entry_exists(series, e, &exists));
    if (exists)
      entries[kept++] = *e;
  }
  *count = kept;
  return PART_OK;
}

static int write_series(const char *path, const series_entry *entries, size_t count,
                        const char *name, double time) {
  const size_t size = strlen(path) + 6;
  char *temporary;
  PART_TRY(part_allocate(size, 1, &temporary));
  snprintf(temporary, size, "%s.part", path);
  FILE *out = fopen(temporary, "wb");
  int failed = out == NULL;
  if (!failed) {
    fprintf(out, "{\n  \"file-series-version\" : \"1.0\",\n  \"files\" : [\n");
    for (size_t k = 0; k < count; k++)
      fprintf(out, "    { \"name\" : \"%.*s\", \"time\" : %.17g },\n", (int)entries[k].length,
              entries[k].name, entries[k].time);
    fprintf(out, "    { \"name\" : \"%s\", \"time\" : %.17g }\n  ]\n}\n", name, time);
    failed = ferror(out) != 0;
    failed = fclose(out) != 0 || failed;
  }
  failed = failed || rename(temporary, path) != 0;
  const int status =
      failed ? part_fail(PART_ERR_IO, "%s: cannot write: %s", path, strerror(errno)) : PART_OK;
  if (failed)
    remove(temporary);
  free(temporary);
  return status;
}

int part_series_enter(const char *series, const char *path, double time) {
  char *text = NULL, *name = NULL;
  series_entry *entries = NULL;
  size_t count = 0;
  int status = read_text(series, &text);
  if (status == PART_OK && text != NULL)
    status = parse(series, text, &entries, &count);
  if (status == PART_OK)
    status = name_in_series(series, path, &name);
  if (status == PART_OK)
    status = keep_entries(series, name, time, entries, &count);
  if (status == PART_OK)
    status = write_series(series, entries, count, name, time);
  free(text);
  free(entries);
  free(name);
  return status;
}
