#include "convert.h"

#include <math.h>

cv_mat cv_identity(void) {
    return (cv_mat){{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
}

cv_mat cv_from_ai(const struct aiMatrix4x4 *a) {
    return (cv_mat){{{(double)a->a1, (double)a->a2, (double)a->a3, (double)a->a4},
                     {(double)a->b1, (double)a->b2, (double)a->b3, (double)a->b4},
                     {(double)a->c1, (double)a->c2, (double)a->c3, (double)a->c4},
                     {(double)a->d1, (double)a->d2, (double)a->d3, (double)a->d4}}};
}

cv_mat cv_mul(const cv_mat *a, const cv_mat *b) {
    cv_mat out;
    for (int r = 0; r < 4; r++) {
        for (int c = 0; c < 4; c++) {
            double sum = 0;
            for (int k = 0; k < 4; k++) {
                sum += a->m[r][k] * b->m[k][c];
            }
            out.m[r][c] = sum;
        }
    }
    return out;
}

static double cofactor(const cv_mat *a, int r, int c) {
    int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
    return a->m[r1][c1] * a->m[r2][c2] - a->m[r1][c2] * a->m[r2][c1];
}

double cv_determinant(const cv_mat *a) {
    double sum = 0;
    for (int c = 0; c < 3; c++) {
        sum += a->m[0][c] * cofactor(a, 0, c);
    }
    return sum;
}

bool cv_inverse(const cv_mat *a, cv_mat *out) {
    double determinant = cv_determinant(a), size = 0;
    for (int i = 0; i < 9; i++) {
        size = fmax(size, fabs(a->m[i / 3][i % 3]));
    }
    *out = cv_identity();
    if (!(fabs(determinant) > 1e-12 * size * size * size)) {
        return false;
    }
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++) {
            out->m[r][c] = cofactor(a, c, r) / determinant;
        }
    }
    for (int r = 0; r < 3; r++) {
        out->m[r][3] =
            -(out->m[r][0] * a->m[0][3] + out->m[r][1] * a->m[1][3] + out->m[r][2] * a->m[2][3]);
    }
    return true;
}

cv_mat cv_compose(const cv_trs *p) {
    double x = p->r[0], y = p->r[1], z = p->r[2], w = p->r[3];
    const double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                            {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                            {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    cv_mat out = cv_identity();
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            out.m[i][j] = r[i][j] * p->s[j];
        }
        out.m[i][3] = p->t[i];
    }
    return out;
}

// Largest square first (Shepperd 1978).
static void rotation_of(double r[3][3], double q[4]) {
    double trace = r[0][0] + r[1][1] + r[2][2];
    if (trace > 0) {
        double s = 2 * sqrt(trace + 1);
        q[0] = (r[2][1] - r[1][2]) / s;
        q[1] = (r[0][2] - r[2][0]) / s;
        q[2] = (r[1][0] - r[0][1]) / s;
        q[3] = s / 4;
        return;
    }
    int i = r[1][1] > r[0][0] ? 1 : 0;
    i = r[2][2] > r[i][i] ? 2 : i;
    int j = (i + 1) % 3, k = (i + 2) % 3;
    double s = 2 * sqrt(fmax(0, 1 + r[i][i] - r[j][j] - r[k][k]));
    q[i] = s / 4;
    q[j] = (r[j][i] + r[i][j]) / s;
    q[k] = (r[k][i] + r[i][k]) / s;
    q[3] = (r[k][j] - r[j][k]) / s;
}

cv_trs cv_decompose(const cv_mat *a, double *shear) {
    cv_trs out = {.r = {0, 0, 0, 1}};
    double r[3][3], worst = 0;
    for (int c = 0; c < 3; c++) {
        out.t[c] = a->m[c][3];
        out.s[c] =
            sqrt(a->m[0][c] * a->m[0][c] + a->m[1][c] * a->m[1][c] + a->m[2][c] * a->m[2][c]);
    }
    if (cv_determinant(a) < 0) {
        out.s[0] = -out.s[0];
    }
    bool flat = out.s[0] == 0 || out.s[1] == 0 || out.s[2] == 0;
    for (int c = 0; c < 3 && !flat; c++) {
        for (int i = 0; i < 3; i++) {
            r[i][c] = a->m[i][c] / out.s[c];
        }
    }
    for (int c = 0; c < 3 && !flat; c++) {
        int d = (c + 1) % 3;
        worst = fmax(worst, fabs(r[0][c] * r[0][d] + r[1][c] * r[1][d] + r[2][c] * r[2][d]));
    }
    if (!flat) {
        rotation_of(r, out.r);
        double n = sqrt(out.r[0] * out.r[0] + out.r[1] * out.r[1] + out.r[2] * out.r[2] +
                        out.r[3] * out.r[3]);
        for (int i = 0; i < 4; i++) {
            out.r[i] /= n;
        }
    }
    if (shear) {
        *shear = worst;
    }
    return out;
}

double cv_distance(const cv_mat *a, const cv_mat *b) {
    double worst = 0;
    for (int i = 0; i < 16; i++) {
        worst = fmax(worst, fabs(a->m[i / 4][i % 4] - b->m[i / 4][i % 4]));
    }
    return worst;
}
