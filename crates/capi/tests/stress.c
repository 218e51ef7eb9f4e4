/* What scripts/check-capi runs under sanitizers and valgrind: wrong arguments, and many calls from several threads.
 * stress CALLS THREADS */
#include <abf.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SIDE 9

static float positions[SIDE * SIDE * 3];
static double doubles[SIDE * SIDE * 3];
static uint32_t indices[(SIDE - 1) * (SIDE - 1) * 6];
enum { VERTICES = SIDE * SIDE, INDICES = (SIDE - 1) * (SIDE - 1) * 6 };

static int failures = 0;

static void expect(int fact, const char *what) {
    if (!fact) {
        fprintf(stderr, "not so: %s (%s)\n", what, abf_last_error());
        failures = 1;
    }
}

#define EXPECT(fact) expect((fact) ? 1 : 0, #fact)

static void build(void) {
    uint32_t *next = indices;
    for (uint32_t i = 0; i < SIDE; ++i)
        for (uint32_t j = 0; j < SIDE; ++j) {
            uint32_t v = i * SIDE + j;
            positions[3 * v] = (float)i;
            positions[3 * v + 1] = (float)j;
            positions[3 * v + 2] = (float)(2 * sin(0.5 * i) * cos(0.4 * j));
            for (int k = 0; k < 3; ++k) doubles[3 * v + (uint32_t)k] = positions[3 * v + (uint32_t)k];
            if (i + 1 < SIDE && j + 1 < SIDE) {
                uint32_t face[6] = {v, v + SIDE, v + SIDE + 1, v, v + SIDE + 1, v + 1};
                memcpy(next, face, sizeof face);
                next += 6;
            }
        }
}

static AbfOptions options(void) {
    AbfOptions o;
    memset(&o, 0, sizeof o);
    o.size = sizeof o;
    return o;
}

static AbfStatus unwrap(const AbfOptions *o, AbfResult **result) {
    return abf_unwrap(positions, VERTICES, 0, indices, INDICES, o, result);
}

