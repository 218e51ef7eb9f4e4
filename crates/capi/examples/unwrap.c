/* Unwraps a cube into an atlas of 512 texels: cc -std=c11 unwrap.c $(pkg-config --cflags --libs abf) */
#include <abf.h>
#include <stdio.h>
#include <string.h>

static const float positions[8][3] = {
    {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1},
};
static const uint32_t indices[36] = {
    0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5,
};

static int32_t progress(void *user, const AbfEvent *event) {
    if (event->kind == ABF_EVENT_KIND_ITERATION) ++*(int *)user;
    return ABF_CONTINUE;
}

int main(void) {
    int iterations = 0;
    AbfOptions options;
    memset(&options, 0, sizeof options);
    options.size = sizeof options;
    options.width = 512;
    options.margin = 4;
    options.progress = progress;
    options.user = &iterations;

    AbfResult *result = NULL;
    AbfStatus status = abf_unwrap(&positions[0][0], 8, 0, indices, 36, &options, &result);
    if (status != ABF_STATUS_OK) {
        fprintf(stderr, "%s: %s\n", abf_status_name(status), abf_last_error());
        return 1;
    }
    AbfView view;
    view.size = sizeof view;
    if (abf_result_view(result, &view) != ABF_STATUS_OK) return 1;
    for (size_t i = 0; i < 3 * view.triangle_count; ++i) {
        uint32_t vertex = view.indices[i];
        /* A new vertex is a copy of an old one: positions, normals and so on are copied from there. */
        if (view.remap[vertex] != indices[i]) return 2;
    }
    printf("%zu vertices, %zu charts, valid %d, injective %d, stretch %.4f, coverage %.2f, %d iterations\n",
           view.vertex_count, view.chart_count, view.valid, view.injective, view.stretch_l2, view.coverage, iterations);
    int is_good = view.certified && view.injective;
    abf_result_free(result);
    return is_good ? 0 : 3;
}
