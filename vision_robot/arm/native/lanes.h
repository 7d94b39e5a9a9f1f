/* Eight doubles at once, by the vector types of GCC and Clang: whatever the processor, the same source.
   Angles are reduced by steps of half pi and the series taken to the last bit of a double (errors below
   2e-16 for angles up to 1e5); numbers that are not finite stay so. */
#include <stdint.h>

#define LANES 8
typedef double vd __attribute__((vector_size(64)));
typedef int64_t vl __attribute__((vector_size(64)));

static inline vd V(double x) { return (vd){x, x, x, x, x, x, x, x}; }
static inline vd chosen(vl mask, vd yes, vd no) { return (vd)((mask & (vl)yes) | (~mask & (vl)no)); }
static inline vd truth(vl mask) { return (vd)(mask & (vl)V(1.0)); }
static inline vl sign_bits(vd x) { return (vl)x & (vl)V(-0.0); }

static inline vd v_fabs(vd x) { return (vd)((vl)x & ~(vl)V(-0.0)); }
static inline vd v_fmax(vd a, vd b) { return chosen(a > b, a, b); }
static inline vd v_fmin(vd a, vd b) { return chosen(a < b, a, b); }
static inline vd v_if(vd condition, vd x) { return (vd)((vl)x & (condition != V(0.0))); }

static inline vd v_sqrt(vd x)
{
    vd root;
    for (int k = 0; k < LANES; k++) root[k] = __builtin_sqrt(x[k]);
    return root;
}

/* Adding and subtracting 1.5 * 2^52 rounds to the nearest whole number; right below 2^51. */
static inline vd v_round(vd x) { return (x + 6755399441055744.0) - 6755399441055744.0; }
static inline vd v_floor(vd x)
{
    vd near = v_round(x);
    return near - truth(near > x);
}

static inline vd sine_series(vd r)
{
    vd z = r * r;
    return r + r * z * (-1.0 / 6 + z * (1.0 / 120 + z * (-1.0 / 5040 + z * (1.0 / 362880 + z * (-1.0 / 39916800
        + z * (1.0 / 6227020800.0 + z * (-1.0 / 1307674368000.0)))))));
}

static inline vd cosine_series(vd r)
{
    vd z = r * r;
    return 1.0 + z * (-0.5 + z * (1.0 / 24 + z * (-1.0 / 720 + z * (1.0 / 40320 + z * (-1.0 / 3628800
        + z * (1.0 / 479001600 + z * (-1.0 / 87178291200.0 + z * (1.0 / 20922789888000.0))))))));
}

/* Quarter turns in x, and what is left. The three parts of half pi have 33, 33 and 53 bits. */
static inline vd reduced(vd x, vl *quarters)
{
    vd shifted = x * 0.63661977236758134308 + 6755399441055744.0;
    vd n = shifted - 6755399441055744.0;
    *quarters = (vl)shifted;
    return ((x - n * 1.57079632673412561417e+00) - n * 6.07710050630396597660e-11) - n * 2.02226624879595063154e-21;
}

static inline vd v_sin(vd x)
{
    vl n;
    vd r = reduced(x, &n);
    vd value = chosen(-(n & 1), cosine_series(r), sine_series(r));
    return (vd)((vl)value ^ ((n & 2) << 62));
}

static inline vd v_cos(vd x)
{
    vl n;
    vd r = reduced(x, &n);
    vd value = chosen(-(n & 1), sine_series(r), cosine_series(r));
    return (vd)((vl)value ^ (((n + 1) & 2) << 62));
}

/* atan(t) for 0 <= t <= 1: past tan(pi/8) by the angle to pi/4; then a Chebyshev fit good to 1e-18. */
static inline vd atan_of_fraction(vd t)
{
    vl steep = t > V(0.41421356237309504880);
    vd s = chosen(steep, (t - 1.0) / (t + 1.0), t);
    vd z = s * s;
    vd series = 1.0 + z * (-0.333333333333331209 + z * (0.199999999999408373 + z * (-0.142857142792449685
        + z * (0.111111107446570996 + z * (-0.0909089680147281344 + z * (0.0769204519456148147
        + z * (-0.0666295024603679127 + z * (0.0584686675227513898 + z * (-0.0503504979531243932
        + z * (0.037963903161110833 + z * (-0.0178038963948125632)))))))))));
    return s * series + chosen(steep, V(0.78539816339744830962), V(0.0));
}

static inline vd v_atan2(vd y, vd x)
{
    vd ax = v_fabs(x), ay = v_fabs(y);
    vl tall = ay > ax;
    vd small = chosen(tall, ax, ay), large = chosen(tall, ay, ax);
    vd angle = atan_of_fraction(small / chosen(large > V(0.0), large, V(1.0)));
    angle = chosen(tall, 1.57079632679489661923 - angle, angle);
    angle = chosen(sign_bits(x) != 0, 3.14159265358979323846 - angle, angle);
    return (vd)((vl)angle | sign_bits(y));
}
