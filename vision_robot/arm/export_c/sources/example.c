/* The smallest use: where is the tool, and which joints bring it 10 mm lower? */
#include <stdio.h>

#include "vr_arm.h"

int main(void)
{
    vr_real q[VR_JOINTS], goal[12], error[2];
    int i, reached;
    for (i = 0; i < VR_JOINTS; i++)
        q[i] = vr_lower[i] + (vr_real)0.6 * (vr_upper[i] - vr_lower[i]);
    vr_forward(q, goal);
    printf("tool at x %.4f y %.4f z %.4f m\n", (double)goal[3], (double)goal[7], (double)goal[11]);

    goal[11] -= (vr_real)0.01;
    reached = vr_solve(goal, q, q, error);
    printf("10 mm lower: %s, %.5f mm off\n", reached ? "reached" : "not reached", 1e3 * (double)error[0]);
    for (i = 0; i < VR_JOINTS; i++)
        printf("joint %d  %.6f\n", i, (double)q[i]);
    return reached ? 0 : 1;
}
