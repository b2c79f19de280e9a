/* Sets a file back to a checkpoint by the journals of undo_driver.c.
 *
 * The journals are those of the checkpoint and of all later ones. Nothing is written before all
 * records have passed their checksums and the file, as it will be, has the digest that it had. */
#define _POSIX_C_SOURCE 200809L
#define _FILE_OFFSET_BITS 64
#include "undo_pages.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

enum { num_journals = 3 }; /* one that is being started, the last one, the one before */

/* What a restore has found; undo_journal.f90 has the same numbers. */
enum {
  is_restored = 0,
  no_journal = 1,
  no_old_journal = 2,
  bad_journal = 3,
  bad_old_journal = 4,
  no_file = 5,
  short_file = 6,
  other_file = 7,
  no_writing = 8,
};

typedef struct {
  int descriptor; /* -1: there is none, or its top is damaged */
  journal_top top;
} journal;

/* Where the contents of a page are at the checkpoint. */
typedef struct {
  int journal; /* its place among the journals, from 1; 0: in the file */
  off_t place; /* of the record in the journal */
} page_source;

typedef struct {
  int file;
  journal journals[num_journals]; /* from the newest on */
  const journal_top *top;         /* of the checkpoint */
  page_source *pages;
  uint64_t num_pages;
} restoration;

static void open_journal(journal *self, const char *path) {
  self->descriptor = open(path, O_RDONLY | O_CLOEXEC);
  if (self->descriptor < 0) return;
  if (pread(self->descriptor, &self->top, sizeof self->top, 0) == (ssize_t)sizeof self->top &&
      keyway_is_top(&self->top))
    return;
  close(self->descriptor);
  self->descriptor = -1;
}

/* Whether a journal belongs to a checkpoint. */
static int has_number(const journal *self, uint64_t number) {
  return self->descriptor >= 0 && self->top.number == number;
}

/* Finds the top of the checkpoint. The journals of all later checkpoints must be there as well; the
 * last of them is the first or the second of the list. */
static int check_chain(restoration *self, uint64_t number) {
  const journal *newest = &self->journals[0];
  if (newest->descriptor < 0) newest = &self->journals[1];
  if (newest->descriptor < 0 || newest->top.number < number) return no_journal;
  for (uint64_t n = number; n <= newest->top.number; n++) {
    int j = 0;
    while (j < num_journals && !has_number(&self->journals[j], n)) j++;
    if (j == num_journals) return n == newest->top.number ? no_journal : no_old_journal;
    if (n == number) self->top = &self->journals[j].top;
  }
  return is_restored;
}

/* Reads one record: 1, 0 where the journal ends or is cut off, -1 for a damaged one. */
static int read_record(const journal *self, off_t place, page_record *record) {
  if (pread(self->descriptor, record, record_top, place) != record_top) return 0;
  if (record->place[0] % page_size != 0 || record->place[0] >= self->top.length ||
      record->place[1] == 0 || record->place[1] > page_size)
    return -1;
  if (pread(self->descriptor, record->bytes, record->place[1], place + record_top) !=
      (ssize_t)record->place[1])
    return 0;
  return record->sum == keyway_hash_of_record(record) ? 1 : -1;
}

/* Finds the sources of pages; those of older journals replace those of newer ones. */
static int read_journal(restoration *self, int j) {
  page_record record;
  off_t place = sizeof(journal_top);
  int status;
  while ((status = read_record(&self->journals[j], place, &record)) > 0) {
    uint64_t page = record.place[0] / page_size;
    if (page < self->num_pages) self->pages[page] = (page_source){j + 1, place};
    place += record_top + (off_t)record.place[1];
  }
  if (status == 0) return is_restored;
  return j == num_journals - 1 ? bad_old_journal : bad_journal;
}

/* Reads the sources of all pages. */
static int read_journals(restoration *self) {
  self->num_pages = (self->top->length + page_size - 1) / page_size;
  self->pages = calloc(self->num_pages + 1, sizeof *self->pages);
  if (!self->pages) return no_writing;
  for (int j = 0; j < num_journals; j++) {
    int status = is_restored;
    if (self->journals[j].descriptor >= 0 && self->journals[j].top.number >= self->top->number)
      status = read_journal(self, j);
    if (status != is_restored) return status;
  }
  return is_restored;
}

