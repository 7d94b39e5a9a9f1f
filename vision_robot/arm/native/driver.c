/* Many goals at once through the functions generated above: lm_step, patient_step, closed_form, pose_error.
   Each lane works on a goal of its own; a lane that is done takes the next goal or the next start. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void load_column(vd *to, int lane, const double *from, int count)
{
    for (int i = 0; i < count; i++) to[i][lane] = from[i];
}

/* Distance and angle of each q from its goal. */
void measure(long count, const double *goals, const double *q, double *errors)
{
    for (long first = 0; first < count; first += LANES) {
        vd goal[12], at[JOINTS], error[2];
        for (int k = 0; k < LANES; k++) {
            long i = first + k < count ? first + k : count - 1;
            load_column(goal, k, goals + 12 * i, 12);
            load_column(at, k, q + JOINTS * i, JOINTS);
        }
        pose_error(at, goal, error);
        for (int k = 0; k < LANES && first + k < count; k++)
            for (int e = 0; e < 2; e++) errors[2 * (first + k) + e] = error[e][k];
    }
}

typedef struct {
    long goal;
    int tries, iterations;
    double best, best_error[2], best_q[JOINTS];
} Lane;

/* The start nearest to the goal among those not yet tried; features hold 12 rows of `starts` numbers. */
static int nearest_start(const double *goal, const double *weights, int starts, const float *features,
                         const float *squares, float *distances, int afresh)
{
    if (afresh) {
        memcpy(distances, squares, sizeof(float) * starts);
        for (int j = 0; j < 12; j++) {
            const float twice = (float)(-2 * goal[j] * weights[j]);
            const float *row = features + (long)j * starts;
            if (twice != 0)
                for (int s = 0; s < starts; s++) distances[s] += twice * row[s];
        }
    }
    float least = INFINITY;
    for (int s = 0; s < starts; s++) least = distances[s] < least ? distances[s] : least;
    int best = 0;
    for (int s = 0; s < starts; s++)
        if (distances[s] == least) { best = s; break; }
    distances[best] = INFINITY;
    return best;
}

/* Damped Gauss-Newton from `first` (where given) and then from the starts, nearest first. Lane by lane:
   done when the error of q is below `close` (m, rad), whose next_q is taken; given up after `iterations`.
   A goal none of whose tries comes close gets the best q seen. */
void solve_numeric(long count, const double *goals, const double *first, int starts, const double *start_q,
                   const float *features, const float *squares, const double *weights, int tries,
                   int iterations, int patient, const double *close, double scale, double *q_out, int *tries_out)
{
    Lane lane[LANES];
    vd q[JOINTS], goal[12], next[JOINTS], error[2];
    float *distances = malloc(sizeof(float) * LANES * starts);
    long taken = 0, busy = 0;
    memset(q, 0, sizeof q);
    memset(goal, 0, sizeof goal);
    for (int k = 0; k < LANES; k++) {
        lane[k].goal = -1;
        lane[k].tries = tries;
    }
    for (;;) {
        for (int k = 0; k < LANES; k++) {
            Lane *l = &lane[k];
            int fresh = 0;
            if (l->goal < 0) {
                if (taken == count) continue;
                l->goal = taken++;
                l->tries = 0;
                l->best = INFINITY;
                load_column(goal, k, goals + 12 * l->goal, 12);
                busy++;
                fresh = 1;
            } else if (l->iterations < iterations)
                continue;
            if (fresh && first) {
                load_column(q, k, first + JOINTS * l->goal, JOINTS);
                l->iterations = 0;
                continue;
            }
            int afresh = l->tries == (first ? 1 : 0);
            int s = nearest_start(goals + 12 * l->goal, weights, starts, features, squares,
                                  distances + (long)k * starts, afresh);
            load_column(q, k, start_q + JOINTS * s, JOINTS);
            l->iterations = 0;
        }
        if (!busy) break;
        if (patient)
            patient_step(q, goal, next, error);
        else
            lm_step(q, goal, next, error);
        vl near = (error[0] < V(close[0])) & (error[1] < V(close[1]));
        vd cost = error[0] * error[0] + error[1] * error[1] * (scale * scale);
        for (int k = 0; k < LANES; k++) {
            Lane *l = &lane[k];
            if (l->goal < 0) continue;
            l->iterations++;
            if (near[k]) {
                for (int j = 0; j < JOINTS; j++) q_out[JOINTS * l->goal + j] = next[j][k];
                tries_out[l->goal] = l->tries + 1;
                l->goal = -1;
                busy--;
                continue;
            }
            if (cost[k] < l->best) {
                l->best = cost[k];
                for (int j = 0; j < JOINTS; j++) l->best_q[j] = q[j][k];
            }
            if (l->iterations >= iterations && ++l->tries >= tries) {
                for (int j = 0; j < JOINTS; j++) q_out[JOINTS * l->goal + j] = l->best_q[j];
                tries_out[l->goal] = l->tries;
                l->goal = -1;
                busy--;
            }
        }
        for (int j = 0; j < JOINTS; j++) q[j] = next[j];
    }
    free(distances);
}

