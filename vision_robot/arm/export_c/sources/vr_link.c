#include "vr_link.h"

enum { HELLO = 1, JOINTS = 2, POSE = 3, STOP = 4, WELCOME = 0x81, ANSWER = 0x82 };
enum { HEAD = 5, CHECK = 4 };

/* A joint sent as a single may lie past its limit by its rounding. */
#define SLACK ((vr_real)1e-6)

typedef union {
    uint32_t bits;
    float value;
} float_bits;

/* ---- bytes ---- */

static uint32_t crc32(const uint8_t *data, unsigned length)
{
    static const uint32_t table[16] = {0x00000000u, 0x1DB71064u, 0x3B6E20C8u, 0x26D930ACu, 0x76DC4190u, 0x6B6B51F4u,
                                       0x4DB26158u, 0x5005713Cu, 0xEDB88320u, 0xF00F9344u, 0xD6D6A3E8u, 0xCB61B38Cu,
                                       0x9B64C2B0u, 0x86D3D2D4u, 0xA00AE278u, 0xBDBDF21Cu};
    uint32_t crc = 0xFFFFFFFFu;
    unsigned i;
    for (i = 0; i < length; i++) {
        crc = table[(crc ^ data[i]) & 15u] ^ (crc >> 4);
        crc = table[(crc ^ ((uint32_t)data[i] >> 4)) & 15u] ^ (crc >> 4);
    }
    return ~crc;
}

static uint16_t get16(const uint8_t *p) { return (uint16_t)(p[0] | (p[1] << 8)); }

static uint32_t get32(const uint8_t *p) { return (uint32_t)get16(p) | ((uint32_t)get16(p + 2) << 16); }

static float get_float(const uint8_t *p)
{
    float_bits f;
    f.bits = get32(p);
    return f.value;
}

static uint8_t *put16(uint8_t *p, unsigned x)
{
    p[0] = (uint8_t)(x & 255u);
    p[1] = (uint8_t)((x >> 8) & 255u);
    return p + 2;
}

static uint8_t *put32(uint8_t *p, uint32_t x) { return put16(put16(p, x & 0xFFFFu), x >> 16); }

static uint8_t *put_float(uint8_t *p, float x)
{
    float_bits f;
    f.value = x;
    return put32(p, f.bits);
}

static uint8_t *put_joints(uint8_t *p, const vr_real *joints)
{
    unsigned i;
    for (i = 0; i < VR_JOINTS; i++)
        p = put_float(p, (float)joints[i]);
    return p;
}

/* Undo the stuffing in place; 0 where the bytes are no encoding of anything. */
static unsigned unstuff(uint8_t *data, unsigned length)
{
    unsigned from = 0, to = 0;
    while (from < length) {
        unsigned code = data[from++], end = from + code - 1u;
        if (code == 0 || end > length)
            return 0;
        while (from < end)
            data[to++] = data[from++];
        if (code < 255u && from < length)
            data[to++] = 0;
    }
    return to;
}

/* The frame around the body that stands in link->run; returns its length in link->out. */
static unsigned send(vr_link *link, uint8_t *body_end)
{
    const uint8_t *body = link->run;
    unsigned length = (unsigned)(put32(body_end, crc32(body, (unsigned)(body_end - body))) - body);
    uint8_t *out = link->out;
    unsigned code = 1, to = 2, i;
    out[0] = 0;
    for (i = 0; i < length; i++) { /* never 254 bytes without a zero: VR_LINK_LONGEST is less */
        if (body[i] == 0) {
            out[code] = (uint8_t)(to - code);
            code = to++;
        } else {
            out[to++] = body[i];
        }
    }
    out[code] = (uint8_t)(to - code);
    out[to++] = 0;
    return to;
}

/* ---- messages ---- */

static uint8_t *head(vr_link *link, uint8_t kind, uint16_t session, uint16_t sequence)
{
    link->run[0] = kind;
    return put16(put16(link->run + 1, session), sequence);
}

static unsigned answer(vr_link *link, uint16_t session, uint16_t sequence, uint8_t status, const float error[2])
{
    uint8_t *p = head(link, ANSWER, session, sequence);
    *p++ = status;
    p = put_joints(p, link->joints);
    return send(link, put_float(put_float(p, error[0]), error[1]));
}

static unsigned refuse(vr_link *link, uint16_t session, uint16_t sequence, uint8_t status)
{
    static const float none[2] = {0.0f, 0.0f};
    return answer(link, session, sequence, status, none);
}

static unsigned on_hello(vr_link *link, uint16_t session, const uint8_t *payload, unsigned length)
{
    uint8_t *p, status = VR_LINK_MISMATCH;
    if (session == 0 || length < 1)
        return 0;
    if (length == 8 && payload[0] == VR_LINK_VERSION && payload[1] == VR_JOINTS && get32(payload + 2) == VR_FINGERPRINT) {
        status = VR_LINK_DONE;
        if (link->session != session) { /* else it is the same HELLO, sent again */
            link->session = session;
            link->sequence = 0;
            link->silence_ms = get16(payload + 6);
        }
    }
    p = head(link, WELCOME, session, 0);
    *p++ = status;
    *p++ = VR_LINK_VERSION;
    *p++ = VR_JOINTS;
    return send(link, put_joints(put32(p, VR_FINGERPRINT), link->joints));
}

