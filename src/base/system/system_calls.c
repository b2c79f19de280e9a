/* Signals, the lock of a run, and the identity of files.
 *
 * A signal may arrive at any moment; its handler may only set flags and use system calls. The flags
 * below are therefore the one state of the program that no caller owns. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

int keyway_lacks_memory(void); /* base/process_limits.c */
void keyway_tell_of_missing_memory(void);
int keyway_has_user_routines(void);

enum { longest_path = 4096, name_room = 256, read_at_most = 4096, num_fatal = 7 };

static volatile sig_atomic_t first_signal, has_met_limit;
static char summary_path[longest_path]; /* of job.json; empty: nothing to mark */
static const int fatal[num_fatal] = {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGQUIT, SIGSYS};
static struct sigaction before[num_fatal];

/* The lock of this run. The folder is held open: it may move, and a UMAT may change the folder of the
 * process. */
static struct {
  int file, folder; /* descriptors; -1 while it is not taken */
  pid_t owner;
  char name[name_room]; /* in the folder */
} lock = {-1, -1, 0, ""};

enum { system_failed = 3 };

/* Turns the status "running" of job.json into "stopped", in place; signal handlers may call it. Whether
 * it has done so. */
static int mark_summary(void) {
  static const char running[] = "\"status\": \"running\"", stopped[] = "\"status\": \"stopped\"";
  char text[read_at_most];
  ssize_t length, i;
  int file;
  int is_marked = 0;
  if (!summary_path[0]) return 0;
  file = open(summary_path, O_RDWR | O_CLOEXEC);
  if (file < 0) return 0;
  length = pread(file, text, sizeof text, 0);
  for (i = 0; i + (ssize_t)sizeof running - 1 <= length; i++)
    if (memcmp(text + i, running, sizeof running - 1) == 0) {
      is_marked = pwrite(file, stopped, sizeof stopped - 1, i) > 0;
      break;
    }
  close(file);
  return is_marked;
}

/* Removes the lock file, unless another file has taken its name, and gives the lock back. Signal
 * handlers may call it, and processes that a UMAT has forked. */
static void drop_lock(void) {
  struct stat opened, named;
  if (lock.file < 0 || lock.owner != getpid()) return;
  if (fstatat(lock.folder, lock.name, &named, 0) == 0 && fstat(lock.file, &opened) == 0 &&
      named.st_ino == opened.st_ino && named.st_dev == opened.st_dev)
    unlinkat(lock.folder, lock.name, 0);
  close(lock.file);
  close(lock.folder);
  lock.file = lock.folder = -1;
}

/* Ends the process by a signal, as if the program had no handler. */
static void end_by(int signal_number) {
  sigset_t only;
  signal(signal_number, SIG_DFL);
  sigemptyset(&only);
  sigaddset(&only, signal_number);
  sigprocmask(SIG_UNBLOCK, &only, NULL);
  raise(signal_number);
}

/* Ends a run that missing memory has crashed within a library, which has no message for that. */
void keyway_end_if_memory_lacks(int lacks) {
  if (!lacks) return;
  keyway_tell_of_missing_memory();
  drop_lock();
  _exit(system_failed);
}

static struct sigaction before_run[num_fatal];
static int is_run_open; /* job.json is watched */

/* A crash before the results are open: by missing memory, or the former handler is next. */
static void end_early_crash(int signal_number) {
  int i;
  keyway_end_if_memory_lacks(keyway_lacks_memory());
  for (i = 0; i < num_fatal; i++)
    if (fatal[i] == signal_number) sigaction(signal_number, &before_run[i], NULL);
  raise(signal_number);
}

/* The end of the program before the results are open. The Fortran library ends it with code 1. */
static void end_early(int code, void *ignored) {
  (void)ignored;
  if (!is_run_open && code == 1) keyway_end_if_memory_lacks(keyway_lacks_memory());
}

/* From now on a crash by missing memory has a message: libraries have none for that. */
void keyway_watch_memory(void) {
  struct sigaction now;
  int i;
  memset(&now, 0, sizeof now);
  now.sa_handler = end_early_crash;
  now.sa_flags = SA_ONSTACK;
  sigemptyset(&now.sa_mask);
  for (i = 0; i < num_fatal; i++) sigaction(fatal[i], &now, &before_run[i]);
  on_exit(end_early, NULL);
}

/* The end of the program. A run that is still "running" was ended by a library. */
static void mark_at_end(void) {
  if (mark_summary()) keyway_end_if_memory_lacks(keyway_lacks_memory());
}

/* The first signal asks the run to stop after its increment, the second ends it at once. */
static void ask_to_stop(int signal_number) {
  if (first_signal == 0) {
    first_signal = signal_number;
    return;
  }
  mark_summary();
  drop_lock();
  end_by(signal_number);
}

