/* A file driver of HDF5 that can set a file back to an earlier moment.
 *
 * HDF5 overwrites its own structures in place. A process that is killed meanwhile leaves a file that
 * may be unreadable, and a continued run needs the file as it was at the checkpoint. After
 * keyway_undo_start the driver therefore copies each page of the file to a journal before the first
 * write into the page. undo_restore.c writes these pages back and cuts the file to its length. The
 * journal begins with a digest of the file (undo_pages.h), by which a file is known that was changed
 * or damaged between two runs.
 *
 * A write can fail in the middle of these structures: the disk is full. The driver therefore holds
 * the pages that were replaced since the last flush in memory as well. After a failure it writes
 * them back, which needs no new room on the disk, cuts the file to its length at that flush, and
 * refuses all further writes. The file is then readable and holds what was written before. */
#define _POSIX_C_SOURCE 200809L
#define _FILE_OFFSET_BITS 64
#include "undo_pages.h"

#include <fcntl.h>
#include <hdf5.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#if H5_VERSION_GE(1, 13, 0)
#include <H5FDdevelop.h>
#endif

/* Pages that change after a moment, when the file had the length `length`. */
typedef struct {
  haddr_t length;
  unsigned char *has_page; /* one for each page below that length; NULL: no page is of interest */
} page_set;

typedef struct {
  H5FD_t base; /* first, as HDF5 requires */
  int descriptor;
  haddr_t end_of_address, end_of_file;
  int journal; /* -1: none */
  page_set kept; /* in the journal */
  page_set held; /* in `copies`, since the last flush */
  page_record *copies;
  size_t num_copies, room_for_copies;
  int is_broken; /* a write has failed: the file stays as it was at the last flush */
  uint64_t *hashes; /* of blocks; 0: not known since a write */
  haddr_t room_for_hashes;
  dev_t device;
  ino_t inode;
} undo_file;

static int start_pages(page_set *self, haddr_t length) {
  free(self->has_page);
  self->length = length;
  self->has_page = calloc(length / page_size + 1, 1);
  return self->has_page ? 0 : -1;
}

static void end_pages(page_set *self) {
  free(self->has_page);
  self->has_page = NULL;
}

/* Reads a page that a set does not have yet. 1: it is read, 0: the set has it, -1: a failure. */
static int read_page(const undo_file *self, const page_set *pages, haddr_t page, page_record *copy) {
  if (pages->has_page[page]) return 0;
  copy->place[0] = page * page_size;
  copy->place[1] = page_size;
  if (copy->place[0] + page_size > pages->length) copy->place[1] = pages->length - copy->place[0];
  return keyway_get_all(self->descriptor, copy->bytes, copy->place[1], (off_t)copy->place[0]) < 0 ? -1 : 1;
}

/* Adds a page to the journal; a record that is cut off is removed again. */
static int keep_page(undo_file *self, page_record *copy) {
  off_t tail = lseek(self->journal, 0, SEEK_END);
  if (tail < 0) return -1;
  copy->sum = keyway_hash_of_record(copy);
  if (keyway_put_all(self->journal, copy, record_top + copy->place[1], tail) == 0) return 0;
  if (ftruncate(self->journal, tail) != 0) end_pages(&self->kept);
  return -1;
}

static int hold_page(undo_file *self, page_record *copy) {
  if (self->num_copies == self->room_for_copies) {
    size_t room = 2 * self->room_for_copies + 16;
    page_record *copies = realloc(self->copies, room * sizeof *copies);
    if (!copies) return -1;
    self->copies = copies;
    self->room_for_copies = room;
  }
  self->copies[self->num_copies++] = *copy;
  return 0;
}

/* Copies the pages of [first, end) to where they belong, those of a set that it does not have yet. */
static int copy_pages(undo_file *self, page_set *pages, haddr_t first, haddr_t end,
                      int (*store)(undo_file *, page_record *)) {
  page_record copy;
  if (!pages->has_page) return 0;
  if (end > pages->length) end = pages->length;
  for (haddr_t page = first / page_size; page * page_size < end; page++) {
    int status = read_page(self, pages, page, &copy);
    if (status < 0 || (status > 0 && store(self, &copy) < 0)) return -1;
    pages->has_page[page] = 1;
  }
  return 0;
}

