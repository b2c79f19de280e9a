/* Hashes, and reading and writing of whole pieces, for undo_driver.c and undo_restore.c. */
#define _POSIX_C_SOURCE 200809L
#define _FILE_OFFSET_BITS 64
#include "undo_pages.h"

#include <string.h>
#include <unistd.h>

static const char magic[8] = "KEYWAYU2";

/* A multiplication by an odd number and a shift, as in FNV and splitmix64: each step maps the values
 * of `hash` one to one. */
static uint64_t mixed(uint64_t hash, uint64_t word) {
  hash = (hash ^ word) * UINT64_C(0x9e3779b97f4a7c15);
  return hash ^ (hash >> 32);
}

uint64_t keyway_hash(uint64_t start, const void *bytes, size_t size) {
  const unsigned char *next = bytes;
  uint64_t hash = mixed(start, size), word;
  for (; size >= sizeof word; size -= sizeof word, next += sizeof word) {
    memcpy(&word, next, sizeof word);
    hash = mixed(hash, word);
  }
  word = 0;
  memcpy(&word, next, size);
  return mixed(hash, word);
}

uint64_t keyway_hash_of_record(const page_record *record) {
  uint64_t start = keyway_hash(0, record->place, sizeof record->place);
  return keyway_hash(start, record->bytes, record->place[1]);
}

uint64_t keyway_hash_of_block(uint64_t block, const void *bytes) {
  uint64_t hash = keyway_hash(block, bytes, block_size);
  return hash ? hash : 1;
}

void keyway_start_top(journal_top *top, int number, uint64_t length, uint64_t digest) {
  memcpy(top->magic, magic, sizeof magic);
  top->number = (uint64_t)number;
  top->length = length;
  top->digest = digest;
  top->sum = keyway_hash(0, top, offsetof(journal_top, sum));
}

int keyway_is_top(const journal_top *top) {
  return memcmp(top->magic, magic, sizeof magic) == 0 &&
         top->sum == keyway_hash(0, top, offsetof(journal_top, sum));
}

int keyway_put_all(int descriptor, const void *bytes, size_t size, off_t place) {
  const char *next = bytes;
  while (size > 0) {
    ssize_t done = pwrite(descriptor, next, size, place);
    if (done <= 0) return -1;
    next += done;
    place += done;
    size -= (size_t)done;
  }
  return 0;
}

int keyway_get_all(int descriptor, void *bytes, size_t size, off_t place) {
  char *next = bytes;
  while (size > 0) {
    ssize_t done = pread(descriptor, next, size, place);
    if (done < 0) return -1;
    if (done == 0) break;
    next += done;
    place += done;
    size -= (size_t)done;
  }
  memset(next, 0, size);
  return 0;
}
