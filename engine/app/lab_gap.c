#include "app/lab_gap.h"

#include <math.h>

app_gap app_gap_measure(const scene *a, const scene *b) {
    app_gap g = {0};
    double sum = 0;
    for (uint32_t i = 0; i < scene_entity_count(a); i++) {
        scene_entity e = scene_entity_at(a, i);
        core_vec3 p, q;
        if (!scene_alive(b, e) || !scene_position(a, e, &p) || !scene_position(b, e, &q)) {
            g.single++;
            continue;
        }
        double x = (double)p.x - (double)q.x, y = (double)p.y - (double)q.y;
        double z = (double)p.z - (double)q.z, mm = 1e3 * sqrt(x * x + y * y + z * z);
        sum += mm;
        g.shared++;
        if (mm > g.max_mm || g.worst.index == 0) {
            g.max_mm = mm;
            g.worst = e;
        }
    }
    g.single += scene_entity_count(b) - g.shared;
    g.mean_mm = g.shared ? sum / g.shared : 0;
    return g;
}
