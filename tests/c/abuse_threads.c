/* One model, request, body, mesh, skinner, clip and job for eight threads; and handles freed in every order. */

#include "abuse.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#define THREADS 8

typedef struct worker {
    const fixture *f;
    const anthronet_request *nearest;
    anthronet_job *job;
    pthread_t thread;
    uint32_t number;
    /* Calls that did not return what they had to. */
    int wrong;
    anthronet_measure_report report[MEASURES];
} worker;

static void expect(worker *w, int held) {
    if (!held) w->wrong++;
}

static void *work(void *argument) {
    worker *w = (worker *)argument;
    const fixture *f = w->f;
    anthronet_transform *pose = (anthronet_transform *)room(f->joints * sizeof *pose);
    anthronet_skin_job skin;
    anthronet_error mine;
    anthronet_context *context = NULL;
    uint32_t vertices = 0, i;
    float *positions;
    int round;
    expect(w, anthronet_skinner_vertex_count(f->skinner, &vertices, &mine) == ANTHRONET_OK);
    positions = (float *)room(12 * (size_t)vertices);
    expect(w, anthronet_context_new(&context, &mine) == ANTHRONET_OK);
    for (round = 0; round < (f->few ? 1 : 10); round++) {
        anthronet_body *body = NULL, *taken = NULL, *warned = NULL;
        anthronet_mesh *mesh = NULL;
        anthronet_mesh_options options;
        anthronet_job_progress progress;
        anthronet_clip *clip = NULL;
        SIZED(options);
        options.lod = 3;
        expect(w, anthronet_generate(f->model, f->request, &body, &mine) == ANTHRONET_OK);
        expect(w, anthronet_generate(f->model, w->nearest, &warned, &mine) == ANTHRONET_OK);
        anthronet_body_free(warned);
        expect(w, anthronet_body_measures(body, w->report, MEASURES, &mine) == ANTHRONET_OK);
        expect(w, anthronet_mesh_new(f->body, &options, &mesh, &mine) == ANTHRONET_OK);
        expect(w, anthronet_clip_sample(f->walk, context, 0.1 * w->number, 1, 1, 0, pose, f->joints, &mine) == ANTHRONET_OK);
        SIZED(skin);
        skin.skinner = f->skinner;
        skin.joints = pose;
        skin.joint_count = f->joints;
        skin.positions = positions;
        skin.position_bytes = 12 * (uint64_t)vertices;
        expect(w, anthronet_skin(context, &skin, 1, &mine) == ANTHRONET_OK);
        expect(w, anthronet_motion_retarget(f->motion, 0, body, NULL, &clip, NULL, &mine) == ANTHRONET_OK);
        expect(w, anthronet_generate(f->model, NULL, &body, &mine) == ANTHRONET_ERROR_POINTER);
        /* The job's bodies: each goes to one of the threads. */
        for (i = 0; i < THREADS; i++) {
            int32_t code = anthronet_job_take(w->job, i, &taken, &mine);
            expect(w, code == ANTHRONET_OK || code == ANTHRONET_ERROR_BUSY || code == ANTHRONET_ERROR_TAKEN ||
                          code == ANTHRONET_ERROR_CANCELLED);
            if (code == ANTHRONET_OK) anthronet_body_free(taken);
        }
        SIZED(progress);
        expect(w, anthronet_job_poll(w->job, &progress, &mine) == ANTHRONET_OK && progress.done <= progress.total);
        if (round == 4) expect(w, anthronet_job_cancel(w->job, &mine) == ANTHRONET_OK);
        anthronet_mesh_free(mesh);
        anthronet_clip_free(clip);
        anthronet_body_free(body);
    }
    anthronet_context_free(context);
    free(positions);
    free(pose);
    return NULL;
}

static void quiet(uint32_t level, const char *message, uint64_t length, void *user) {
    /* One call at a time, so that counting needs no lock. */
    uint64_t *heard = (uint64_t *)user;
    (void)level;
    if (message != NULL) *heard += length;
}

