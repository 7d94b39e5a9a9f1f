#include <stdint.h>

#include "vr_arm.h"
#include "vr_kernels.h"

void vr_forward(const vr_real q[VR_JOINTS], vr_real base_from_tool[12]) { vr_kernel_forward(q, base_from_tool); }

void vr_pose_from_rotvec(const vr_real position[3], const vr_real rotvec[3], vr_real base_from_tool[12])
{
    const vr_real x = rotvec[0], y = rotvec[1], z = rotvec[2];
    const vr_real angle2 = x * x + y * y + z * z;
    const vr_real angle = VR_SQRT(angle2);
    /* Rodrigues' formula, R = c I + a [w] + b w w^T; near zero its series, good to the fourth power. */
    const int small = angle2 < VR_REAL(1e-4);
    const vr_real a = small ? 1 - angle2 / 6 : VR_SIN(angle) / angle;
    const vr_real c = small ? 1 - angle2 / 2 + angle2 * angle2 / 24 : VR_COS(angle);
    const vr_real b = small ? VR_REAL(0.5) - angle2 / 24 : (1 - c) / angle2;
    base_from_tool[0] = c + b * x * x;
    base_from_tool[1] = b * x * y - a * z;
    base_from_tool[2] = b * x * z + a * y;
    base_from_tool[3] = position[0];
    base_from_tool[4] = b * x * y + a * z;
    base_from_tool[5] = c + b * y * y;
    base_from_tool[6] = b * y * z - a * x;
    base_from_tool[7] = position[1];
    base_from_tool[8] = b * x * z - a * y;
    base_from_tool[9] = b * y * z + a * x;
    base_from_tool[10] = c + b * z * z;
    base_from_tool[11] = position[2];
}

/* Worth another step? Answers are finer than the tolerance wherever the arm allows. */
static int coarse(const vr_real error[2]) { return !(error[0] <= VR_FINE_M && error[1] <= VR_FINE_RAD); }

static int within(const vr_real error[2]) { return error[0] <= VR_TOLERANCE_M && error[1] <= VR_TOLERANCE_RAD; }

/* Take whole turns off turning joints where that brings them nearer to `now` and not past a limit. */
static void toward(const vr_real *now, vr_real *q)
{
    int i;
    for (i = 0; i < VR_JOINTS; i++) {
        if (vr_slides[i])
            continue;
        if (q[i] - now[i] > VR_TURN / 2 && q[i] - VR_TURN >= vr_lower[i])
            q[i] -= VR_TURN;
        else if (now[i] - q[i] > VR_TURN / 2 && q[i] + VR_TURN <= vr_upper[i])
            q[i] += VR_TURN;
    }
}

static void copy(const vr_real *from, vr_real *to)
{
    int i;
    for (i = 0; i < VR_JOINTS; i++)
        to[i] = from[i];
}

#if VR_BRANCHES > 0

/* Bring a joint inside its limits, by whole turns if it turns; 0 where that cannot be. */
static int into_limits(int i, vr_real *q)
{
    int turns;
    for (turns = 0; turns < 4 && !vr_slides[i]; turns++) {
        if (*q < vr_lower[i] - VR_SLACK)
            *q += VR_TURN;
        else if (*q > vr_upper[i] + VR_SLACK)
            *q -= VR_TURN;
    }
    if (!(*q >= vr_lower[i] - VR_SLACK && *q <= vr_upper[i] + VR_SLACK)) /* so written, NaN is outside */
        return 0;
    if (*q < vr_lower[i])
        *q = vr_lower[i];
    if (*q > vr_upper[i])
        *q = vr_upper[i];
    return 1;
}

/* Squared distance between joint values, slides in units of the arm's length. */
static vr_real apart(const vr_real *a, const vr_real *b)
{
    vr_real sum = 0, step;
    int i;
    for (i = 0; i < VR_JOINTS; i++) {
        step = vr_slides[i] ? (a[i] - b[i]) / VR_LENGTH : a[i] - b[i];
        sum += step * step;
    }
    return sum;
}

/* Finish a branch that all but reaches the goal: rounding is felt most where branches meet, and the arm's axes may be a
 * little off those that the closed form is exact for. */
static void polish(const vr_real goal[12], vr_real q[VR_JOINTS], vr_real error[2])
{
    vr_real next[VR_JOINTS];
    int step;
    for (step = 0; step < VR_POLISH && coarse(error) && error[0] <= VR_NEAR && error[1] <= VR_NEAR; step++) {
        vr_kernel_step(q, goal, next, error);
        copy(next, q);
        vr_kernel_error(q, goal, error);
    }
}

