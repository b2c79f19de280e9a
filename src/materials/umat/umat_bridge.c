/* UMATs of users: loads their library, guards their calls and provides services of the process.
 * A UMAT that stops (XIT, STDB_ABQERR with -3, STOP) jumps back to the guarded call, which keeps
 * the message. The type in umat_interface holds the arguments in Fortran. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fenv.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void keyway_umat_catch_crashes(void); /* umat_crash.c */
void keyway_umat_use_own_stack(void);

struct arguments {
  double stress[6], ddsdde[36], sse, spd, scd, rpl, ddsddt[6], drplde[6], drpldt;
  double stran[6], dstran[6], time[2], dtime, temp, dtemp, predef[1], dpred[1];
  double coords[3], drot[9], pnewdt, celent, dfgrd0[9], dfgrd1[9];
  double *statev, *props;
  int ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, kstep[4], kinc;
  char cmname[80];
};

typedef void umat_routine(double *stress, double *statev, double *ddsdde, double *sse, double *spd,
                          double *scd, double *rpl, double *ddsddt, double *drplde, double *drpldt,
                          double *stran, double *dstran, double *time, double *dtime, double *temp,
                          double *dtemp, double *predef, double *dpred, char *cmname, int *ndi,
                          int *nshr, int *ntens, int *nstatv, double *props, int *nprops,
                          double *coords, double *drot, double *pnewdt, double *celent,
                          double *dfgrd0, double *dfgrd1, int *noel, int *npt, int *layer,
                          int *kspt, int *kstep, int *kinc, size_t length_of_cmname);
typedef void sdvini_routine(double *statev, double *coords, int *nstatv, int *ncrds, int *noel,
                            int *npt, int *layer, int *kspt);
typedef void uexternaldb_routine(int *lop, int *lrestart, double *time, double *dtime, int *kstep,
                                 int *kinc);

enum { last_mutex = 100 };
static pthread_mutex_t mutexes[last_mutex + 1] = {
  [0 ... last_mutex] = PTHREAD_MUTEX_INITIALIZER};

/* Return point of a user routine that stops, one for each thread. */
static _Thread_local struct {
  jmp_buf place;
  int is_set;
  char message[512];
  unsigned char holds[last_mutex + 1];
} guard;

/* Set when a routine has crashed: it may have damaged memory and is not called again. */
static char crash_message[512];

static void let_go_of_mutexes(void)
{
  for (int i = 0; i <= last_mutex; i++) {
    if (!guard.holds[i]) continue;
    pthread_mutex_unlock(&mutexes[i]);
    guard.holds[i] = 0;
  }
}

/* Leaves the guarded call of this thread after a crash; returns where there is none. */
void keyway_umat_escape(const char *what)
{
  if (!guard.is_set) return;
  snprintf(guard.message, sizeof guard.message, "the routine has crashed: %s", what);
  memcpy(crash_message, guard.message, sizeof crash_message);
  longjmp(guard.place, 1);
}

/* Ends the guarded call; without one (in a thread made by the UMAT) the process. */
static _Noreturn void give_up(void)
{
  if (guard.is_set) longjmp(guard.place, 1);
  fprintf(stderr, "keyway: the UMAT stopped outside of a call by Keyway: %s\n", guard.message);
  exit(1);
}

_Noreturn void keyway_umat_stop(const char *message, size_t length)
{
  snprintf(guard.message, sizeof guard.message, "%.*s", (int)length, message);
  give_up();
}

static _Noreturn void stop_with_message(const char *format, ...)
{
  va_list rest;
  va_start(rest, format);
  vsnprintf(guard.message, sizeof guard.message, format, rest);
  va_end(rest);
  give_up();
}

/* Reason of the last stop in this thread; at most `size` bytes with the null. */
void keyway_umat_message(char *message, size_t size) { snprintf(message, size, "%s", guard.message); }

/* Runs a call; the function returns 1 if the routine stops, or has crashed before. */
#define GUARDED(call)                                                     \
  do {                                                                    \
    if (crash_message[0]) {                                               \
      memcpy(guard.message, crash_message, sizeof guard.message);         \
      return 1;                                                           \
    }                                                                     \
    keyway_umat_use_own_stack();                                          \
    if (setjmp(guard.place)) {                                            \
      guard.is_set = 0;                                                   \
      let_go_of_mutexes();                                                \
      return 1;                                                           \
    }                                                                     \
    guard.is_set = 1;                                                     \
    call;                                                                 \
    guard.is_set = 0;                                                     \
  } while (0)

/* The arrays of a call, each between guard words. */
enum { guard_words = 32 };
static const uint64_t guard_word = 0xe613a5c3b7d29f41u;
#define ARRAYS(X)                                                                              \
  X(stress) X(ddsdde) X(ddsddt) X(drplde) X(stran) X(dstran) X(time) X(predef) X(dpred)        \
  X(coords) X(drot) X(dfgrd0) X(dfgrd1) X(kstep) X(cmname)
