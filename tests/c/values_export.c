/* Files, in memory and on the disk, and jobs. */

#include "values.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>


static anthronet_export_options with_walk(const fixture *f, const anthronet_clip **clips) {
    anthronet_export_options options;
    SIZED(options);
    clips[0] = f->walk;
    options.lod = 2;
    options.clips = clips;
    options.clip_count = 1;
    return options;
}

void test_export_memory(const fixture *f) {
    static const struct {
        const char *format, *begins;
    } FORMATS[] = {{"glb", "glTF"}, {"vrm", "glTF"}, {"usda", "#usda"}, {"usdc", "PXR-USDC"}, {"usdz", "PK"}, {"obj", "#"}};
    const anthronet_clip *clips[1];
    anthronet_export_options options = with_walk(f, clips);
    anthronet_bytes *bytes = NULL;
    const uint8_t *data = NULL;
    uint64_t length = 0, plain = 0;
    size_t i;
    for (i = 0; i < (f->few ? 1 : LENGTH(FORMATS)); i++) {
        const char *format = FORMATS[i].format;
        int animated = i != 1 && i != 5;
        if (!OK(anthronet_export_memory(f->body, animated ? &options : NULL, format, strlen(format), &bytes, &fault))) continue;
        OK(anthronet_bytes_data(bytes, &data, &length, &fault));
        CHECK(length > 1000 && memcmp(data, FORMATS[i].begins, strlen(FORMATS[i].begins)) == 0, "%s begins otherwise", format);
        if (i == 0) {
            /* Bytes 8 to 11 are its length, little endian. */
            uint64_t said = data[8] | (uint64_t)data[9] << 8 | (uint64_t)data[10] << 16 | (uint64_t)data[11] << 24;
            CHECK(said == length, "a .glb of %lu bytes says %lu", (unsigned long)length, (unsigned long)said);
            CHECK(contains_freed(bytes, "\"animations\""), "no animation");
            plain = length;
        } else {
            anthronet_bytes_free(bytes);
        }
    }
    options.compress = 1;
    options.joint_names = ANTHRONET_NAMES_MIXAMO;
    OK(anthronet_export_memory(f->body, &options, TEXT("glb"), &bytes, &fault));
    OK(anthronet_bytes_data(bytes, &data, &length, &fault));
    CHECK(length < plain * 3 / 4, "%lu bytes become %lu when compressed", (unsigned long)plain, (unsigned long)length);
    CHECK(contains_freed(bytes, "mixamorig:LeftArm"), "not Mixamo's names");
    options.pose = "sitting!";
    options.pose_length = 7;
    OK(anthronet_export_memory(f->body, &options, TEXT("glb"), &bytes, &fault));
    CHECK(contains_freed(bytes, "\"posed\":true"), "not in the pose");
    options.clip_count = 0;
    REFUSED_OUT(ANTHRONET_ERROR_INVALID, bytes, anthronet_export_memory(f->body, &options, TEXT("vrm"), &bytes, &fault));
    options.pose_length = 8;
    REFUSED_OUT(ANTHRONET_ERROR_REQUEST, bytes, anthronet_export_memory(f->body, &options, TEXT("glb"), &bytes, &fault));
}

void test_export_path(const fixture *f) {
    static const char *const NAMES[] = {"person.glb", "person.obj", "person.usdc", "person.gltf", "person.vrm", "person.usda", "person.usdz"};
    const anthronet_clip *clips[1];
    anthronet_export_options options = with_walk(f, clips);
    anthronet_measure_report report[MEASURES];
    double metres[MEASURES];
    anthronet_measured measured;
    anthronet_bytes *json = NULL;
    size_t i;
    int m;
    options.lod = 1;
    options.body_only = 1;
    OK(anthronet_body_measures(f->body, report, MEASURES, &fault));
    for (i = 0; i < (f->few ? 1 : LENGTH(NAMES)); i++) {
        const char *path = path_in(f, NAMES[i]);
        remove(path);
        /* A .vrm holds no motion. */
        options.clip_count = strstr(path, ".vrm") == NULL;
        if (!OK(anthronet_export_path(f->body, &options, path, strlen(path), &fault))) continue;
        SIZED(measured);
        OK(anthronet_measure_file(f->model, path, strlen(path), metres, MEASURES, &measured, &fault));
        CHECK(measured.lod == 1 && measured.mass_kg > 30 && measured.volume_m3 > 0.03 && measured.bmi > 10, "%s: level %u",
              NAMES[i], measured.lod);
        OK(anthronet_measure_file_report(f->model, path, strlen(path), &json, &fault));
        CHECK(contains_freed(json, "\"warnings\":[]"), "%s: warnings about a file in metres with +Y up", NAMES[i]);
        for (m = 0; m < MEASURES; m++) {
            CHECK(fabs(metres[m] - report[m].obtained) < 1e-4, "%s: measure %d is %f, not %f", NAMES[i], m, metres[m],
                  report[m].obtained);
        }
        remove(path);
    }
}

