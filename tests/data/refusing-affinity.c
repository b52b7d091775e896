// A system that refuses to pin threads, as where a filter of system calls forbids it.
#include <errno.h>

int sched_setaffinity(int process, unsigned long size, const void *set) {
    (void)process, (void)size, (void)set;
    errno = EPERM;
    return -1;
}