static int finite(vr_real x) { return x - x == 0; }

/* Check the joints that a JOINTS message asks for; rounding past a limit is taken back. */
static uint8_t read_joints(const uint8_t *p, vr_real joints[VR_JOINTS])
{
    unsigned i;
    for (i = 0; i < VR_JOINTS; i++) {
        joints[i] = (vr_real)get_float(p + 4 * i);
        if (!finite(joints[i]))
            return VR_LINK_NOT_FINITE;
        if (joints[i] < vr_lower[i] - SLACK || joints[i] > vr_upper[i] + SLACK)
            return VR_LINK_OUTSIDE_LIMITS;
        if (joints[i] < vr_lower[i])
            joints[i] = vr_lower[i];
        if (joints[i] > vr_upper[i])
            joints[i] = vr_upper[i];
    }
    return VR_LINK_DONE;
}

/* Find joints for the pose that a POSE message asks for. */
static uint8_t solve_pose(vr_link *link, const uint8_t *p, vr_real joints[VR_JOINTS])
{
    vr_real numbers[6], goal[12], error[2];
    unsigned i;
    for (i = 0; i < 6; i++) {
        numbers[i] = (vr_real)get_float(p + 4 * i);
        if (!finite(numbers[i]))
            return VR_LINK_NOT_FINITE;
    }
    vr_pose_from_rotvec(numbers, numbers + 3, goal);
    i = (unsigned)vr_solve(goal, link->joints, joints, error);
    link->last_error[0] = (float)error[0];
    link->last_error[1] = (float)error[1];
    return i ? VR_LINK_DONE : VR_LINK_UNREACHABLE;
}

static unsigned on_command(vr_link *link, uint8_t kind, uint16_t session, uint16_t sequence, const uint8_t *payload,
                           unsigned length)
{
    vr_real joints[VR_JOINTS];
    unsigned i;
    if (link->session == 0 || session != link->session)
        return refuse(link, session, sequence, VR_LINK_NO_SESSION);
    if (sequence == link->sequence && sequence != 0)
        return answer(link, session, sequence, link->last_status, link->last_error);
    if (sequence != (uint16_t)(link->sequence + 1u))
        return refuse(link, session, sequence, VR_LINK_OUT_OF_ORDER);

    link->sequence = sequence;
    link->last_status = VR_LINK_MALFORMED;
    link->last_error[0] = link->last_error[1] = 0.0f;
    if (kind == JOINTS && length == 4u + 4u * VR_JOINTS)
        link->last_status = read_joints(payload + 4, joints);
    else if (kind == POSE && length == 28)
        link->last_status = solve_pose(link, payload + 4, joints);
    if (link->last_status == VR_LINK_DONE) {
        for (i = 0; i < VR_JOINTS; i++)
            link->joints[i] = joints[i];
        vr_on_move(get32(payload), link->joints);
    }
    return answer(link, session, sequence, link->last_status, link->last_error);
}

static unsigned on_frame(vr_link *link, unsigned length)
{
    const uint8_t *data = link->run, *payload = data + HEAD;
    uint16_t session = get16(data + 1), sequence = get16(data + 3);
    length -= HEAD + CHECK;
    link->silent_ms = 0;
    switch (data[0]) {
    case HELLO:
        return on_hello(link, session, payload, length);
    case STOP:
        link->session = 0;
        vr_on_stop();
        return refuse(link, session, sequence, VR_LINK_STOPPED);
    case WELCOME:
    case ANSWER: /* our own words, come back over a looped line */
        return 0;
    default:
        return on_command(link, data[0], session, sequence, payload, length);
    }
}

/* ---- what the program calls ---- */

void vr_link_start(vr_link *link, const vr_real now[VR_JOINTS])
{
    unsigned i;
    for (i = 0; i < VR_JOINTS; i++)
        link->joints[i] = now[i];
    link->run_length = 0;
    link->session = link->sequence = 0;
    link->last_status = VR_LINK_DONE;
    link->last_error[0] = link->last_error[1] = 0.0f;
    link->silence_ms = link->silent_ms = link->damaged = 0;
}

unsigned vr_link_byte(vr_link *link, uint8_t byte)
{
    unsigned length = link->run_length;
    if (byte != 0) {
        if (length < VR_LINK_LONGEST)
            link->run[length] = byte;
        if (length <= VR_LINK_LONGEST)
            link->run_length++;
        return 0;
    }
    link->run_length = 0;
    if (length == 0)
        return 0;
    length = length > VR_LINK_LONGEST ? 0 : unstuff(link->run, length);
    if (length < HEAD + CHECK || crc32(link->run, length - CHECK) != get32(link->run + length - CHECK)) {
        link->damaged++;
        return 0;
    }
    return on_frame(link, length);
}

void vr_link_elapsed(vr_link *link, uint32_t ms)
{
    if (link->session == 0 || link->silence_ms == 0)
        return;
    link->silent_ms += ms;
    if (link->silent_ms > link->silence_ms) {
        link->session = 0;
        vr_on_stop();
    }
}
