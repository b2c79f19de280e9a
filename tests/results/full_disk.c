/* A disk that is full, for one process: preloaded, it lets files in a folder grow by so many bytes in
 * all; then each write that would make a file longer fails with ENOSPC, and new files cannot be made.
 * What lies within a file can be written over, as on a real disk.
 *
 * FULL_DISK_FOLDER: the folder; FULL_DISK_BYTES: the bytes; FULL_DISK_NAME (or none): the disk is full
 * as soon as a file whose path ends so has grown by FULL_DISK_BYTES. FULL_DISK_ERRNO: another error
 * than ENOSPC; then all writes fail, also those within a file. FULL_DISK_FILES=1: files that have no
 * bytes yet can still be made. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

static long long used;

static const char *setting(const char *name, const char *other) {
  const char *value = getenv(name);
  return value && *value ? value : other;
}

static int failure(void) { return atoi(setting("FULL_DISK_ERRNO", "28")); }
/* Whether a full disk still takes what lies within a file; an input/output error takes nothing. */
static int takes_old_room(void) { return failure() == ENOSPC || failure() == EDQUOT; }

static int is_full(void) { return used >= atoll(setting("FULL_DISK_BYTES", "0")); }

static int is_in_folder(const char *path) {
  const char *folder = setting("FULL_DISK_FOLDER", "/nowhere");
  return strncmp(path, folder, strlen(folder)) == 0;
}

static int counts(const char *path) {
  const char *name = setting("FULL_DISK_NAME", "");
  size_t length = strlen(path), end = strlen(name);
  return length >= end && strcmp(path + length - end, name) == 0;
}

/* How many of `size` bytes at `place` the disk takes; -1: none. */
static ssize_t allowed(int file, size_t size, off_t place) {
  char link[64], path[4096];
  struct stat found;
  ssize_t length;
  long long growth, left;
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  length = readlink(link, path, sizeof path - 1);
  if (length < 0) return (ssize_t)size;
  path[length] = '\0';
  if (!is_in_folder(path) || fstat(file, &found) != 0 || !S_ISREG(found.st_mode))
    return (ssize_t)size;
  if (fcntl(file, F_GETFL) & O_APPEND) place = found.st_size;
  growth = (long long)place + (long long)size - (long long)found.st_size;
  if (growth < 0) growth = 0;
  if (is_full()) {
    if (takes_old_room() && growth < (long long)size) return (ssize_t)((long long)size - growth);
    errno = failure();
    return -1;
  }
  if (!counts(path)) return (ssize_t)size;
  left = atoll(setting("FULL_DISK_BYTES", "0")) - used;
  used += growth;
  if (growth <= left) return (ssize_t)size;
  size -= (size_t)(growth - left); /* the last bytes that fit */
  if (size > 0) return (ssize_t)size;
  errno = failure();
  return -1;
}

ssize_t write(int file, const void *bytes, size_t size) {
  off_t place = lseek(file, 0, SEEK_CUR);
  int before = errno;
  ssize_t most = place < 0 ? (ssize_t)size : allowed(file, size, place);
  if (most < 0) return -1;
  errno = before;
  return syscall(SYS_write, file, bytes, (size_t)most);
}

ssize_t pwrite(int file, const void *bytes, size_t size, off_t place) {
  ssize_t most = allowed(file, size, place);
  return most < 0 ? -1 : syscall(SYS_pwrite64, file, bytes, (size_t)most, place);
}

ssize_t pwrite64(int file, const void *bytes, size_t size, off_t place) {
  return pwrite(file, bytes, size, place);
}

static int is_refused(const char *path) {
  struct stat found;
  if (atoi(setting("FULL_DISK_FILES", "0")) || !is_full() || !is_in_folder(path)) return 0;
  if (stat(path, &found) == 0) return 0;
  errno = failure();
  return 1;
}

static int open_file(const char *path, int flags, int mode) {
  if ((flags & O_CREAT) && is_refused(path)) return -1;
  return (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
}

int open(const char *path, int flags, ...) {
  va_list rest;
  int mode;
  va_start(rest, flags);
  mode = va_arg(rest, int);
  va_end(rest);
  return open_file(path, flags, mode);
}

int open64(const char *path, int flags, ...) {
  va_list rest;
  int mode;
  va_start(rest, flags);
  mode = va_arg(rest, int);
  va_end(rest);
  return open_file(path, flags | O_LARGEFILE, mode);
}

int creat(const char *path, mode_t mode) {
  return open_file(path, O_CREAT | O_WRONLY | O_TRUNC, (int)mode);
}

int mkdir(const char *path, mode_t mode) {
  if (is_refused(path)) return -1;
  return (int)syscall(SYS_mkdir, path, mode);
}