static void note_limit(int signal_number) {
  (void)signal_number;
  has_met_limit = 1;
}

/* A crash: the former handler comes next, which ends the call of a UMAT or prints where. */
static void leave_mark(int signal_number) {
  int i;
  mark_summary();
  summary_path[0] = '\0';
  if (!keyway_has_user_routines()) keyway_end_if_memory_lacks(keyway_lacks_memory());
  for (i = 0; i < num_fatal; i++)
    if (fatal[i] == signal_number) sigaction(signal_number, &before[i], NULL);
  raise(signal_number);
}

static void catch_one(int signal_number, void (*handler)(int)) {
  struct sigaction now, old;
  memset(&now, 0, sizeof now);
  now.sa_handler = handler;
  now.sa_flags = SA_RESTART;
  sigemptyset(&now.sa_mask);
  /* A signal that the caller ignores (nohup, background jobs) stays ignored. */
  if (sigaction(signal_number, NULL, &old) == 0 && old.sa_handler == SIG_IGN) return;
  sigaction(signal_number, &now, NULL);
}

/* Signals that ask to stop. */
static const int stopping[] = {SIGINT, SIGTERM, SIGHUP, SIGXCPU};
enum { num_stopping = sizeof stopping / sizeof stopping[0] };

static void catch_stopping(void (*handler)(int)) {
  for (int i = 0; i < num_stopping; i++) catch_one(stopping[i], handler);
}

/* The first signal that asks the run to stop sets a flag alone. */
void keyway_outlive_signal(void) { catch_stopping(ask_to_stop); }

/* From now on signals stop the run after its increment, and a crash marks job.json at PATH. The empty
 * path: the run has ended, nothing is marked any more. */
void keyway_catch_signals(const char *path) {
  static int is_caught = 0;
  struct sigaction now;
  int i;
  summary_path[0] = '\0';
  if (strlen(path) < sizeof summary_path) strcpy(summary_path, path);
  if (is_caught || !path[0]) return;
  is_caught = 1;
  is_run_open = 1;
  keyway_outlive_signal();
  memset(&now, 0, sizeof now);
  now.sa_handler = note_limit;
  now.sa_flags = SA_RESTART;
  sigemptyset(&now.sa_mask);
  sigaction(SIGXFSZ, &now, NULL);
  now.sa_handler = leave_mark;
  now.sa_flags = SA_ONSTACK; /* that of umat_crash.c: a routine may have used up its own */
  for (i = 0; i < num_fatal; i++) sigaction(fatal[i], &now, &before[i]);
  atexit(mark_at_end);
}

/* A signal that has asked another process of the run to stop. The first one that this process gets
 * itself still does not end it. */
static int taken_signal;

void keyway_take_signal(int signal_number) { taken_signal = signal_number; }

/* The signal that asked to stop, 0 for none. */
int keyway_stop_signal(void) { return first_signal ? first_signal : taken_signal; }

/* Whether a write met the limit of file sizes. */
int keyway_has_met_limit(void) { return has_met_limit; }

/* Before the results are open the first signal ends the process, without a lock that stays. */
static void end_unopened(int signal_number) {
  drop_lock();
  end_by(signal_number);
}

static volatile sig_atomic_t early_signal;

static void note_early(int signal_number) { early_signal = signal_number; }

/* What a lock file says: the process and its host, as "123 host". */
static void read_holder(int file, char *holder, size_t room) {
  ssize_t length = pread(file, holder, room - 1, 0);
  holder[length > 0 ? length : 0] = '\0';
  holder[strcspn(holder, "\n")] = '\0';
}

/* The same of a lock that another process has, which may have taken it a moment ago and not have
 * written its name yet: at most a second. */
static void await_holder(int file, char *holder, size_t room) {
  static const struct timespec moment = {0, 1000000};
  int i;
  for (i = 0; i < 1000; i++) {
    read_holder(file, holder, room);
    if (holder[0]) return;
    nanosleep(&moment, NULL);
  }
}

/* Whether a file is empty or holds "123 host": another file of this name is not written over. */
static int is_lock(const char *holder) {
  size_t digits = strspn(holder, "0123456789");
  return digits > 0 && holder[digits] == ' ' && strlen(holder) < 300;
}

/* Whether the lock that a process left behind may be taken over: the process is of this host (the
 * kernel has dropped its lock, so it has ended). */
static int is_of_this_host(const char *holder, const char *host) {
  const char *blank = strchr(holder, ' ');
  return !blank || strcmp(blank + 1, host) == 0;
}

/* The end of the program gives the lock back, wherever it ends: a lock that stays was left by a
 * process that was killed. */