#define ROOM(name) union { char bytes[sizeof((struct arguments *)0)->name]; double align; } name; \
  uint64_t after_##name[guard_words];
static _Thread_local struct {
  int has_guards;
  uint64_t before_all[guard_words];
  ARRAYS(ROOM)
} room;

static void set_guards(uint64_t *words)
{
  for (int i = 0; i < guard_words; i++) words[i] = guard_word;
}

/* 0, or the number of the first word that was written, from 1. */
static int written_word(const uint64_t *words)
{
  uint64_t difference = 0;
  for (int i = 0; i < guard_words; i++) difference |= words[i] ^ guard_word;
  if (difference == 0) return 0;
  for (int i = 0; i < guard_words; i++)
    if (words[i] != guard_word) return i + 1;
  return 0;
}

#define SET(name) set_guards(room.after_##name);
#define COPY_IN(name) memcpy(room.name.bytes, a->name, sizeof a->name);
#define COPY_OUT(name) memcpy(a->name, room.name.bytes, sizeof a->name);
#define CHECK(name)                                                                         \
  if (!culprit && (where = written_word(room.after_##name))) culprit = #name;

/* 1 with a message if the routine wrote outside of its arrays. */
static int has_written_outside(void)
{
  const char *culprit = NULL;
  char name[16];
  int where = 0;
  size_t i;
  if (written_word(room.before_all)) culprit = "stress";
  ARRAYS(CHECK)
  if (!culprit) return 0;
  room.has_guards = 0;
  for (i = 0; i + 1 < sizeof name && culprit[i]; i++) name[i] = (char)(culprit[i] & ~32);
  name[i] = '\0';
  for (i = 0; name[i]; i++)
    if (culprit[i] >= '0' && culprit[i] <= '9') name[i] = culprit[i];
  snprintf(guard.message, sizeof guard.message, "the routine writes outside of its array %s%s", name,
           where > 0 ? ", behind the end" : ", before the beginning");
  return 1;
}

int keyway_umat_call(umat_routine *umat, struct arguments *a)
{
  if (!room.has_guards) {
    set_guards(room.before_all);
    ARRAYS(SET)
    room.has_guards = 1;
  }
  ARRAYS(COPY_IN)
  GUARDED(umat((double *)room.stress.bytes, a->statev, (double *)room.ddsdde.bytes, &a->sse, &a->spd,
               &a->scd, &a->rpl, (double *)room.ddsddt.bytes, (double *)room.drplde.bytes, &a->drpldt,
               (double *)room.stran.bytes, (double *)room.dstran.bytes, (double *)room.time.bytes,
               &a->dtime, &a->temp, &a->dtemp, (double *)room.predef.bytes,
               (double *)room.dpred.bytes, room.cmname.bytes, &a->ndi, &a->nshr, &a->ntens,
               &a->nstatv, a->props, &a->nprops, (double *)room.coords.bytes,
               (double *)room.drot.bytes, &a->pnewdt, &a->celent, (double *)room.dfgrd0.bytes,
               (double *)room.dfgrd1.bytes, &a->noel, &a->npt, &a->layer, &a->kspt,
               (int *)room.kstep.bytes, &a->kinc, sizeof a->cmname));
  ARRAYS(COPY_OUT)
  return has_written_outside();
}

int keyway_umat_start(sdvini_routine *sdvini, struct arguments *a)
{
  int dimensions = 3;
  GUARDED(sdvini(a->statev, a->coords, &a->nstatv, &dimensions, &a->noel, &a->npt, &a->layer,
                 &a->kspt));
  return 0;
}

int keyway_umat_external(uexternaldb_routine *uexternaldb, int lop, int restart, double *time,
                         double dtime, int step, int increment)
{
  GUARDED(uexternaldb(&lop, &restart, time, &dtime, &step, &increment));
  return 0;
}

/* A UMAT may divide by zero; the traps of the program are disabled during its calls. */
static _Thread_local fenv_t traps;
void keyway_umat_disable_traps(void) { feholdexcept(&traps); }
void keyway_umat_restore_traps(void) { fesetenv(&traps); }

/* The address sanitizer refuses libraries whose symbols precede those of the program. */
#ifdef __SANITIZE_ADDRESS__
static const int precedence = 0;
#else
static const int precedence = RTLD_DEEPBIND;
#endif

/* Loads a library; its symbols precede those of the program. NULL and a message on failure. */
void *keyway_umat_open(const char *path, char *message, size_t size)
{
  void *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL | precedence);
  keyway_umat_catch_crashes();
  snprintf(message, size, "%s", handle ? "" : dlerror());
  return handle;
}

void *keyway_umat_find(void *handle, const char *name) { return dlsym(handle, name); }

/* The job, for GETJOBNAME and GETOUTDIR; number of warnings and errors of the UMAT. */
static char job_name[257], job_folder[4097];
static int num_warnings, num_errors;

void keyway_umat_set_job(const char *name, const char *folder)
{
  char *full = realpath(folder, NULL);
  snprintf(job_name, sizeof job_name, "%s", name);
  snprintf(job_folder, sizeof job_folder, "%s", full ? full : folder);
  free(full);
}

/* Copies a text of C into one of Fortran, padded with blanks. */
static void fill(char *text, size_t size, const char *from, int *length)
{
  size_t used = strnlen(from, size);
  memcpy(text, from, used);
  memset(text + used, ' ', size - used);
  *length = (int)used;
}

void getjobname_(char *name, int *length, size_t size) { fill(name, size, job_name, length); }
void getoutdir_(char *folder, int *length, size_t size) { fill(folder, size, job_folder, length); }

void keyway_umat_count(int is_error)
{
  __atomic_add_fetch(is_error ? &num_errors : &num_warnings, 1, __ATOMIC_RELAXED);
}

void keyway_umat_counts(int *warnings, int *errors)
{
  *warnings = num_warnings;
  *errors = num_errors;
}

static pthread_mutex_t *mutex_of(int number, const char *routine)
{
  if (number < 1 || number > last_mutex)
    stop_with_message("%s was called with %d; mutexes are numbered 1 to %d", routine, number,
                   last_mutex);
  return &mutexes[number];
}

/* The mutexes exist from the start; MUTEXINIT only checks the number. */
void mutexinit_(const int *number) { mutex_of(*number, "MUTEXINIT"); }

void mutexlock_(const int *number)
{
  pthread_mutex_lock(mutex_of(*number, "MUTEXLOCK"));
  guard.holds[*number] = 1;
}

void mutexunlock_(const int *number)
{
  pthread_mutex_t *mutex = mutex_of(*number, "MUTEXUNLOCK");
  if (!guard.holds[*number]) return;
  guard.holds[*number] = 0;
  pthread_mutex_unlock(mutex);
}

/* Only a loaded library calls these, so the linker must keep them. */
void rotsig_(void), sinv_(void), sprinc_(void), sprind_(void);
void (*const keyway_umat_kept[])(void) = {rotsig_, sinv_, sprinc_, sprind_};

void keyway_umat_warn(const char *text, size_t length);
static void warn(const char *text) { keyway_umat_warn(text, strlen(text)); }

/* Values of other points and names of parts: not available, status 1. */
void getvrm_(const char *var, double *array, int *jarray, char *flgray, int *jrcd)
{
  (void)var, (void)array, (void)jarray, (void)flgray;
  *jrcd = 1;
  warn("GETVRM is not provided");
}

void getpartinfo_(const int *intnum, const int *jtyp, char *cpname, int *locnum, int *jrcd)
{
  (void)intnum, (void)jtyp, (void)cpname, (void)locnum;
  *jrcd = 1;
  warn("GETPARTINFO is not provided");
}

/* Tables of properties are not provided; without the routines a library that names them would not
 * load. */
#define MISSING(routine, name) \
  _Noreturn void routine(void) { stop_with_message("%s is not provided", name); }
MISSING(getpropertytable_, "GETPROPERTYTABLE")
MISSING(getparametertable_, "GETPARAMETERTABLE")
MISSING(getparametertablerow_, "GETPARAMETERTABLEROW")
MISSING(queryparametertable_, "QUERYPARAMETERTABLE")
MISSING(gettablecollection_, "GETTABLECOLLECTION")
MISSING(settablecollection_, "SETTABLECOLLECTION")

/* STOP, ERROR STOP, EXIT and failed run-time checks of a library that Keyway has linked: the linker
 * turned their names into these. */
_Noreturn void __wrap__gfortran_stop_string(const char *text, size_t length, _Bool quiet)
{
  (void)quiet;
  stop_with_message("STOP %.*s", (int)length, text ? text : "");
}

_Noreturn void __wrap__gfortran_error_stop_string(const char *text, size_t length, _Bool quiet)
{
  (void)quiet;
  stop_with_message("ERROR STOP %.*s", (int)length, text ? text : "");
}

_Noreturn void __wrap__gfortran_stop_numeric(int code, _Bool quiet)
{
  (void)quiet;
  stop_with_message("STOP %d", code);
}

_Noreturn void __wrap__gfortran_error_stop_numeric(int code, _Bool quiet)
{
  (void)quiet;
  stop_with_message("ERROR STOP %d", code);
}

_Noreturn void __wrap__gfortran_exit_i4(const int *code)
{
  stop_with_message("CALL EXIT(%d)", code ? *code : 0);
}

_Noreturn void __wrap__gfortran_runtime_error_at(const char *place, const char *format, ...)
{
  char text[400];
  va_list rest;
  va_start(rest, format);
  vsnprintf(text, sizeof text, format, rest);
  va_end(rest);
  stop_with_message("%s: %s", place, text);
}

_Noreturn void __wrap__gfortran_abort(void) { stop_with_message("CALL ABORT"); }
