/* The microcontroller's end of the serial line: frames in, answers out.
 *
 *   0x00  COBS( kind u8 | session u16 | sequence u16 | payload | CRC-32 u32 )  0x00      little-endian
 *
 *   kind              payload
 *   1    HELLO        version u8, joints u8, fingerprint u32, silence u16 [ms]
 *   2    JOINTS       time u32 [ms], joints f32 x n [m or rad]
 *   3    POSE         time u32 [ms], position f32 x 3 [m], rotation vector f32 x 3 [rad] of base_from_tool
 *   4    STOP         none
 *   0x81 WELCOME      status u8, version u8, joints u8, fingerprint u32, joints f32 x n
 *   0x82 ANSWER       status u8, joints f32 x n, position error f32 [m], orientation error f32 [rad]
 *
 * A command is carried out once: when it is whole, of this session, and the next in number. The same number again is
 * answered from memory. Nothing else moves the arm, and a damaged frame is dropped in silence: the computer sends it
 * again. Call vr_link_byte from the main loop, not from an interrupt: the last byte of a POSE solves for the joints.
 */
#ifndef VR_LINK_H
#define VR_LINK_H

#include <stdint.h>

#include "vr_arm.h"

#define VR_LINK_VERSION 1
#define VR_LINK_LONGEST 250 /* bytes between two zeros */

enum vr_link_status {
    VR_LINK_DONE = 0,
    VR_LINK_OUTSIDE_LIMITS = 1,
    VR_LINK_UNREACHABLE = 2,
    VR_LINK_NOT_FINITE = 3,
    VR_LINK_OUT_OF_ORDER = 4,
    VR_LINK_NO_SESSION = 5,
    VR_LINK_MALFORMED = 6,
    VR_LINK_MISMATCH = 7,
    VR_LINK_STOPPED = 8
};

typedef struct vr_link {
    vr_real joints[VR_JOINTS]; /* commanded last; where a POSE is solved from */
    uint8_t out[VR_LINK_LONGEST + 2];
    uint8_t run[VR_LINK_LONGEST];
    unsigned run_length; /* beyond VR_LINK_LONGEST: too long to be a frame */
    uint16_t session;    /* 0: none, nothing moves */
    uint16_t sequence;   /* of the last command carried out or refused */
    uint8_t last_status;
    float last_error[2];
    uint32_t silence_ms; /* 0: silence is allowed */
    uint32_t silent_ms;
    uint32_t damaged; /* runs of bytes that were no whole frame */
} vr_link;

/* Yours to write: start moving to `joints`, to be there `time_ms` after the stream's start. Return at once. */
void vr_on_move(uint32_t time_ms, const vr_real joints[VR_JOINTS]);

/* Yours to write: stop the arm as fast as it can. */
void vr_on_stop(void);

/* Before anything else: no session, joints at `now`. */
void vr_link_start(vr_link *link, const vr_real now[VR_JOINTS]);

/* One byte from the line. Returns how many bytes of link->out are to be sent, mostly 0. */
unsigned vr_link_byte(vr_link *link, uint8_t byte);

/* Call it now and then with the time passed. Stops the arm and ends the session when the computer has kept silent for
 * longer than it promised in its HELLO. */
void vr_link_elapsed(vr_link *link, uint32_t ms);

#endif