static anthronet_job_progress progress_of(const anthronet_job *job) {
    anthronet_job_progress progress;
    SIZED(progress);
    OK(anthronet_job_poll(job, &progress, &fault));
    return progress;
}

/* Three requests, one of which nobody meets; the same bodies as one by one. */
void test_job(const fixture *f) {
    anthronet_request *requests[3];
    const anthronet_request *theirs[3];
    anthronet_job *job = NULL;
    anthronet_body *body = NULL;
    anthronet_job_progress progress;
    anthronet_measure_report ours[MEASURES], alone[MEASURES];
    anthronet_model *model = NULL;
    uint32_t i, before = 0;
    OK(anthronet_model_open_embedded(&model, &fault));
    requests[0] = person(ANTHRONET_SEX_FEMALE, 1.70);
    requests[1] = person(ANTHRONET_SEX_MALE, 17.0);
    requests[2] = person(ANTHRONET_SEX_MALE, 1.80);
    for (i = 0; i < 3; i++) theirs[i] = requests[i];
    OK(anthronet_job_start(model, theirs, 3, &job, &fault));
    /* The job needs neither. */
    for (i = 0; i < 3; i++) anthronet_request_free(requests[i]);
    anthronet_model_free(model);
    do {
        progress = progress_of(job);
        CHECK(progress.total == 3 && progress.done >= before && progress.done <= 3, "%u done of %u", progress.done, progress.total);
        before = progress.done;
    } while (progress.state == ANTHRONET_JOB_RUNNING);
    CHECK(progress.state == ANTHRONET_JOB_DONE && progress.done == 3, "state %u, %u done", progress.state, progress.done);
    OK(anthronet_job_cancel(job, &fault));
    CHECK(progress_of(job).state == ANTHRONET_JOB_DONE, "what is done is cancelled");
    OK(anthronet_job_take(job, 0, &body, &fault));
    OK(anthronet_body_measures(body, ours, MEASURES, &fault));
    OK(anthronet_body_measures(f->body, alone, MEASURES, &fault));
    CHECK(memcmp(ours, alone, sizeof ours) == 0, "another body than by itself");
    anthronet_body_free(body);
    REFUSED_OUT(ANTHRONET_ERROR_TAKEN, body, anthronet_job_take(job, 0, &body, &fault));
    REFUSED_OUT(ANTHRONET_ERROR_REQUEST, body, anthronet_job_take(job, 1, &body, &fault));
    REFUSED_OUT(ANTHRONET_ERROR_REQUEST, body, anthronet_job_take(job, 1, &body, &fault));
    OK(anthronet_job_take(job, 2, &body, &fault));
    anthronet_job_free(job);
    OK(anthronet_body_measures(body, ours, MEASURES, &fault));
    CHECK(fabs(ours[3].obtained - 1.80) < 1e-4, "a body that outlives its job is %f m", ours[3].obtained);
    anthronet_body_free(body);
}

void test_job_cancelled(const fixture *f) {
    const anthronet_request *many[2000];
    anthronet_job *job = NULL;
    anthronet_body *body = NULL;
    anthronet_job_progress progress;
    uint32_t i;
    for (i = 0; i < LENGTH(many); i++) many[i] = f->request;
    OK(anthronet_job_start(f->model, many, LENGTH(many), &job, &fault));
    REFUSED_OUT(ANTHRONET_ERROR_BUSY, body, anthronet_job_take(job, LENGTH(many) - 1, &body, &fault));
    REFUSED_OUT(ANTHRONET_ERROR_INDEX, body, anthronet_job_take(job, LENGTH(many), &body, &fault));
    OK(anthronet_job_cancel(job, &fault));
    do progress = progress_of(job);
    while (progress.state == ANTHRONET_JOB_RUNNING);
    CHECK(progress.state == ANTHRONET_JOB_CANCELLED && progress.done < LENGTH(many), "state %u, %u done", progress.state, progress.done);
    REFUSED_OUT(ANTHRONET_ERROR_CANCELLED, body, anthronet_job_take(job, LENGTH(many) - 1, &body, &fault));
    anthronet_job_free(job);
    /* Freed while it runs; and one that has nothing to do. */
    OK(anthronet_job_start(f->model, many, LENGTH(many), &job, &fault));
    anthronet_job_free(job);
    OK(anthronet_job_start(f->model, NULL, 0, &job, &fault));
    do progress = progress_of(job);
    while (progress.state == ANTHRONET_JOB_RUNNING);
    CHECK(progress.state == ANTHRONET_JOB_DONE && progress.total == 0, "nothing to do: state %u", progress.state);
    anthronet_job_free(job);
}
