/* What a call costs, and how fast arrays are copied out, beside the bars. */

#include "check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define ROUNDS 400
#define CALLS 10000000

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double nanoseconds_per_call(double since) { return 1e9 * (now() - since) / CALLS; }

static double least(double a, double b) { return a < b ? a : b; }

int main(void) {
    anthronet_model *model = NULL;
    anthronet_request *request = NULL;
    anthronet_body *body = NULL;
    anthronet_mesh *mesh = NULL;
    anthronet_view view;
    volatile uint32_t sum = 0;
    uint32_t count = 0;
    double plain = 1e9, guarded = 1e9, ours = 1e9, theirs = 1e9;
    char *to;
    const char *from;
    uint64_t bytes;
    int round;
    long i;
    if (anthronet_model_open_embedded(&model, NULL) != ANTHRONET_OK ||
        anthronet_request_new(&request, NULL) != ANTHRONET_OK ||
        anthronet_generate(model, request, &body, NULL) != ANTHRONET_OK ||
        anthronet_mesh_new(body, NULL, &mesh, NULL) != ANTHRONET_OK ||
        anthronet_mesh_data(mesh, 0, ANTHRONET_ATTRIBUTE_POSITIONS, &view, NULL) != ANTHRONET_OK) {
        return 1;
    }
    for (round = 0; round < 3; round++) {
        double start = now();
        for (i = 0; i < CALLS; i++) sum += anthronet_abi_version();
        plain = least(plain, nanoseconds_per_call(start));
        start = now();
        for (i = 0; i < CALLS; i++) sum += (uint32_t)anthronet_mesh_part_count(mesh, &count, NULL) + count;
        guarded = least(guarded, nanoseconds_per_call(start));
    }
    bytes = view.rows * 12;
    from = (const char *)view.data;
    to = (char *)malloc(bytes);
    if (to == NULL) return 1;
    memset(to, 1, bytes);
    /* In turns, so that both meet the same weather; the best of each. */
    for (round = 0; round < ROUNDS; round++) {
        double start = now();
        memcpy(to, from, bytes);
        theirs = least(theirs, now() - start);
        sum += (uint32_t)to[round];
        start = now();
        if (anthronet_mesh_read(mesh, 0, ANTHRONET_ATTRIBUTE_POSITIONS, to, bytes, 0, NULL) != ANTHRONET_OK) return 1;
        ours = least(ours, now() - start);
        sum += (uint32_t)to[round];
    }
    printf("a call that returns a number:    %5.1f ns (bar: 20)\n", plain);
    printf("a call that looks into a handle: %5.1f ns (bar: 20)\n", guarded);
    printf("LOD 0 positions copied out:      %5.1f GB/s, %.0f %% of memcpy's %.1f GB/s (bar: 60 %%)\n",
           (double)bytes / ours * 1e-9, 100 * theirs / ours, (double)bytes / theirs * 1e-9);
    free(to);
    anthronet_mesh_free(mesh);
    anthronet_body_free(body);
    anthronet_request_free(request);
    anthronet_model_free(model);
    return 0;
}
