/* Bodies made and freed again and again by two threads: memory that is not given back shows in the resident set.
 * Arguments: how many cycles in all (10000 by default), and what the resident set may grow by, MiB. */

#include "check.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define THREADS 2

static anthronet_model *model;

typedef struct share {
    long first, end;
    int failures;
} share;

/* One body, and of every eighth all that can be made of it. */
static int cycle(long number) {
    anthronet_request *request = NULL;
    anthronet_body *body = NULL;
    anthronet_mesh *mesh = NULL;
    anthronet_skinner *skinner = NULL;
    anthronet_clip *clip = NULL;
    anthronet_bytes *bytes = NULL;
    anthronet_mesh_options options;
    anthronet_export_options export_options;
    anthronet_error error;
    const anthronet_clip *clips[1];
    int failures = 0;
    SIZED(options);
    SIZED(export_options);
    options.lod = export_options.lod = 3;
    failures += anthronet_request_new(&request, &error) != ANTHRONET_OK;
    failures += anthronet_request_set_sex(request, 1 + (uint32_t)(number % 2), &error) != ANTHRONET_OK;
    failures += anthronet_request_set_measure(request, TEXT("height"), 1.6 + 0.01 * (double)(number % 20), &error) != ANTHRONET_OK;
    failures += anthronet_request_set_seed(request, (uint64_t)number, &error) != ANTHRONET_OK;
    failures += anthronet_generate(model, request, &body, &error) != ANTHRONET_OK;
    if (number % 8 == 0) {
        failures += anthronet_mesh_new(body, &options, &mesh, &error) != ANTHRONET_OK;
        failures += anthronet_skinner_new(mesh, 0, &skinner, &error) != ANTHRONET_OK;
        failures += anthronet_clip_builtin(TEXT("idle"), body, &clip, &error) != ANTHRONET_OK;
        clips[0] = clip;
        export_options.clips = clips;
        export_options.clip_count = 1;
        failures += anthronet_export_memory(body, &export_options, TEXT("glb"), &bytes, &error) != ANTHRONET_OK;
        /* And what is refused leaves nothing either. */
        failures += anthronet_request_set_measure(request, TEXT("height"), 17, &error) == ANTHRONET_OK &&
                    anthronet_generate(model, request, &body, &error) == ANTHRONET_OK;
    }
    anthronet_bytes_free(bytes);
    anthronet_clip_free(clip);
    anthronet_skinner_free(skinner);
    anthronet_mesh_free(mesh);
    anthronet_body_free(body);
    anthronet_request_free(request);
    return failures;
}

static void *work(void *argument) {
    share *mine = (share *)argument;
    long number;
    for (number = mine->first; number < mine->end; number++) mine->failures += cycle(number);
    return NULL;
}

/* Runs cycles on all threads; how many calls failed. */
static int run(long first, long end) {
    share shares[THREADS];
    pthread_t threads[THREADS];
    int i, failures = 0;
    for (i = 0; i < THREADS; i++) {
        shares[i].first = first + (end - first) * i / THREADS;
        shares[i].end = first + (end - first) * (i + 1) / THREADS;
        shares[i].failures = 0;
        if (pthread_create(&threads[i], NULL, work, &shares[i]) != 0) return 1;
    }
    for (i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
        failures += shares[i].failures;
    }
    return failures;
}

static double resident_mib(void) {
    unsigned long total = 0, resident = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file == NULL || fscanf(file, "%lu %lu", &total, &resident) != 2) exit(3);
    fclose(file);
    return (double)resident * (double)sysconf(_SC_PAGESIZE) / (1 << 20);
}

int main(int argc, char **argv) {
    long cycles = argc > 1 ? atol(argv[1]) : 10000, warm = cycles / 5;
    double room_mib = argc > 2 ? atof(argv[2]) : 4, start, end;
    int failures;
    if (anthronet_model_open_embedded(&model, NULL) != ANTHRONET_OK) return 1;
    /* Until allocator and thread pool have what they need. */
    failures = run(0, warm);
    start = resident_mib();
    failures += run(warm, cycles);
    end = resident_mib();
    anthronet_model_free(model);
    if (failures > 0 || end - start > room_mib) {
        printf("FAILED %ld cycles of generate and free: resident %.1f MiB, then %.1f MiB, %d calls failed\n", cycles, start, end, failures);
        return 1;
    }
    printf("ok %ld cycles of generate and free: resident %.1f MiB, then %.1f MiB\n", cycles, start, end);
    return 0;
}
