/* Crashes of user routines: a signal during a call ends the call, not the program, so that the run
 * keeps its results; a change of the working folder is undone. */
#define _GNU_SOURCE
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { num_signals = 5, stack_bytes = 65536 };
static const int crashes[num_signals] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
static struct sigaction before[num_signals];
static struct stat start_folder;
static int start_descriptor = -1;

void keyway_on_missing_memory(void (*escape)(const char *)); /* base/process_limits.c */
void keyway_hold_reserve(void);
void keyway_free_reserve(void);
int keyway_lacks_memory(void);
void keyway_end_if_memory_lacks(int lacks); /* base/system/system_calls.c */
void keyway_umat_escape(const char *what); /* umat_bridge.c */

/* Leaves the call of the UMAT; outside of a call the former handler is next. */
static void leave_call(int number)
{
  sigset_t own;
  int lacks = keyway_lacks_memory();
  sigemptyset(&own);
  sigaddset(&own, number);
  pthread_sigmask(SIG_UNBLOCK, &own, NULL);
  keyway_free_reserve();
  keyway_umat_escape(strsignal(number));
  keyway_end_if_memory_lacks(lacks);
  for (int i = 0; i < num_signals; i++)
    if (crashes[i] == number) sigaction(number, &before[i], NULL);
  raise(number);
}

/* Called when a library is loaded. Remembers the working folder too. */
void keyway_umat_catch_crashes(void)
{
  struct sigaction now;
  if (start_descriptor >= 0) return;
  start_descriptor = open(".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (start_descriptor >= 0) fstat(start_descriptor, &start_folder);
  memset(&now, 0, sizeof now);
  now.sa_handler = leave_call;
  now.sa_flags = SA_ONSTACK | SA_NODEFER;
  sigemptyset(&now.sa_mask);
  for (int i = 0; i < num_signals; i++) sigaction(crashes[i], &now, &before[i]);
  keyway_on_missing_memory(keyway_umat_escape);
  keyway_hold_reserve();
}

/* A stack for the handler, one for each thread: a routine may have used up that of the thread. */
void keyway_umat_use_own_stack(void)
{
  static _Thread_local int has_stack;
  stack_t own;
  if (has_stack) return;
  has_stack = 1;
  memset(&own, 0, sizeof own);
  own.ss_size = stack_bytes;
  own.ss_sp = malloc(own.ss_size);
  if (own.ss_sp) sigaltstack(&own, NULL);
}

/* Goes back to the working folder of the start; 1 if a routine had changed it. */
int keyway_umat_restore_folder(void)
{
  struct stat now;
  if (start_descriptor < 0) return 0;
  if (stat(".", &now) == 0 && now.st_ino == start_folder.st_ino && now.st_dev == start_folder.st_dev)
    return 0;
  return fchdir(start_descriptor) == 0;
}
