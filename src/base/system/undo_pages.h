/* The journal of undo_driver.c, and the digest of a file, which undo_restore.c compares.
 *
 * A journal begins with a `journal_top`; records follow: address, length, checksum, bytes. A record
 * is complete before the file changes, so a last record that is cut off belongs to a page that is
 * still as it was.
 *
 * The digest of a file is the sum of the hashes of its blocks. A block that no write has touched
 * keeps its hash, so the digest at a checkpoint costs one reading of what was written since the
 * checkpoint before. A block that reaches beyond the end of the file is filled with zeros. */
#ifndef KEYWAY_UNDO_PAGES_H
#define KEYWAY_UNDO_PAGES_H

#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

enum { page_size = 4096, block_size = 65536 };

typedef struct {
  char magic[8];
  uint64_t number; /* of the checkpoint */
  uint64_t length; /* of the file at that moment */
  uint64_t digest; /* of the file at that moment */
  uint64_t sum;    /* checksum of the components before */
} journal_top;

typedef struct {
  uint64_t place[2]; /* address and size */
  uint64_t sum;      /* checksum of place and bytes */
  unsigned char bytes[page_size];
} page_record;

enum { record_top = offsetof(page_record, bytes) }; /* bytes of a record before its page */

/* 64-bit hash of some bytes. A change within eight bytes always changes it. */
uint64_t keyway_hash(uint64_t start, const void *bytes, size_t size);
uint64_t keyway_hash_of_record(const page_record *record);
/* Hash of a block of `block_size` bytes; never 0. */
uint64_t keyway_hash_of_block(uint64_t block, const void *bytes);
void keyway_start_top(journal_top *top, int number, uint64_t length, uint64_t digest);
int keyway_is_top(const journal_top *top);

/* 0: all bytes are written. */
int keyway_put_all(int descriptor, const void *bytes, size_t size, off_t place);
/* Reads what there is; zeros stand for what lies beyond the end of the file. 0: done. */
int keyway_get_all(int descriptor, void *bytes, size_t size, off_t place);

#endif