int vr_branches(const vr_real base_from_tool[12], vr_real q[VR_BRANCHES][VR_JOINTS])
{
    vr_real all[VR_BRANCHES * VR_JOINTS], error[2];
    int branch, i, good, found = 0;
    vr_kernel_branches(base_from_tool, all);
    for (branch = 0; branch < VR_BRANCHES; branch++) {
        good = 1;
        for (i = 0; i < VR_JOINTS && good; i++) {
            q[found][i] = all[branch * VR_JOINTS + i];
            good = into_limits(i, &q[found][i]);
        }
        if (!good)
            continue;
        vr_kernel_error(q[found], base_from_tool, error);
        polish(base_from_tool, q[found], error);
        good = within(error);
        for (i = 0; i < found && good; i++) /* branches meet where the arm is singular */
            good = apart(q[i], q[found]) > VR_SAME;
        found += good;
    }
    return found;
}

int vr_solve(const vr_real base_from_tool[12], const vr_real now[VR_JOINTS], vr_real q[VR_JOINTS], vr_real error[2])
{
    vr_real branches[VR_BRANCHES][VR_JOINTS];
    int found = vr_branches(base_from_tool, branches), best = 0, branch;
    for (branch = 0; branch < found; branch++)
        toward(now, branches[branch]);
    for (branch = 1; branch < found; branch++)
        if (apart(branches[branch], now) < apart(branches[best], now))
            best = branch;
    copy(found ? branches[best] : now, q);
    vr_kernel_error(q, base_from_tool, error);
    return found > 0;
}

#else

/* The k-th of endless points that fill the joint ranges evenly (Roberts 2018, generalised golden ratio). */
static void spread(uint32_t k, vr_real q[VR_JOINTS])
{
    int i;
    for (i = 0; i < VR_JOINTS; i++) {
        const vr_real share = (vr_real)((uint32_t)(k * vr_golden[i]) >> 8) / 16777216;
        q[i] = vr_lower[i] + share * (vr_upper[i] - vr_lower[i]);
    }
}

static vr_real cost(const vr_real error[2])
{
    const vr_real angle = VR_LENGTH * error[1];
    return error[0] * error[0] + angle * angle;
}

/* Descend from q; ends at the goal, or where the error has not halved in `patience` steps. */
static int descend(const vr_real goal[12], vr_real q[VR_JOINTS], vr_real error[2], int patience)
{
    vr_real next[VR_JOINTS], next_error[2], before = VR_INFINITY;
    int step;
    vr_kernel_step(q, goal, next, error);
    for (step = 0; step < 5 * patience; step++) {
        vr_real here[VR_JOINTS];
        copy(next, here);
        vr_kernel_step(here, goal, next, next_error);
        if (within(error) && !(coarse(error) && cost(next_error) < VR_REAL(0.8) * cost(error)))
            return 1; /* as near as rounding allows */
        copy(here, q);
        error[0] = next_error[0];
        error[1] = next_error[1];
        if (step % patience == patience - 1) {
            if (!(cost(error) < VR_REAL(0.5) * before) && !within(error))
                return 0;
            before = cost(error);
        }
    }
    return within(error);
}

static void clamp(const vr_real *from, vr_real *to)
{
    int i;
    for (i = 0; i < VR_JOINTS; i++)
        to[i] = from[i] < vr_lower[i] ? vr_lower[i] : from[i] > vr_upper[i] ? vr_upper[i] : from[i];
}

int vr_solve(const vr_real base_from_tool[12], const vr_real now[VR_JOINTS], vr_real q[VR_JOINTS], vr_real error[2])
{
    vr_real from[VR_JOINTS], trial[VR_JOINTS], trial_error[2];
    int start, reached = 0;
    clamp(now, from);
    for (start = 0; start <= VR_STARTS + VR_SPREAD; start++) {
        if (start == 0)
            copy(from, trial);
        else if (start <= VR_STARTS)
            copy(vr_starts[start - 1], trial);
        else
            spread((uint32_t)(start - VR_STARTS), trial);
        /* A goal that is still not reached lies at the border of what can be: few starts lead there, and slowly. */
        reached = descend(base_from_tool, trial, trial_error, start <= VR_STARTS ? VR_PATIENCE : VR_LAST_PATIENCE);
        if (start == 0 || reached || cost(trial_error) < cost(error)) {
            copy(trial, q);
            error[0] = trial_error[0];
            error[1] = trial_error[1];
        }
        if (reached)
            break;
    }
    toward(from, q);
    return reached;
}

#endif
