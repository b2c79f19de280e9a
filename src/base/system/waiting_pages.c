/* Pages of a file that wait in memory to be written all at once (undo_driver.c). */
#define _DEFAULT_SOURCE
#define _FILE_OFFSET_BITS 64
#include "undo_pages.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

int keyway_start_waiting(waiting_pages *self, uint64_t length) {
  free(self->place_of);
  self->length = length;
  self->count = 0;
  self->place_of = calloc(length / page_size + 1, sizeof *self->place_of);
  return self->place_of ? 0 : -1;
}

void keyway_end_waiting(waiting_pages *self) {
  free(self->place_of);
  free(self->pages);
  memset(self, 0, sizeof *self);
}

/* End of the last page that the file had. */
static uint64_t border_of(const waiting_pages *self) {
  return self->place_of ? (self->length + page_size - 1) / page_size * page_size : 0;
}

size_t keyway_part_that_waits(const waiting_pages *self, uint64_t address, size_t size) {
  uint64_t border = border_of(self);
  if (address >= border) return 0;
  return address + size <= border ? size : (size_t)(border - address);
}

/* The record of a page, read from the file where it does not wait yet; NULL after a failure. */
static page_record *record_of_page(waiting_pages *self, int descriptor, uint64_t page) {
  page_record *record;
  if (self->place_of[page] > 0) return &self->pages[self->place_of[page] - 1];
  if (self->count == self->room) {
    size_t room = 2 * self->room + 16;
    page_record *pages = realloc(self->pages, room * sizeof *pages);
    if (!pages) return NULL;
    self->pages = pages;
    self->room = room;
  }
  record = &self->pages[self->count];
  record->place[0] = page * page_size;
  record->place[1] = page_size;
  if (record->place[0] + page_size > self->length)
    record->place[1] = self->length - record->place[0];
  if (keyway_get_all(descriptor, record->bytes, page_size, (off_t)record->place[0]) < 0)
    return NULL;
  self->place_of[page] = (uint32_t)++self->count;
  return record;
}

int keyway_let_wait(waiting_pages *self, int descriptor, uint64_t address, size_t size,
                    const void *bytes) {
  const unsigned char *next = bytes;
  while (size > 0) {
    size_t first = address % page_size, part = page_size - first;
    page_record *record = record_of_page(self, descriptor, address / page_size);
    if (!record) return -1;
    if (part > size) part = size;
    memcpy(record->bytes + first, next, part);
    if (record->place[1] < first + part) record->place[1] = first + part;
    next += part;
    address += part;
    size -= part;
  }
  return 0;
}

void keyway_read_waiting(const waiting_pages *self, uint64_t address, size_t size, void *bytes) {
  unsigned char *next = bytes;
  size = keyway_part_that_waits(self, address, size);
  while (size > 0) {
    size_t first = address % page_size, part = page_size - first;
    uint32_t place = self->place_of[address / page_size];
    if (part > size) part = size;
    if (place > 0) memcpy(next, self->pages[place - 1].bytes + first, part);
    next += part;
    address += part;
    size -= part;
  }
}

/* Writes the pages in their order; `done` counts those that were begun. 0: all are written. */
static int write_pages(const waiting_pages *self, int descriptor, size_t *done) {
  int status = 0;
  for (*done = 0; *done < self->count && status == 0; (*done)++) {
    const page_record *page = &self->pages[*done];
    status = keyway_put_all(descriptor, page->bytes, page->place[1], (off_t)page->place[0]);
  }
  return status;
}

/* The same by a child process, which ends its work when this process is killed meanwhile. The child
 * of vfork has the memory of this process, which waits for it; it takes no signals. -1: there is no
 * such process, or it has failed. */
static int write_in_child(const waiting_pages *self, int descriptor) {
  sigset_t all, before;
  size_t unused;
  int status = -1;
  pid_t child;
  sigfillset(&all);
  if (sigprocmask(SIG_SETMASK, &all, &before) != 0) return -1;
  child = vfork();
  if (child == 0) _exit(write_pages(self, descriptor, &unused) == 0 ? 0 : 1);
  if (child > 0)
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  sigprocmask(SIG_SETMASK, &before, NULL);
  return status == 0 ? 0 : -1;
}

int keyway_write_waiting(const waiting_pages *self, int descriptor) {
  unsigned char(*old)[page_size];
  size_t done;
  int status = 0;
  if (self->count == 0) return 0;
  old = malloc(self->count * sizeof *old);
  if (!old) return -1;
  for (size_t i = 0; i < self->count && status == 0; i++)
    status = keyway_get_all(descriptor, old[i], page_size, (off_t)self->pages[i].place[0]);
  if (status == 0 && write_in_child(self, descriptor) != 0) {
    status = write_pages(self, descriptor, &done);
    for (size_t i = 0; i < done && status != 0; i++)
      keyway_put_all(descriptor, old[i], self->pages[i].place[1], (off_t)self->pages[i].place[0]);
  }
  free(old);
  return status;
}
