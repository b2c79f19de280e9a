/* Limits of the process: memory, the three standard files, files that are none.
 *
 * The linker turns the calls of the Fortran library that report a failed allocation into those
 * below. They have no arguments of the program, so the name of the part that is at work is kept
 * here. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/syscall.h>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

enum { system_failed = 3 };
static const size_t blas_bytes = 144u << 20; /* OpenBLAS takes 128 MB for a thread; and its stack */
static const size_t reserve_bytes = 16u << 20;
static const size_t least_bytes = 8u << 20; /* for what has no message of its own, such as HDF5 */
static const long long spare_bytes = 256ll << 20; /* above what is free: memory that is never used */

void keyway_watch_memory(void); /* system/system_calls.c */

static void (*escape)(const char *); /* leaves a call of a user routine, if one runs */
static char part[256] = "the program";
static void *reserve; /* NULL: none is held */

static void end_at_once(int signal_number)
{
  (void)signal_number;
  _exit(system_failed);
}

/* Ends the program. What is registered with atexit, such as the mark in the summary of a run, comes
 * first; OpenBLAS, which comes last, crashes without memory, or waits for it for ever. */
static _Noreturn void end_program(void)
{
  static int is_ending;
  if (is_ending++) _exit(system_failed);
  signal(SIGALRM, end_at_once);
  signal(SIGSEGV, end_at_once);
  signal(SIGBUS, end_at_once);
  signal(SIGABRT, end_at_once);
  alarm(1);
  exit(system_failed);
}

/* Holds some addresses back while user routines run: one that takes all memory would else leave none
 * for writing the results and for the stack. They are never touched, and cost no memory. */
void keyway_hold_reserve(void)
{
  void *room;
  if (reserve) return;
  room = mmap(NULL, reserve_bytes, PROT_READ | PROT_WRITE,
              MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room != MAP_FAILED) reserve = room;
}

/* Gives the reserve free, when a user routine lacks memory or crashes. */
void keyway_free_reserve(void)
{
  void *room = reserve;
  reserve = NULL;
  if (room) munmap(room, reserve_bytes);
}

/* The function is called when memory is missing, before the program ends. */
void keyway_on_missing_memory(void (*function)(const char *)) { escape = function; }

/* Whether a UMAT is loaded: its crashes do not end the program. */
int keyway_has_user_routines(void) { return escape != NULL; }

static _Noreturn void end_without_memory(const char *what)
{
  static int is_reported;
  keyway_free_reserve();
  if (escape) escape(what);
  if (!is_reported++) fprintf(stderr, "keyway: not enough memory in part '%s': %s\n", part, what);
  end_program();
}

_Noreturn void __wrap__gfortran_os_error_at(const char *where, const char *format, ...)
{
  char what[256];
  va_list rest;
  (void)where;
  va_start(rest, format);
  vsnprintf(what, sizeof what, format, rest);
  va_end(rest);
  end_without_memory(what);
}

_Noreturn void __wrap__gfortran_os_error(const char *what) { end_without_memory(what); }

_Noreturn void __wrap__gfortran_runtime_error(const char *format, ...)
{
  char what[256];
  va_list rest;
  va_start(rest, format);
  vsnprintf(what, sizeof what, format, rest);
  va_end(rest);
  if (strstr(what, "memory") || strstr(what, "llocat")) end_without_memory(what);
  fprintf(stderr, "keyway: fault of the program in part '%s': %s\n", part, what);
  end_program();
}

/* Whether the next allocation may fail: libraries do not survive that everywhere. */
int keyway_lacks_memory(void)
{
  void *room = mmap(NULL, least_bytes, PROT_READ | PROT_WRITE,
                    MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room == MAP_FAILED) return 1;
  munmap(room, least_bytes);
  return 0;
}

/* The message on a crash or an end that missing memory has caused; signal handlers may call it. */
void keyway_tell_of_missing_memory(void)
{
  char text[400];
  int length = snprintf(text, sizeof text, "keyway: not enough memory in part '%s'\n", part);
  if (write(2, text, (size_t)length) != length) return;
}