/* The blocks of [first, end) change: their hashes are no longer known. */
static int forget_hashes(undo_file *self, haddr_t first, haddr_t end) {
  haddr_t needed = end / block_size + 1;
  if (needed > self->room_for_hashes) {
    haddr_t room = 2 * needed;
    uint64_t *hashes = realloc(self->hashes, room * sizeof *hashes);
    if (!hashes) return -1;
    memset(hashes + self->room_for_hashes, 0, (room - self->room_for_hashes) * sizeof *hashes);
    self->hashes = hashes;
    self->room_for_hashes = room;
  }
  for (haddr_t b = first / block_size; b * block_size < end; b++) self->hashes[b] = 0;
  return 0;
}

/* The digest of the file as it is on the disk; reads the blocks that have changed. 0: done. */
static int find_digest(undo_file *self, uint64_t *digest) {
  unsigned char *bytes = malloc(block_size);
  int status = bytes && forget_hashes(self, self->end_of_file, self->end_of_file) == 0 ? 0 : -1;
  *digest = 0;
  for (haddr_t b = 0; status == 0 && b * block_size < self->end_of_file; b++) {
    if (self->hashes[b] == 0) {
      status = keyway_get_all(self->descriptor, bytes, block_size, (off_t)(b * block_size));
      self->hashes[b] = keyway_hash_of_block(b, bytes);
    }
    *digest += self->hashes[b];
  }
  free(bytes);
  return status;
}

/* Before [first, end) changes: its pages go to memory and to the journal. */
static int save_pages(undo_file *self, haddr_t first, haddr_t end) {
  if (forget_hashes(self, first, end) < 0) return -1;
  if (copy_pages(self, &self->held, first, end, hold_page) < 0) return -1;
  return self->journal < 0 ? 0 : copy_pages(self, &self->kept, first, end, keep_page);
}

/* After a failed write: the file becomes what it was at the last flush, and stays so. */
static int give_up(undo_file *self) {
  self->is_broken = 1;
  if (!self->held.has_page) return -1;
  for (size_t i = 0; i < self->num_copies; i++)
    if (keyway_put_all(self->descriptor, self->copies[i].bytes, self->copies[i].place[1],
                (off_t)self->copies[i].place[0]) < 0)
      return -1;
  if (ftruncate(self->descriptor, (off_t)self->held.length) != 0) return -1;
  self->end_of_file = self->held.length;
  return -1;
}

static void end_journal(undo_file *self) {
  if (self->journal >= 0) close(self->journal);
  end_pages(&self->kept);
  self->journal = -1;
}

static H5FD_t *open_file(const char *name, unsigned flags, hid_t fapl, haddr_t most) {
  int mode = flags & H5F_ACC_RDWR ? O_RDWR : O_RDONLY;
  struct stat found;
  undo_file *self = calloc(1, sizeof *self);
  (void)fapl;
  (void)most;
  if (!self) return NULL;
  if (flags & H5F_ACC_TRUNC) mode |= O_TRUNC;
  if (flags & H5F_ACC_CREAT) mode |= O_CREAT;
  if (flags & H5F_ACC_EXCL) mode |= O_EXCL;
  self->journal = -1;
  self->descriptor = open(name, mode | O_CLOEXEC, 0666);
  if (self->descriptor < 0 || fstat(self->descriptor, &found) != 0) {
    if (self->descriptor >= 0) close(self->descriptor);
    free(self);
    return NULL;
  }
  self->end_of_file = (haddr_t)found.st_size;
  self->device = found.st_dev;
  self->inode = found.st_ino;
  return &self->base;
}

static herr_t close_file(H5FD_t *file) {
  undo_file *self = (undo_file *)file;
  int status = close(self->descriptor);
  end_journal(self);
  end_pages(&self->held);
  free(self->copies);
  free(self->hashes);
  free(self);
  return status == 0 ? 0 : -1;
}

static int compare_files(const H5FD_t *first, const H5FD_t *second) {
  const undo_file *a = (const undo_file *)first, *b = (const undo_file *)second;
  if (a->device != b->device) return a->device < b->device ? -1 : 1;
  if (a->inode != b->inode) return a->inode < b->inode ? -1 : 1;
  return 0;
}

/* The flags of HDF5's own driver for files. */
static herr_t query(const H5FD_t *file, unsigned long *flags) {
  (void)file;
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  return 0;
}

static haddr_t get_eoa(const H5FD_t *file, H5FD_mem_t kind) {
  (void)kind;
  return ((const undo_file *)file)->end_of_address;
}

static herr_t set_eoa(H5FD_t *file, H5FD_mem_t kind, haddr_t address) {
  (void)kind;
  ((undo_file *)file)->end_of_address = address;
  return 0;
}

static haddr_t get_eof(const H5FD_t *file, H5FD_mem_t kind) {
  (void)kind;
  return ((const undo_file *)file)->end_of_file;
}