void test_threads(const fixture *f) {
    static worker workers[THREADS];
    const anthronet_request *requests[THREADS];
    anthronet_job *job = NULL;
    uint64_t heard = 0;
    uint32_t i;
    anthronet_request *nearest = nobody();
    for (i = 0; i < THREADS; i++) requests[i] = f->request;
    OK(anthronet_request_set_nearest(nearest, 1, &fault));
    OK(anthronet_set_log_callback(quiet, &heard, &fault));
    OK(anthronet_job_start(f->model, requests, THREADS, &job, &fault));
    for (i = 0; i < THREADS; i++) {
        workers[i].f = f;
        workers[i].nearest = nearest;
        workers[i].job = job;
        workers[i].number = i;
        CHECK(pthread_create(&workers[i].thread, NULL, work, &workers[i]) == 0, "no thread");
    }
    for (i = 0; i < THREADS; i++) pthread_join(workers[i].thread, NULL);
    for (i = 0; i < THREADS; i++) {
        CHECK(workers[i].wrong == 0, "thread %u: %d calls returned something else", i, workers[i].wrong);
        CHECK(memcmp(workers[i].report, workers[0].report, sizeof workers[i].report) == 0, "thread %u made another body", i);
    }
    OK(anthronet_set_log_callback(NULL, NULL, &fault));
    CHECK(heard > 0, "no warning is heard");
    anthronet_request_free(nearest);
    anthronet_job_free(job);
}

/* Six handles that are made of one another, freed in all 720 orders; what is left works on. */
static void permute(const fixture *f, int *order, int at, int *stride) {
    int i;
    if (at == 6) {
        anthronet_model *model = NULL;
        anthronet_body *body = NULL;
        anthronet_mesh *mesh = NULL;
        anthronet_skinner *skinner = NULL;
        anthronet_clip *clip = NULL, *made = NULL;
        anthronet_mesh_options options;
        anthronet_transform *pose = NULL;
        uint32_t count = 0;
        /* Every order is too many for a generator; each is visited in a long enough run. */
        if ((*stride)++ % (f->few ? 360 : 12) != 0) return;
        SIZED(options);
        options.lod = 3;
        OK(anthronet_model_open_embedded(&model, &fault));
        OK(anthronet_generate(model, f->request, &body, &fault));
        OK(anthronet_mesh_new(body, &options, &mesh, &fault));
        OK(anthronet_skinner_new(mesh, 0, &skinner, &fault));
        OK(anthronet_clip_builtin(TEXT("wave"), body, &clip, &fault));
        OK(anthronet_clip_in_place(clip, &made, &fault));
        pose = (anthronet_transform *)room(f->joints * sizeof *pose);
        for (i = 0; i < 6; i++) {
            switch (order[i]) {
                case 0: anthronet_model_free(model); model = NULL; break;
                case 1: anthronet_body_free(body); body = NULL; break;
                case 2: anthronet_mesh_free(mesh); mesh = NULL; break;
                case 3: anthronet_skinner_free(skinner); skinner = NULL; break;
                case 4: anthronet_clip_free(clip); clip = NULL; break;
                default: anthronet_clip_free(made); made = NULL; break;
            }
            if (model != NULL) OK(anthronet_model_latent_size(model, &count, &fault));
            if (mesh != NULL) OK(anthronet_mesh_part_count(mesh, &count, &fault));
            if (skinner != NULL) OK(anthronet_skinner_vertex_count(skinner, &count, &fault));
            if (clip != NULL) OK(anthronet_clip_sample(clip, NULL, 0.2, 0, 1, 0, pose, f->joints, &fault));
            if (made != NULL) OK(anthronet_clip_sample(made, NULL, 0.2, 0, 1, 0, pose, f->joints, &fault));
        }
        free(pose);
        return;
    }
    for (i = at; i < 6; i++) {
        int kept = order[at];
        order[at] = order[i];
        order[i] = kept;
        permute(f, order, at + 1, stride);
        order[i] = order[at];
        order[at] = kept;
    }
}

void test_orders_of_freeing(const fixture *f) {
    int order[6] = {0, 1, 2, 3, 4, 5}, stride = 0;
    permute(f, order, 0, &stride);
    CHECK(stride == 720, "%d orders", stride);
}
