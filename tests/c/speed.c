/* What a call costs, and how fast arrays are copied out, beside the bars. Times are told and never fail: machines are shared. */

#include "check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define ROUNDS 400
#define CALLS 3000000
#define CALL_BAR 20.0
#define COPY_BAR 60.0

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double nanoseconds_per_call(double since) { return 1e9 * (now() - since) / CALLS; }

static const char *met(int good) { return good ? "" : ", OVER THE BAR"; }

static void nanoseconds(const char *what, double found) {
    printf("  %s: %.1f ns (bar %.0f ns%s)\n", what, found, CALL_BAR, met(found <= CALL_BAR));
}

static double least(double a, double b) { return a < b ? a : b; }

int main(void) {
    anthronet_model *model = NULL;
    anthronet_request *request = NULL;
    anthronet_body *body = NULL;
    anthronet_mesh *mesh = NULL;
    anthronet_view view;
    volatile uint32_t sum = 0;
    uint32_t count = 0;
    double plain = 1e9, guarded = 1e9, ours = 1e9, theirs = 1e9, share;
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
    nanoseconds("a call that returns a number", plain);
    nanoseconds("a call that looks into a handle", guarded);
    share = 100 * theirs / ours;
    printf("  level 0 positions copied out: %.1f GB/s, %.0f %% of memcpy's %.1f GB/s (bar %.0f %%%s)\n", (double)bytes / ours * 1e-9,
           share, (double)bytes / theirs * 1e-9, COPY_BAR, met(share >= COPY_BAR));
    printf("ok speed is measured\n");
    free(to);
    anthronet_mesh_free(mesh);
    anthronet_body_free(body);
    anthronet_request_free(request);
    anthronet_model_free(model);
    return 0;
}