#ifdef BRANCHES
/* Every branch of every goal: q (count, BRANCHES, JOINTS), errors (count, BRANCHES, 2). */
void solve_closed(long count, const double *goals, double *q_out, double *errors_out)
{
    for (long first = 0; first < count; first += LANES) {
        vd goal[12], q[BRANCHES * JOINTS], errors[BRANCHES * 2];
        for (int k = 0; k < LANES; k++)
            load_column(goal, k, goals + 12 * (first + k < count ? first + k : count - 1), 12);
        closed_form(goal, q, errors);
        for (int k = 0; k < LANES && first + k < count; k++) {
            for (int i = 0; i < BRANCHES * JOINTS; i++) q_out[(first + k) * BRANCHES * JOINTS + i] = q[i][k];
            for (int i = 0; i < BRANCHES * 2; i++) errors_out[(first + k) * BRANCHES * 2 + i] = errors[i][k];
        }
    }
}

/* The best branch of every goal: inside the limits, within `tolerance` of the goal, and nearest to
   `near` (one row, or one a goal where `stride` is JOINTS) by the sum of weighted squares, after turning
   each joint that has a period by whole ones towards it. Where none is right, branch -1 and the q that misses least. */
void choose_closed(long count, const double *goals, const double *limits, const double *near, long stride,
                   const double *joint_weights, const double *periods, const double *tolerance, double slack, double scale,
                   double *q_out, double *errors_out, int *branch_out)
{
    for (long first = 0; first < count; first += LANES) {
        vd goal[12], q[BRANCHES * JOINTS], errors[BRANCHES * 2], from[JOINTS];
        for (int k = 0; k < LANES; k++) {
            long i = first + k < count ? first + k : count - 1;
            load_column(goal, k, goals + 12 * i, 12);
            load_column(from, k, near + stride * i, JOINTS);
        }
        closed_form(goal, q, errors);
        vd best = V(INFINITY), best_q[JOINTS], best_error[2], which = V(-1.0);
        for (int j = 0; j < JOINTS; j++) best_q[j] = q[j];
        best_error[0] = errors[0];
        best_error[1] = errors[1];
        for (int b = 0; b < BRANCHES; b++) {
            vd cost = V(0.0), at[JOINTS];
            vl right = (errors[2 * b] < V(tolerance[0])) & (errors[2 * b + 1] < V(tolerance[1]));
            for (int j = 0; j < JOINTS; j++) {
                vd x = q[b * JOINTS + j], low = V(limits[2 * j]), high = V(limits[2 * j + 1]);
                right &= (x >= low - slack) & (x <= high + slack);
                at[j] = v_fmin(v_fmax(x, low), high);
                if (periods[j] > 0) {
                    /* By whole turns as near as the limits let it come. */
                    vd least = -v_floor((at[j] - low) / periods[j]), most = v_floor((high - at[j]) / periods[j]);
                    vd turns = v_fmin(v_fmax(v_round((from[j] - at[j]) / periods[j]), least), most);
                    at[j] += periods[j] * turns;
                }
                vd off = at[j] - from[j];
                cost += off * off * joint_weights[j];
            }
            /* What is not right comes after everything that is, by how far it misses. */
            vd miss = errors[2 * b] * errors[2 * b] + errors[2 * b + 1] * errors[2 * b + 1] * (scale * scale);
            cost = chosen(right, cost, V(1e12) + miss * 1e12);
            vl better = cost < best;
            best = chosen(better, cost, best);
            for (int j = 0; j < JOINTS; j++) best_q[j] = chosen(better, at[j], best_q[j]);
            for (int e = 0; e < 2; e++) best_error[e] = chosen(better, errors[2 * b + e], best_error[e]);
            which = chosen(better, chosen(right, V((double)b), V(-1.0)), which);
        }
        for (int k = 0; k < LANES && first + k < count; k++) {
            for (int j = 0; j < JOINTS; j++) q_out[(first + k) * JOINTS + j] = best_q[j][k];
            for (int e = 0; e < 2; e++) errors_out[2 * (first + k) + e] = best_error[e][k];
            branch_out[first + k] = (int)which[k];
        }
    }
}
#endif
