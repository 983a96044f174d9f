// A library that a program is started with (LD_PRELOAD), and that lets one of its calls of the system fail, as an
// environment of a test does that has bad disks, no memory and no descriptors. scripts/inject-faults drives it by these
// variables of the environment:
//   FAILING_CALL     the kind (below), and which of its calls: "read 3"; "write 3+": this and all later ones; "count
//   0":
//                    none fails
//   FAILING_PROGRAM  the file name of the program whose calls count
//   FAILING_MARK     a file that is made when the call fails: no second process fails
//   FAILING_COUNTS   a file to which the numbers of calls are appended at the end
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>

extern "C" {
void* __libc_malloc(size_t);            // NOLINT(bugprone-reserved-identifier): the names of glibc
void* __libc_calloc(size_t, size_t);    // NOLINT(bugprone-reserved-identifier)
void* __libc_realloc(void*, size_t);    // NOLINT(bugprone-reserved-identifier)
void* __libc_memalign(size_t, size_t);  // NOLINT(bugprone-reserved-identifier)
}

namespace {

enum Kind { kOpen, kRead, kWrite, kSync, kResize, kRename, kClose, kMap, kFork, kDescriptor, kThread, kMemory, kKinds };
const char* const kNames[kKinds] = {"open",  "read", "write", "sync",       "resize", "rename",
                                    "close", "map",  "fork",  "descriptor", "thread", "memory"};

std::atomic<long> calls[kKinds];
int failing = -1;
long first = 0;
bool later_too = false;
bool selected = false;
const char* mark = nullptr;
std::atomic<bool> failed{false};
std::atomic<bool> in_main{
    false};  // memory counts from there: libraries allocate some before, where nothing can report it

// Only calls that this library does not replace.
void AppendTo(const char* path, const char* text) {
  const long file = syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (file < 0) return;
  syscall(SYS_write, file, text, strlen(text));
  syscall(SYS_close, file);
}

__attribute__((constructor)) void Begin() {
  const char* const program = getenv("FAILING_PROGRAM");
  const char* const call = getenv("FAILING_CALL");
  if (program == nullptr || call == nullptr) return;
  char path[4096] = {};
  if (syscall(SYS_readlinkat, AT_FDCWD, "/proc/self/exe", path, sizeof path - 1) <= 0) return;
  const char* const name = strrchr(path, '/');
  if (name == nullptr || strcmp(name + 1, program) != 0) return;
  mark = getenv("FAILING_MARK");
  for (int kind = 0; kind < kKinds; ++kind) {
    const size_t length = strlen(kNames[kind]);
    if (strncmp(call, kNames[kind], length) != 0 || call[length] != ' ') continue;
    failing = kind;
    first = atol(call + length + 1);
    later_too = call[strlen(call) - 1] == '+';
  }
  selected = true;
}

__attribute__((destructor)) void End() {
  const char* const counts = selected ? getenv("FAILING_COUNTS") : nullptr;
  if (counts == nullptr) return;
  for (int kind = 0; kind < kKinds; ++kind) {
    char line[64];
    snprintf(line, sizeof line, "%s %ld\n", kNames[kind], calls[kind].load());
    AppendTo(counts, line);
  }
}

// Whether this call fails, with `reason` in errno.
bool Fails(Kind kind, int reason) {
  if (!selected || (kind == kMemory && !in_main.load())) return false;
  const long number = ++calls[kind];
  if (kind != failing || number < first || (number > first && !later_too)) return false;
  if (!failed.exchange(true) && mark != nullptr) {
    const long file = syscall(SYS_openat, AT_FDCWD, mark, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file < 0) failing = -1;
    if (file < 0) return false;  // another process has failed
    syscall(SYS_close, file);
  }
  errno = reason;
  return true;
}

bool IsFile(int descriptor) {
  struct stat status;
  return selected && fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

template <typename Function>
Function Next(Function, const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}
#define NEXT(name) (Next(&name, #name))

using Main = int (*)(int, char**, char**);
Main program_main = nullptr;
int BeginMain(int argc, char** argv, char** environment) {
  in_main = true;
  return program_main(argc, argv, environment);
}

// As glibc does when a stream fails.
void SetError(FILE* file) {
  file->_flags |= 0x20;
}

}  // namespace

// NOLINTBEGIN(readability-inconsistent-declaration-parameter-name)
extern "C" {

int __libc_start_main(Main main, int argc, char** argv, void (*init)(), void (*end)(), void (*end_of_libraries)(),
                      void* stack) {
  using Start = int (*)(Main, int, char**, void (*)(), void (*)(), void (*)(), void*);
  program_main = main;
  return reinterpret_cast<Start>(dlsym(RTLD_NEXT, "__libc_start_main"))(BeginMain, argc, argv, init, end,
                                                                        end_of_libraries, stack);
}

#define OPENS(name)                                                            \
  int name(const char* path, int flags, ...) {                                 \
    va_list more;                                                              \
    va_start(more, flags);                                                     \
    const mode_t mode = va_arg(more, mode_t);                                  \
    va_end(more);                                                              \
    if (Fails(kOpen, EMFILE)) return -1;                                       \
    return static_cast<int>(syscall(SYS_openat, AT_FDCWD, path, flags, mode)); \
  }
OPENS(open)
OPENS(open64)
FILE* fopen(const char* path, const char* mode) {
  return Fails(kOpen, EMFILE) ? nullptr : NEXT(fopen)(path, mode);
}
FILE* fopen64(const char* path, const char* mode) {
  return Fails(kOpen, EMFILE) ? nullptr : NEXT(fopen64)(path, mode);
}
int mkostemp(char* path, int flags) {
  return Fails(kOpen, EMFILE) ? -1 : NEXT(mkostemp)(path, flags);
}
int mkostemp64(char* path, int flags) {
  return Fails(kOpen, EMFILE) ? -1 : NEXT(mkostemp64)(path, flags);
}
char* mkdtemp(char* path) {
  return Fails(kOpen, ENOSPC) ? nullptr : NEXT(mkdtemp)(path);
}
int mkdir(const char* path, mode_t mode) {
  return Fails(kOpen, ENOSPC) ? -1 : NEXT(mkdir)(path, mode);
}

ssize_t read(int file, void* bytes, size_t size) {
  return IsFile(file) && Fails(kRead, EIO) ? -1 : syscall(SYS_read, file, bytes, size);
}
ssize_t pread(int file, void* bytes, size_t size, off_t offset) {
  return IsFile(file) && Fails(kRead, EIO) ? -1 : syscall(SYS_pread64, file, bytes, size, offset);
}
ssize_t pread64(int file, void* bytes, size_t size, off64_t offset) {
  return pread(file, bytes, size, offset);
}
ssize_t readv(int file, const iovec* parts, int count) {
  return IsFile(file) && Fails(kRead, EIO) ? -1 : syscall(SYS_readv, file, parts, count);
}
size_t fread(void* bytes, size_t size, size_t count, FILE* file) {
  if (!IsFile(fileno(file)) || !Fails(kRead, EIO)) return NEXT(fread)(bytes, size, count, file);
  SetError(file);
  return 0;
}
int getc(FILE* file) {
  if (!IsFile(fileno(file)) || !Fails(kRead, EIO)) return NEXT(getc)(file);
  SetError(file);
  return EOF;
}

ssize_t write(int file, const void* bytes, size_t size) {
  return IsFile(file) && Fails(kWrite, ENOSPC) ? -1 : syscall(SYS_write, file, bytes, size);
}
ssize_t pwrite(int file, const void* bytes, size_t size, off_t offset) {
  return IsFile(file) && Fails(kWrite, ENOSPC) ? -1 : syscall(SYS_pwrite64, file, bytes, size, offset);
}
ssize_t pwrite64(int file, const void* bytes, size_t size, off64_t offset) {
  return pwrite(file, bytes, size, offset);
}
ssize_t writev(int file, const iovec* parts, int count) {
  return IsFile(file) && Fails(kWrite, ENOSPC) ? -1 : syscall(SYS_writev, file, parts, count);
}
size_t fwrite(const void* bytes, size_t size, size_t count, FILE* file) {
  if (!IsFile(fileno(file)) || !Fails(kWrite, ENOSPC)) return NEXT(fwrite)(bytes, size, count, file);
  SetError(file);
  return 0;
}
int fflush(FILE* file) {
  if (file == nullptr || !IsFile(fileno(file)) || !Fails(kWrite, ENOSPC)) return NEXT(fflush)(file);
  SetError(file);
  return EOF;
}

int fsync(int file) {
  return Fails(kSync, EIO) ? -1 : static_cast<int>(syscall(SYS_fsync, file));
}
int fdatasync(int file) {
  return Fails(kSync, EIO) ? -1 : static_cast<int>(syscall(SYS_fdatasync, file));
}
int ftruncate(int file, off_t size) noexcept {
  return Fails(kResize, ENOSPC) ? -1 : static_cast<int>(syscall(SYS_ftruncate, file, size));
}
int ftruncate64(int file, off64_t size) noexcept {
  return ftruncate(file, size);
}
int fallocate(int file, int mode, off_t offset, off_t size) {
  return Fails(kResize, ENOSPC) ? -1 : static_cast<int>(syscall(SYS_fallocate, file, mode, offset, size));
}
int fallocate64(int file, int mode, off64_t offset, off64_t size) {
  return fallocate(file, mode, offset, size);
}
int rename(const char* from, const char* to) noexcept {
  return Fails(kRename, ENOSPC) ? -1 : static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}
// The descriptor is closed nevertheless, as by Linux.
int close(int file) {
  const bool fails = IsFile(file) && Fails(kClose, EIO);
  const auto result = static_cast<int>(syscall(SYS_close, file));
  if (fails) errno = EIO;
  return fails ? -1 : result;
}

void* mmap(void* address, size_t size, int protection, int flags, int file, off_t offset) noexcept {
  return Fails(kMap, ENOMEM)
             ? MAP_FAILED
             : reinterpret_cast<void*>(syscall(SYS_mmap, address, size, protection, flags, file, offset));
}
void* mmap64(void* address, size_t size, int protection, int flags, int file, off64_t offset) noexcept {
  return mmap(address, size, protection, flags, file, offset);
}
int memfd_create(const char* name, unsigned flags) noexcept {
  return Fails(kMap, ENOMEM) ? -1 : NEXT(memfd_create)(name, flags);
}

pid_t fork() noexcept {
  return Fails(kFork, EAGAIN) ? -1 : NEXT(fork)();
}

int pipe2(int* ends, int flags) noexcept {
  return Fails(kDescriptor, EMFILE) ? -1 : NEXT(pipe2)(ends, flags);
}
int pipe(int* ends) noexcept {
  return Fails(kDescriptor, EMFILE) ? -1 : NEXT(pipe)(ends);
}
int socket(int family, int type, int protocol) noexcept {
  return Fails(kDescriptor, EMFILE) ? -1 : NEXT(socket)(family, type, protocol);
}
int socketpair(int family, int type, int protocol, int* ends) noexcept {
  return Fails(kDescriptor, EMFILE) ? -1 : NEXT(socketpair)(family, type, protocol, ends);
}
int eventfd(unsigned count, int flags) noexcept {
  return Fails(kDescriptor, EMFILE) ? -1 : NEXT(eventfd)(count, flags);
}
int signalfd(int file, const sigset_t* signals, int flags) noexcept {
  return Fails(kDescriptor, EMFILE) ? -1 : NEXT(signalfd)(file, signals, flags);
}
int epoll_create1(int flags) noexcept {
  return Fails(kDescriptor, EMFILE) ? -1 : NEXT(epoll_create1)(flags);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*function)(void*),
                   void* argument) noexcept {
  return Fails(kThread, EAGAIN) ? EAGAIN : NEXT(pthread_create)(thread, attributes, function, argument);
}

void* malloc(size_t size) noexcept {
  return Fails(kMemory, ENOMEM) ? nullptr : __libc_malloc(size);
}
void* calloc(size_t count, size_t size) noexcept {
  return Fails(kMemory, ENOMEM) ? nullptr : __libc_calloc(count, size);
}
void* realloc(void* memory, size_t size) noexcept {
  return Fails(kMemory, ENOMEM) ? nullptr : __libc_realloc(memory, size);
}
void* aligned_alloc(size_t alignment, size_t size) noexcept {
  return Fails(kMemory, ENOMEM) ? nullptr : __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, size_t alignment, size_t size) noexcept {
  if (Fails(kMemory, ENOMEM)) return ENOMEM;
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}

}  // extern "C"
// NOLINTEND(readability-inconsistent-declaration-parameter-name)