/* The part of the program that is at work, for the message on missing memory. One that begins needs
 * some memory to spare. */
void keyway_note_part(const char *name, int is_beginning)
{
  snprintf(part, sizeof part, "%s", name);
  if (is_beginning && keyway_lacks_memory()) end_without_memory("less than 8 MB are left");
}

/* A file that a program has not given becomes one that reads as empty and takes nothing: results
 * would else be opened under its number. */
static void open_standard_files(void)
{
  static const char *const stand_in[3] = {"/dev/null", "/dev/full", "/dev/null"};
  for (int i = 0; i < 3; i++)
    if (fcntl(i, F_GETFD) == -1 && errno == EBADF && open(stand_in[i], O_RDWR) < 0) return;
}

/* A number from a file of the kernel, after a word; -1 where there is none. */
static long long number_in(const char *path, const char *word)
{
  char line[256];
  long long value = -1;
  FILE *file = fopen(path, "r");
  if (!file) return -1;
  while (value < 0 && fgets(line, sizeof line, file))
    if (strncmp(line, word, strlen(word)) == 0 && sscanf(line + strlen(word), "%lld", &value) != 1)
      value = -1;
  fclose(file);
  return value;
}

/* Peak memory of the process so far [kB], -1 if the system does not report it. It takes no memory. */
long keyway_peak_memory(void)
{
  static const char wanted[] = "VmHWM:";
  char text[4096];
  const char *found;
  ssize_t length;
  int file = open("/proc/self/status", O_RDONLY | O_CLOEXEC);
  if (file < 0) return -1;
  length = read(file, text, sizeof text - 1);
  close(file);
  text[length > 0 ? length : 0] = '\0';
  found = strstr(text, wanted);
  return found ? strtol(found + sizeof wanted - 1, NULL, 10) : -1;
}

/* Bytes that a control group leaves; -1 without a limit. */
static long long left_by_group(const char *limit, const char *used)
{
  long long most = number_in(limit, ""), now = number_in(used, "");
  return most < 0 || now < 0 || most < now ? -1 : most - now;
}

static long long smaller(long long a, long long b) { return a < 0 || (b >= 0 && b < a) ? b : a; }

/* Bytes that the machine, or a control group, leaves for all processes; -1: not known. */
static long long left_on_machine(void)
{
  long long free_kb = number_in("/proc/meminfo", "MemAvailable:");
  long long swap_kb = number_in("/proc/meminfo", "SwapFree:");
  long long most = free_kb < 0 ? -1 : 1024 * (free_kb + (swap_kb > 0 ? swap_kb : 0));
  most = smaller(most, left_by_group("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"));
  return smaller(most, left_by_group("/sys/fs/cgroup/memory/memory.limit_in_bytes",
                                     "/sys/fs/cgroup/memory/memory.usage_in_bytes"));
}

/* Bytes that a limit of the process leaves; -1 without a limit. */
static long long left_by_limit(int limit, const char *used)
{
  struct rlimit now;
  long long kb = number_in("/proc/self/status", used);
  if (kb < 0 || getrlimit(limit, &now) != 0 || now.rlim_cur == RLIM_INFINITY) return -1;
  return (long long)now.rlim_cur > 1024 * kb ? (long long)now.rlim_cur - 1024 * kb : 0;
}

/* Bytes that the process may still take where `sharers` processes share the machine; -1: not known. */
long long keyway_free_memory(int sharers)
{
  long long most = left_on_machine();
  if (most > 0) most /= sharers;
  most = smaller(most, left_by_limit(RLIMIT_DATA, "VmData:"));
  return smaller(most, left_by_limit(RLIMIT_AS, "VmSize:"));
}

/* Memory beyond what is there is refused when it is asked for. Without a limit the kernel promises
 * it and ends the process when it is used. A sanitizer reserves terabytes that it never uses. */
static void limit_memory(void)
{
  struct rlimit now;
  long long most = left_on_machine();
#ifdef __SANITIZE_ADDRESS__
  most = -1;
#endif
  if (most < 0 || getrlimit(RLIMIT_DATA, &now) != 0) return;
  most += spare_bytes;
  if (now.rlim_cur != RLIM_INFINITY && now.rlim_cur <= (rlim_t)most) return;
  now.rlim_cur = (rlim_t)most;
  setrlimit(RLIMIT_DATA, &now);
}