/* Bytes of a page below the length of the file. */
static size_t size_of_page(const restoration *self, uint64_t page) {
  uint64_t rest = self->top->length - page * page_size;
  return rest < page_size ? (size_t)rest : page_size;
}

/* Puts the contents of a page from its journal over `bytes`; -1: a failure. */
static int overlay_page(const restoration *self, uint64_t page, unsigned char *bytes) {
  const page_source *source = &self->pages[page];
  size_t size = size_of_page(self, page);
  if (source->journal == 0) return 0;
  return keyway_get_all(self->journals[source->journal - 1].descriptor, bytes, size,
                        source->place + record_top);
}

/* Whether the file still has the pages that no journal has. */
static int check_length(const restoration *self) {
  struct stat found;
  if (fstat(self->file, &found) != 0) return no_file;
  for (uint64_t page = 0; page < self->num_pages; page++)
    if (self->pages[page].journal == 0 &&
        page * page_size + size_of_page(self, page) > (uint64_t)found.st_size)
      return short_file;
  return is_restored;
}

/* Compares the digest of the file as it will be with that of the checkpoint. */
static int check_digest(const restoration *self) {
  enum { pages_of_block = block_size / page_size };
  unsigned char *bytes = malloc(block_size);
  uint64_t digest = 0;
  int status = bytes ? is_restored : no_writing;
  for (uint64_t b = 0; status == is_restored && b * block_size < self->top->length; b++) {
    uint64_t rest = self->top->length - b * block_size;
    if (keyway_get_all(self->file, bytes, block_size, (off_t)(b * block_size)) < 0)
      status = other_file;
    for (uint64_t i = 0; i < pages_of_block && b * pages_of_block + i < self->num_pages; i++)
      if (overlay_page(self, b * pages_of_block + i, bytes + i * page_size) < 0) status = no_journal;
    for (uint64_t i = rest; i < block_size; i++) bytes[i] = 0;
    digest += keyway_hash_of_block(b, bytes);
  }
  free(bytes);
  if (status != is_restored) return status;
  return digest == self->top->digest ? is_restored : other_file;
}

/* Writes the pages of the journals, and cuts the file to its length. */
static int write_pages(const restoration *self) {
  unsigned char bytes[page_size];
  for (uint64_t page = 0; page < self->num_pages; page++) {
    if (self->pages[page].journal == 0) continue;
    if (overlay_page(self, page, bytes) < 0) return no_writing;
    if (keyway_put_all(self->file, bytes, size_of_page(self, page), (off_t)(page * page_size)) < 0)
      return no_writing;
  }
  return ftruncate(self->file, (off_t)self->top->length) == 0 ? is_restored : no_writing;
}

/* Number of the checkpoint that a journal belongs to; -1 without a valid journal. */
int keyway_undo_number(const char *path) {
  journal found;
  open_journal(&found, path);
  if (found.descriptor < 0) return -1;
  close(found.descriptor);
  return (int)found.top.number;
}

/* Sets a file back to a checkpoint; the journals are given from the newest on. */
int keyway_undo_restore(const char *path, const char *starting, const char *last, const char *old,
                        int number) {
  restoration self = {.file = open(path, O_RDWR | O_CLOEXEC)};
  const char *paths[num_journals] = {starting, last, old};
  int status = no_file;
  for (int j = 0; j < num_journals; j++) open_journal(&self.journals[j], paths[j]);
  if (self.file >= 0) status = check_chain(&self, (uint64_t)number);
  if (status == is_restored) status = read_journals(&self);
  if (status == is_restored) status = check_length(&self);
  if (status == is_restored) status = check_digest(&self);
  if (status == is_restored) status = write_pages(&self);
  for (int j = 0; j < num_journals; j++)
    if (self.journals[j].descriptor >= 0) close(self.journals[j].descriptor);
  if (self.file >= 0 && close(self.file) != 0 && status == is_restored) status = no_writing;
  free(self.pages);
  return status;
}