static void keep_lock(int file, const char *path) {
  static int is_registered;
  char folder[longest_path] = ".";
  const char *slash = strrchr(path, '/');
  if (slash) snprintf(folder, sizeof folder, "%.*s", (int)(slash - path + 1), path);
  snprintf(lock.name, sizeof lock.name, "%s", slash ? slash + 1 : path);
  lock.folder = open(folder, O_PATH | O_DIRECTORY | O_CLOEXEC);
  lock.owner = getpid();
  lock.file = file;
  if (!is_registered++) atexit(drop_lock);
}

/* Takes the lock file PATH. Returns its descriptor, or a negative number as keyway_take_lock. */
static int take_lock(const char *path, char *holder, size_t room) {
  char host[256] = "", text[300];
  struct stat opened, named;
  int file, length;
  gethostname(host, sizeof host - 1);
  for (;;) {
    holder[0] = '\0';
    file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (file < 0) return -1;
    if (flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      await_holder(file, holder, room);
      close(file);
      return -2;
    }
    /* The process that had the lock may have removed the file in between. */
    if (stat(path, &named) == 0 && fstat(file, &opened) == 0 && named.st_ino == opened.st_ino &&
        named.st_dev == opened.st_dev)
      break;
    close(file);
  }
  read_holder(file, holder, room);
  if (holder[0] && !is_lock(holder)) {
    close(file);
    return -1;
  }
  if (!is_of_this_host(holder, host)) {
    close(file);
    return -3;
  }
  length = snprintf(text, sizeof text, "%ld %s\n", (long)getpid(), host);
  if (ftruncate(file, 0) != 0 || pwrite(file, text, (size_t)length, 0) != length) {
    unlink(path);
    close(file);
    return -4;
  }
  keep_lock(file, path);
  return file;
}

/* Takes the lock file PATH. Returns its descriptor, or -1: it cannot be made, -2: another process has
 * it, -3: it was left by a process of another host, -4: the disk is full. `holder`: who has it or has
 * left it, "" for none.
 *
 * A signal that asks to stop waits until the lock is taken or not. It is noted, not blocked: another
 * thread, such as one of OpenBLAS, would still get it and end the process. */
int keyway_take_lock(const char *path, char *holder, size_t room) {
  int file;
  if (!is_run_open) catch_stopping(note_early);
  file = take_lock(path, holder, room);
  if (is_run_open) return file;
  catch_stopping(end_unopened);
  if (early_signal) end_unopened(early_signal);
  return file;
}

/* Gives the lock back and removes its file. */
void keyway_give_lock(void) { drop_lock(); }

/* Makes an empty file or empties an old one. A pipe that nobody reads is a failure, no endless wait. */
int keyway_create(const char *path, int mode) {
  return open(path, O_WRONLY | O_CREAT | O_TRUNC | O_NONBLOCK | O_CLOEXEC, mode);
}

/* Opens a file for appending after its first LENGTH bytes; what follows them is cut off. -1: the file
 * cannot be opened, -2: it is shorter. */
int keyway_open_again(const char *path, long length) {
  struct stat found;
  int file = open(path, O_WRONLY | O_APPEND | O_CLOEXEC);
  if (file < 0) return -1;
  if (fstat(file, &found) == 0 && found.st_size >= length && ftruncate(file, length) == 0) return file;
  close(file);
  return -2;
}

/* The reason of the last failed call. */
void keyway_reason(char *text, size_t room) { snprintf(text, room, "%s", strerror(errno)); }

/* Writes a text over a file that is as long or longer; blanks fill the rest. 0: it is done. */
int keyway_write_over(const char *path, const char *text, size_t length) {
  struct stat found;
  size_t done = 0;
  int file = open(path, O_WRONLY | O_CLOEXEC);
  if (file < 0) return -1;
  if (fstat(file, &found) != 0 || !S_ISREG(found.st_mode) || found.st_size < (off_t)length) {
    close(file);
    return -1;
  }
  while (done < (size_t)found.st_size) {
    char blanks[512];
    size_t wanted = done < length ? length - done : (size_t)found.st_size - done;
    ssize_t taken;
    memset(blanks, ' ', sizeof blanks);
    if (done >= length && wanted > sizeof blanks) wanted = sizeof blanks;
    taken = pwrite(file, done < length ? text + done : blanks, wanted, (off_t)done);
    if (taken <= 0) break;
    done += (size_t)taken;
  }
  return close(file) == 0 && done == (size_t)found.st_size ? 0 : -1;
}

/* Whether two paths name one file. */
int keyway_is_same_file(const char *first, const char *second) {
  struct stat a, b;
  return stat(first, &a) == 0 && stat(second, &b) == 0 && a.st_dev == b.st_dev &&
         a.st_ino == b.st_ino;
}

/* Letters in a line of a terminal; 80 where the terminal does not say. */
int keyway_terminal_width(int descriptor) {
  struct winsize size;
  if (ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 1) return size.ws_col;
  return 80;
}
