/* Goals in, joints out: each line of stdin holds the twelve numbers of base_from_tool and the present joints; each line of
 * stdout 1 or 0 (reached or not), the joints, the distance [m] and the angle [rad] left. */
#include <stdio.h>

#include "vr_arm.h"

static int numbers(vr_real *to, int count)
{
    double x;
    int i;
    for (i = 0; i < count && scanf("%lf", &x) == 1; i++)
        to[i] = (vr_real)x;
    return i == count;
}

int main(void)
{
    vr_real goal[12], q[VR_JOINTS], error[2];
    int i;
    while (numbers(goal, 12) && numbers(q, VR_JOINTS)) {
        printf("%d", vr_solve(goal, q, q, error));
        for (i = 0; i < VR_JOINTS; i++)
            printf(" %.17g", (double)q[i]);
        printf(" %.17g %.17g\n", (double)error[0], (double)error[1]);
    }
    return 0;
}
