/* Preloaded, it kills the process it is loaded into with SIGKILL before write number KILL_AT into a
 * file whose path ends with KILL_NAME. A child process goes on. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static pid_t owner;
static long writes;

__attribute__((constructor)) static void note_owner(void) { owner = getpid(); }

static int counts(int file) {
  const char *name = getenv("KILL_NAME");
  char link[64], path[4096];
  ssize_t length;
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  length = readlink(link, path, sizeof path - 1);
  if (!name || length < (ssize_t)strlen(name)) return 0;
  path[length] = '\0';
  return strcmp(path + length - strlen(name), name) == 0;
}

static void count(int file) {
  const char *at = getenv("KILL_AT");
  if (at && counts(file) && ++writes == atol(at)) kill(owner, SIGKILL);
}

ssize_t pwrite(int file, const void *bytes, size_t size, off_t place) {
  ssize_t (*next)(int, const void *, size_t, off_t) = dlsym(RTLD_NEXT, "pwrite");
  count(file);
  return next(file, bytes, size, place);
}

ssize_t pwrite64(int file, const void *bytes, size_t size, off64_t place) {
  ssize_t (*next)(int, const void *, size_t, off64_t) = dlsym(RTLD_NEXT, "pwrite64");
  count(file);
  return next(file, bytes, size, place);
}