/* Every wrong argument has a status and a sentence of its own. */
static void wrong(void) {
    AbfResult *r = NULL;
    AbfOptions o = options();
    o.size = sizeof o - 8;
    EXPECT(unwrap(&o, &r) == ABF_STATUS_STRUCT_SIZE && strstr(abf_last_error(), "sizeof(AbfOptions)"));
    EXPECT(abf_unwrap(NULL, VERTICES, 0, indices, INDICES, NULL, &r) == ABF_STATUS_POINTER &&
           strstr(abf_last_error(), "positions is null"));
    EXPECT(abf_unwrap(positions, VERTICES, 0, indices, INDICES, NULL, NULL) == ABF_STATUS_POINTER);
    EXPECT(abf_unwrap(positions, VERTICES, 8, indices, INDICES, NULL, &r) == ABF_STATUS_STRIDE);
    EXPECT(abf_unwrap(positions, VERTICES, 0, indices, INDICES - 1, NULL, &r) == ABF_STATUS_INDEX_COUNT);
    EXPECT(abf_unwrap(positions, VERTICES - 1, 0, indices, INDICES, NULL, &r) == ABF_STATUS_INDEX_RANGE &&
           strstr(abf_last_error(), "has the index 80"));
    EXPECT(abf_flatten(doubles, VERTICES - 1, indices, INDICES, NULL, &r) == ABF_STATUS_INDEX_RANGE);
    EXPECT(abf_flatten(doubles, SIZE_MAX / 8, indices, INDICES, NULL, &r) == ABF_STATUS_TOO_LARGE);
    EXPECT(abf_unwrap(positions, SIZE_MAX / 2, 0, indices, INDICES, NULL, &r) == ABF_STATUS_TOO_LARGE);
    EXPECT(abf_unwrap(positions, VERTICES, SIZE_MAX - 3, indices, INDICES, NULL, &r) == ABF_STATUS_TOO_LARGE);
    EXPECT(abf_unwrap(positions, VERTICES, 0, indices, SIZE_MAX - SIZE_MAX % 3, NULL, &r) == ABF_STATUS_TOO_LARGE);
    o = options();
    o.max_memory = 1000;
    EXPECT(unwrap(&o, &r) == ABF_STATUS_MEMORY && strstr(abf_last_error(), "the limit is 1.0 kB"));
    EXPECT(abf_flatten(doubles, VERTICES, indices, INDICES, &o, &r) == ABF_STATUS_MEMORY);
    o = options();
    o.solver = "nothing";
    EXPECT(unwrap(&o, &r) == ABF_STATUS_SETTING && strstr(abf_last_error(), "linabf"));
    o = options();
    o.time_limit = NAN;
    EXPECT(unwrap(&o, &r) == ABF_STATUS_SETTING);
    o = options();
    o.coverage = 2;
    EXPECT(unwrap(&o, &r) == ABF_STATUS_SETTING && strstr(abf_last_error(), "coverage must be in (0, 1]"));
    o = options();
    o.boundary = "oval";
    EXPECT(abf_flatten(doubles, VERTICES, indices, INDICES, &o, &r) == ABF_STATUS_SETTING &&
           strstr(abf_last_error(), "boundary must be free"));
    const uint32_t outside[2] = {0, VERTICES};
    o = options();
    o.seam_vertices = outside;
    o.seam_count = 1;
    EXPECT(unwrap(&o, &r) == ABF_STATUS_INDEX_RANGE && strstr(abf_last_error(), "seam_vertices 1"));
    o.seam_count = SIZE_MAX / 4;
    EXPECT(unwrap(&o, &r) == ABF_STATUS_TOO_LARGE && strstr(abf_last_error(), "seam_count"));
    o = options();
    o.materials = (const uint32_t *)((const char *)indices + 1);
    EXPECT(unwrap(&o, &r) == ABF_STATUS_POINTER && strstr(abf_last_error(), "materials is not aligned"));
    EXPECT(r == NULL);
    AbfView view;
    memset(&view, 0, sizeof view);
    EXPECT(abf_result_view(NULL, &view) == ABF_STATUS_POINTER);
    EXPECT(unwrap(NULL, &r) == ABF_STATUS_OK && abf_result_view(r, &view) == ABF_STATUS_STRUCT_SIZE);
    abf_result_free(r);
    abf_result_free(NULL);
}

/* What is known of a mesh reaches the library: arrays that are exactly as long as they have to be. */
static void known(void) {
    uint32_t materials[INDICES / 3], seams[2 * (SIDE - 1)];
    for (uint32_t t = 0; t < INDICES / 3; ++t) materials[t] = t < INDICES / 6;
    for (uint32_t j = 0; j + 1 < SIDE; ++j) {
        seams[2 * j] = 4 * SIDE + j;
        seams[2 * j + 1] = 4 * SIDE + j + 1;
    }
    for (int by_material = 0; by_material < 2; ++by_material) {
        AbfResult *r = NULL;
        AbfView view;
        view.size = sizeof view;
        AbfOptions o = options();
        o.seams = "keep";
        o.coverage = 0.5;
        o.inner_margin = "keep";
        if (by_material) {
            o.materials = materials;
            o.polygons = materials;
        } else {
            o.seam_vertices = seams;
            o.seam_count = SIDE - 1;
        }
        EXPECT(unwrap(&o, &r) == ABF_STATUS_OK && abf_result_view(r, &view) == ABF_STATUS_OK);
        EXPECT(view.certified && view.chart_count == 2 + view.parted_for_coverage + view.parted_for_margin);
        abf_result_free(r);
    }
    const uint32_t corners[4] = {0, SIDE - 1, VERTICES - 1, VERTICES - SIDE};
    const double right[4] = {1.5707963267948966, 1.5707963267948966, 1.5707963267948966, 1.5707963267948966};
    AbfResult *r = NULL;
    AbfOptions o = options();
    o.boundary_vertices = corners;
    o.boundary_angles = right;
    o.boundary_count = 4;
    EXPECT(abf_flatten(doubles, VERTICES, indices, INDICES, &o, &r) == ABF_STATUS_OK);
    abf_result_free(r);
    /* Two pins, and the map relaxed again from where it is. */
    const uint32_t ends[2] = {0, VERTICES - 1};
    const double places[4] = {0, 0, 1, 1}, weights[2] = {0, 2};
    for (int soft = 0; soft < 2; ++soft) {
        AbfView view;
        view.size = sizeof view;
        o = options();
        o.energy = "usable";
        o.pin_vertices = ends;
        o.pin_uvs = places;
        o.pin_weights = soft ? weights : NULL;
        o.pin_count = 2;
        EXPECT(abf_flatten(doubles, VERTICES, indices, INDICES, &o, &r) == ABF_STATUS_OK);
        EXPECT(abf_result_view(r, &view) == ABF_STATUS_OK && view.pins_missed == 0 && view.pin_count == 2);
        EXPECT((view.pin_distances[1] > 0) == soft);
        AbfResult *again = NULL;
        AbfOptions plain = options();
        EXPECT(abf_relax(doubles, VERTICES, indices, INDICES, view.uv64, VERTICES, soft ? indices : NULL, &plain, &again) == ABF_STATUS_OK);
        EXPECT(abf_result_view(again, &view) == ABF_STATUS_OK && view.certified && view.relax_steps > 0);
        abf_result_free(again);
        abf_result_free(r);
    }
}