static herr_t get_handle(H5FD_t *file, hid_t fapl, void **handle) {
  (void)fapl;
  *handle = file;
  return 0;
}

static herr_t read_bytes(H5FD_t *file, H5FD_mem_t kind, hid_t plan, haddr_t address, size_t size,
                         void *bytes) {
  (void)kind;
  (void)plan;
  return keyway_get_all(((undo_file *)file)->descriptor, bytes, size, (off_t)address);
}

static herr_t write_bytes(H5FD_t *file, H5FD_mem_t kind, hid_t plan, haddr_t address, size_t size,
                          const void *bytes) {
  undo_file *self = (undo_file *)file;
  (void)kind;
  (void)plan;
  if (self->is_broken) return -1;
  if (save_pages(self, address, address + size) < 0) return give_up(self);
  if (keyway_put_all(self->descriptor, bytes, size, (off_t)address) < 0) return give_up(self);
  if (address + size > self->end_of_file) self->end_of_file = address + size;
  return 0;
}

/* Gives the file the length that HDF5 takes it to have. */
static herr_t set_length(H5FD_t *file, hid_t plan, hbool_t is_closing) {
  undo_file *self = (undo_file *)file;
  (void)plan;
  (void)is_closing;
  if (self->is_broken) return -1;
  if (self->end_of_address == self->end_of_file) return 0;
  if (save_pages(self, self->end_of_address, self->end_of_file) < 0) return give_up(self);
  if (ftruncate(self->descriptor, (off_t)self->end_of_address) != 0) return give_up(self);
  self->end_of_file = self->end_of_address;
  return 0;
}

/* A file that another process has locked is not opened, as with HDF5's own driver. */
static herr_t lock_file(H5FD_t *file, hbool_t is_written) {
  return flock(((undo_file *)file)->descriptor, (is_written ? LOCK_EX : LOCK_SH) | LOCK_NB);
}

static herr_t unlock_file(H5FD_t *file) {
  return flock(((undo_file *)file)->descriptor, LOCK_UN);
}

static const H5FD_class_t driver_class = {
#if H5_VERSION_GE(1, 13, 0)
    .version = H5FD_CLASS_VERSION,
    .value = (H5FD_class_value_t)512, /* for experiments, not registered with the HDF Group */
#endif
    .name = "keyway_undo",
    .maxaddr = ((haddr_t)1 << 62) - 1,
    .fc_degree = H5F_CLOSE_WEAK,
    .open = open_file,
    .close = close_file,
    .cmp = compare_files,
    .query = query,
    .get_eoa = get_eoa,
    .set_eoa = set_eoa,
    .get_eof = get_eof,
    .get_handle = get_handle,
    .read = read_bytes,
    .write = write_bytes,
    .truncate = set_length,
    .lock = lock_file,
    .unlock = unlock_file,
    .fl_map = H5FD_FLMAP_DICHOTOMY,
};

/* A property list for files with this driver; the caller closes it. */
int64_t keyway_undo_access(void) {
  static hid_t driver = -1;
  hid_t access;
  if (driver < 0 || H5Iis_valid(driver) <= 0) driver = H5FDregister(&driver_class);
  access = H5Pcreate(H5P_FILE_ACCESS);
  if (driver < 0 || access < 0) return -1;
  return H5Pset_driver(access, driver, NULL) < 0 ? -1 : access;
}

/* The driver's own record of an open file; NULL without it. */
static undo_file *record_of(int64_t file) {
  void *handle = NULL;
  if (H5Fget_vfd_handle((hid_t)file, H5P_DEFAULT, &handle) < 0) return NULL;
  return handle;
}

/* The file was flushed: after a failed write it becomes what it is now. 0: done. */
int keyway_undo_mark(int64_t file) {
  undo_file *self = record_of(file);
  if (!self) return -1;
  self->num_copies = 0;
  return start_pages(&self->held, self->end_of_file);
}

/* Starts the journal of a checkpoint: the present file, which was flushed, is what a restore gives.
 * 0: it is started. */
int keyway_undo_start(int64_t file, const char *path, int number) {
  undo_file *self = record_of(file);
  journal_top top;
  uint64_t digest;
  if (!self) return -1;
  end_journal(self);
  self->journal = open(path, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (self->journal >= 0 && find_digest(self, &digest) == 0 &&
      start_pages(&self->kept, self->end_of_file) == 0) {
    keyway_start_top(&top, number, self->end_of_file, digest);
    if (keyway_put_all(self->journal, &top, sizeof top, 0) == 0) return 0;
  }
  end_journal(self);
  self->is_broken = 1; /* what is written from now on could not be undone */
  return -1;
}
