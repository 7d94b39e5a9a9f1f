/* What newlib needs to run a Cortex-M program as a Linux process under qemu-arm: start, and five system calls. Only for
 * tests on a computer; on the microcontroller your own start-up code stands in its place. */
#include <stddef.h>
#include <sys/stat.h>

int main(void);
void exit(int);

static int system_call(int number, int a, int b, int c)
{
    register int r7 __asm__("r7") = number;
    register int r0 __asm__("r0") = a;
    register int r1 __asm__("r1") = b;
    register int r2 __asm__("r2") = c;
    __asm__ volatile("svc 0" : "+r"(r0) : "r"(r7), "r"(r1), "r"(r2) : "memory");
    return r0;
}

int _read(int file, char *data, int count) { return system_call(3, file, (int)data, count); }
int _write(int file, const char *data, int count) { return system_call(4, file, (int)data, count); }

void _exit(int code)
{
    system_call(248, code, 0, 0);
    for (;;) {
    }
}

void *_sbrk(int more)
{
    static char heap[65536];
    static int used;
    if (used + more > (int)sizeof heap)
        return (void *)-1;
    used += more;
    return heap + used - more;
}

int _fstat(int file, struct stat *about)
{
    (void)file;
    about->st_mode = S_IFCHR;
    return 0;
}

int _isatty(int file) { return file < 3; }
int _close(int file) { return file - file - 1; }
int _lseek(int file, int offset, int whence) { return file - file + offset - offset + whence - whence; }
int _getpid(void) { return 1; }
int _kill(int process, int signal) { return process - process + signal - signal - 1; }
void _init(void) {}
void _fini(void) {}
void _start(void) { exit(main()); }