/* Vectors of a large model come and go in each increment. The library would give their pages back to
 * the system each time, and the system would clear them anew. Larger blocks, such as factors, go
 * back: SuperLU, a library that PETSc loads, turns that off before the program starts. */
static void keep_pages(void)
{
#ifdef __GLIBC__
  enum { largest_kept = 32 << 20, most_kept = 64 << 20, most_blocks = 65536 };
  mallopt(M_MMAP_MAX, most_blocks);
  mallopt(M_MMAP_THRESHOLD, largest_kept);
  mallopt(M_TRIM_THRESHOLD, most_kept);
#endif
}

/* The first call of the program. */
void keyway_prepare_process(void)
{
  open_standard_files();
  keep_pages();
}

static _Noreturn void end_without_blas(int signal_number)
{
  (void)signal_number;
  snprintf(part, sizeof part, "BLAS");
  end_without_memory("it takes 128 MB for each thread; fewer threads (-j) need less");
}

/* Sends SIGPROF after some seconds of processor time of the process; 0: none any more. A machine that
 * is busy, or a program that watches this one, takes longer for the same work. */
static void limit_processor_time(int seconds)
{
  struct itimerval limit = {{0, 0}, {seconds, 0}};
  setitimer(ITIMER_PROF, &limit, NULL);
}

/* Tries the memory that OpenBLAS takes for its threads: without it OpenBLAS waits for ever. It also
 * counts as missing when OpenBLAS has not got it in time, before keyway_end_trial. */
void keyway_try_memory(int threads)
{
  enum { most_seconds = 10 }; /* OpenBLAS takes some hundredths */
  size_t size = blas_bytes * (size_t)threads;
  void *room = mmap(NULL, size, PROT_READ | PROT_WRITE,
                    MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room == MAP_FAILED) end_without_blas(0);
  munmap(room, size);
  signal(SIGPROF, end_without_blas);
  limit_processor_time(most_seconds);
}

/* OpenBLAS has its memory. From now on the process is limited to what the machine has. */
void keyway_end_trial(void)
{
  keyway_watch_memory();
  limit_processor_time(0);
  signal(SIGPROF, SIG_IGN); /* one that is on its way */
  limit_memory();
}

#ifndef __SANITIZE_ADDRESS__
/* OpenBLAS asks for its memory again and again, for ever, when there is none. Its calls of mmap come
 * here, because symbols of the program precede those of the libraries. */
static void *map(void *place, size_t size, int protection, int flags, int file, off_t from)
{
  enum { most_failures = 50 };
  static int num_failures; /* in a row */
  void *room = (void *)syscall(SYS_mmap, place, size, protection, flags, file, from);
  if (room != MAP_FAILED || size < (100u << 20) || errno != ENOMEM)
    num_failures = 0;
  else if (++num_failures > most_failures)
    end_without_blas(0);
  return room;
}

void *mmap(void *place, size_t size, int protection, int flags, int file, off_t from)
{
  return map(place, size, protection, flags, file, from);
}

void *mmap64(void *place, size_t size, int protection, int flags, int file, off_t from)
{
  return map(place, size, protection, flags, file, from);
}
#endif

/* 0: there is no such file, 1: a file, 2: a folder, 3: a device or a pipe. */
int keyway_kind_of_file(const char *path)
{
  struct stat found;
  if (stat(path, &found) != 0) return 0;
  if (S_ISREG(found.st_mode)) return 1;
  return S_ISDIR(found.st_mode) ? 2 : 3;
}

/* Writes to the standard output without a buffer; 0: the output is closed or full. */
int keyway_write_output(const char *text, size_t length)
{
  while (length > 0) {
    ssize_t taken = write(1, text, length);
    if (taken < 0 && errno == EINTR) continue;
    if (taken <= 0) return 0;
    text += taken;
    length -= (size_t)taken;
  }
  return 1;
}