struct job {
    int calls;
    float uv[2 * VERTICES];
    int same;
};

static int32_t go_on(void *user, const AbfEvent *event) {
    (void)event;
    return *(int *)user;
}

static void *work(void *argument) {
    struct job *job = argument;
    for (int i = 0; i < job->calls; ++i) {
        AbfResult *r = NULL;
        AbfView view;
        view.size = sizeof view;
        AbfOptions o = options();
        int answer = ABF_CONTINUE;
        o.progress = go_on;
        o.user = &answer;
        if (i % 7 == 6) {
            /* Errors of other threads are not heard here. */
            answer = ABF_ABORT;
            if (unwrap(&o, &r) != ABF_STATUS_CANCELLED || !strstr(abf_last_error(), "cancelled")) job->same = 0;
        } else if (i % 7 == 5) {
            if (abf_flatten(doubles, VERTICES, indices, INDICES - 2, &o, &r) != ABF_STATUS_INDEX_COUNT ||
                !strstr(abf_last_error(), "382"))
                job->same = 0;
        } else if (i % 2) {
            if (abf_flatten(doubles, VERTICES, indices, INDICES, &o, &r) != ABF_STATUS_OK) job->same = 0;
            if (abf_result_view(r, &view) != ABF_STATUS_OK || !view.certified) job->same = 0;
        } else {
            if (unwrap(&o, &r) != ABF_STATUS_OK || abf_result_view(r, &view) != ABF_STATUS_OK) job->same = 0;
            else if (view.vertex_count != VERTICES || memcmp(view.uv32, job->uv, sizeof job->uv)) job->same = 0;
        }
        abf_result_free(r);
    }
    return NULL;
}

int main(int argc, char **argv) {
    int calls = argc > 1 ? atoi(argv[1]) : 1000, threads = argc > 2 ? atoi(argv[2]) : 8;
    build();
    wrong();
    known();
    AbfResult *first = NULL;
    AbfView view;
    view.size = sizeof view;
    EXPECT(unwrap(NULL, &first) == ABF_STATUS_OK && abf_result_view(first, &view) == ABF_STATUS_OK);
    if (failures || view.vertex_count != VERTICES) return 1;
    struct job *jobs = calloc((size_t)threads, sizeof *jobs);
    pthread_t *ids = calloc((size_t)threads, sizeof *ids);
    for (int t = 0; t < threads; ++t) {
        jobs[t].calls = calls / threads;
        jobs[t].same = 1;
        memcpy(jobs[t].uv, view.uv32, sizeof jobs[t].uv);
        if (pthread_create(&ids[t], NULL, work, &jobs[t])) return 1;
    }
    for (int t = 0; t < threads; ++t) {
        pthread_join(ids[t], NULL);
        EXPECT(jobs[t].same);
    }
    abf_result_free(first);
    free(jobs);
    free(ids);
    if (!failures) printf("%d calls from %d threads: the same UVs, and each error where it belongs\n", calls, threads);
    return failures;
}
