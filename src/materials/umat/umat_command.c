/* Runs the compiler for a UMAT, without a shell, in a temporary folder. */
#define _GNU_SOURCE
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* Signals that end the program wait until the temporary folder is removed. */
static void hold_signals(int how)
{
  sigset_t ends;
  sigemptyset(&ends);
  sigaddset(&ends, SIGINT);
  sigaddset(&ends, SIGTERM);
  sigaddset(&ends, SIGHUP);
  sigprocmask(how, &ends, NULL);
}

/* Makes a temporary folder; its path with a null, or an empty text. */
void keyway_make_temporary(char *path, size_t size)
{
  const char *parent = getenv("TMPDIR");
  if (!parent || !*parent) parent = P_tmpdir;
  hold_signals(SIG_BLOCK);
  if ((size_t)snprintf(path, size, "%s/keyway_umat_XXXXXX", parent) >= size || !mkdtemp(path))
    path[0] = '\0';
  if (!path[0]) hold_signals(SIG_UNBLOCK);
}

/* Removes a folder with the files in it. */
void keyway_remove_temporary(const char *path)
{
  char file[4096];
  struct dirent *entry;
  DIR *folder = opendir(path);
  if (!folder) {
    hold_signals(SIG_UNBLOCK);
    return;
  }
  while ((entry = readdir(folder))) {
    if ((size_t)snprintf(file, sizeof file, "%s/%s", path, entry->d_name) < sizeof file)
      unlink(file); /* not '.' and '..': unlink leaves folders alone */
  }
  closedir(folder);
  rmdir(path);
  hold_signals(SIG_UNBLOCK);
}

/* Runs a command whose words end with a null each; what it prints goes to a file. Returns its exit
 * status, 127 if it cannot be started. */
int keyway_umat_run(const char *words, size_t length, const char *output)
{
  enum { most_words = 1000, not_found = 127, failed = 1 };
  char *argument[most_words + 1];
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  sigset_t none;
  pid_t child;
  int count = 0, status = 0;
  for (size_t i = 0; i < length && count < most_words; i += strlen(words + i) + 1)
    argument[count++] = (char *)(words + i);
  argument[count] = NULL;
  sigemptyset(&none);
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, 1, output, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&files, 1, 2);
  status = posix_spawnp(&child, argument[0], &files, &attributes, argument, environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  if (status != 0) return not_found;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return failed;
  return WIFEXITED(status) ? WEXITSTATUS(status) : failed;
}
