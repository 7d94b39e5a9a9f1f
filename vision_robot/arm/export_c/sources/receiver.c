/* A stand-in for the microcontroller: frames from stdin, answers to stdout, movements as text on stderr. On the real one the
 * two calls of stdio are your serial port's, and vr_on_move is your motor control. */
#include <stdio.h>

#include "vr_link.h"

void vr_on_move(uint32_t time_ms, const vr_real joints[VR_JOINTS])
{
    int i;
    fprintf(stderr, "move %lu", (unsigned long)time_ms);
    for (i = 0; i < VR_JOINTS; i++)
        fprintf(stderr, " %.9g", (double)joints[i]);
    fprintf(stderr, "\n");
}

void vr_on_stop(void) { fprintf(stderr, "stop\n"); }

int main(void)
{
    static vr_link link;
    vr_real now[VR_JOINTS];
    unsigned length;
    int byte, i;
    for (i = 0; i < VR_JOINTS; i++)
        now[i] = (vr_lower[i] + vr_upper[i]) / 2;
    vr_link_start(&link, now);
    setvbuf(stdin, NULL, _IONBF, 0);
    while ((byte = getchar()) != EOF) {
        length = vr_link_byte(&link, (uint8_t)byte);
        if (length) {
            fwrite(link.out, 1, length, stdout);
            fflush(stdout);
        }
    }
    return 0;
}
